"""``python -m rssnav.explorer.import_worker FILE PLAN BYTES``: import a file within limited memory.

`rssnav.explorer.uploads` runs it, so that a malicious file can only exhaust this process.
"""

import sys
from pathlib import Path

from floorplans import PlanError
from floorplans.importers import import_plan
from rssnav.messages import describe


def main(file: str, plan: str, n_bytes: str) -> int:
    """Write the plan in a file to a TOML file; return the exit code."""
    limit_memory(int(n_bytes))
    try:
        text = import_plan(file).toml()
    except (PlanError, OSError, MemoryError, ImportError) as error:
        print(describe(error) or "not enough memory to read the file", file=sys.stderr)
        return 1
    Path(plan).write_text(text, encoding="utf-8")
    return 0


def limit_memory(n_bytes: int) -> None:
    """Limit the memory of this process, where the operating system supports it."""
    try:
        import resource
    except ImportError:
        return
    resource.setrlimit(resource.RLIMIT_AS, (n_bytes, n_bytes))


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
