"""Run the command line: ``python -m rssnav``, or ``rssnav``."""

import sys
from contextlib import suppress

from rssnav.interrupts import INTERRUPTS


def main() -> None:
    """Run the command line; Ctrl-C and SIGTERM are handled before it is imported."""
    code: int | str | None = 0
    with suppress(KeyboardInterrupt):
        INTERRUPTS.install()
        try:
            from rssnav.cli import app

            app(prog_name="rssnav")
        except SystemExit as end:
            code = end.code
    INTERRUPTS.end()
    sys.exit(code)


if __name__ == "__main__":
    main()
