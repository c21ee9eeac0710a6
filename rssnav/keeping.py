"""Keeping what was computed, also where a disk is full."""

from __future__ import annotations

import errno
import os
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

ContentT = TypeVar("ContentT")


def save_or_rescue(save: Callable[[Path], None], path: Path) -> None:
    """Save to a file; where that fails, to a new folder in the system's folder of temporary files.

    Parameters
    ----------
    save
        Writes the content to a path.
    path
        Where it belongs.

    Raises
    ------
    OSError
        Where it could not be saved to `path`; says where it is kept instead, if anywhere.
    """
    try:
        save(path)
    except OSError as error:
        reason = os.strerror(error.errno) if error.errno else str(error)
        raise OSError(
            error.errno or errno.EIO, f"{reason}; {_rescued(save, path.name)}", str(path)
        ) from error


def _rescued(save: Callable[[Path], None], name: str) -> str:
    """Save to a folder of temporary files; return what came of it, in words."""
    try:
        elsewhere = Path(tempfile.mkdtemp(prefix="rssnav-")) / name
    except OSError:
        return "it could not be saved to a temporary folder either"
    try:
        save(elsewhere)
    except OSError:
        elsewhere.parent.rmdir()
        return f"it could not be saved to {elsewhere.parent.parent} either"
    return f"the result was saved to {elsewhere} instead"


def lenient(
    save: Callable[[ContentT], None], notice: Callable[[str], None]
) -> Callable[[ContentT], None]:
    """Make saving in between lenient: a failure gives notice once, and the work goes on."""
    noticed = False

    def try_to_save(content: ContentT) -> None:
        nonlocal noticed
        try:
            save(content)
        except OSError as error:
            if not noticed:
                notice(f"finished runs cannot be saved before the end: {error}")
            noticed = True

    return try_to_save
