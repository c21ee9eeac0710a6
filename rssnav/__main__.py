"""Run the command line: ``python -m rssnav``, or ``rssnav``."""

import os
import signal


def _end_at_once(number: int, _frame: object) -> None:
    """End the process while it has done nothing yet."""
    os.write(2, b"rssnav: interrupted before it began\n")
    os._exit(128 + number)


def main() -> None:
    """Run the command line; Ctrl-C and SIGTERM are handled before it is imported."""
    for early in (signal.SIGINT, signal.SIGTERM):
        if signal.getsignal(early) is not signal.SIG_IGN:
            signal.signal(early, _end_at_once)
    import sys
    from contextlib import suppress

    from rssnav.interrupts import INTERRUPTS

    code: int | str | None = 0
    with suppress(KeyboardInterrupt):
        INTERRUPTS.install()
        try:
            from rssnav.cli import app

            app(prog_name="rssnav")
        except SystemExit as end:
            code = end.code
        except Exception:  # a library may turn an interrupt into any other error
            if not INTERRUPTS.exit_code:
                raise
    INTERRUPTS.end()
    sys.exit(code)


if __name__ == "__main__":
    main()
