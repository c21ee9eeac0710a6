"""Files that are written whole or not at all."""

import os
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def whole_file(path: str | Path) -> Generator[Path]:
    """Give a place beside `path` to write to, and move it there when the block has ended well.

    An error or Ctrl-C leaves the old file or none. The place keeps the suffix, by which many
    writers choose their format.

    Parameters
    ----------
    path : str or Path
        Where the file shall be; missing folders above it are made.
    """
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    beside = path.with_name(f".{path.stem}.{os.getpid()}.part{path.suffix}")
    try:
        yield beside
        os.replace(beside, path)
    finally:
        beside.unlink(missing_ok=True)
