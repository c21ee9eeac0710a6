"""The errors and warnings this package raises at its boundary."""

import errno
from pathlib import Path


class SceneError(ValueError):
    """A mesh, material or position that the tracer cannot work with; the message says why."""


class MemoryLimitError(MemoryError):
    """A trace that would take more memory than it may.

    Attributes
    ----------
    needed_bytes
        What it needs at least.
    remedy
        "less_memory", see `MapFileError`.
    """

    remedy = "less_memory"

    def __init__(self, what: str, needed_bytes: int, left_bytes: int) -> None:
        super().__init__(
            f"{what} need at least {_size(needed_bytes)} of memory, but the limit leaves "
            f"{_size(max(left_bytes, 0))}: fewer reflections, transmissions, receivers or threads "
            "take less"
        )
        self.needed_bytes = needed_bytes


def _size(n_bytes: int) -> str:
    """Return a number of bytes in words."""
    for unit, size in (("TB", 1e12), ("GB", 1e9), ("MB", 1e6)):
        if n_bytes >= size:
            return f"{n_bytes / size:.3g} {unit}"
    return f"{n_bytes} bytes"


class TraceStoppedError(Exception):
    """A trace that its caller has stopped."""


class SceneWarning(UserWarning):
    """What the tracer corrected in a mesh or bounded in a map; the message names the places."""


class AntennaError(ValueError):
    """An antenna pattern with wrong columns, or not on a grid over the whole sphere."""


class MapFileError(ValueError):
    """A radio map file that cannot be used.

    Attributes
    ----------
    path
        The file; None for a map that is in none.
    remedy
        Key of what would help, for programs that offer it in their own words: "make_map" or
        "replace_file"; None where the message says all.
    """

    def __init__(self, message: str, path: Path | None = None, remedy: str | None = None) -> None:
        super().__init__(message)
        self.path = path
        self.remedy = remedy


class MissingMapError(FileNotFoundError):
    """No radio map file at a path; `remedy` as of `MapFileError`."""

    remedy = "make_map"

    def __init__(self, path: Path) -> None:
        super().__init__(errno.ENOENT, "no such radio map file", str(path))
        self.path = path
