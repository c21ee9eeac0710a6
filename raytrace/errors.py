"""The errors and warnings this package raises at its boundary."""

import errno
from pathlib import Path


class SceneError(ValueError):
    """A mesh, material or position that the tracer cannot work with; the message says why."""


class SceneWarning(UserWarning):
    """A fault of a mesh that the tracer has corrected; the message names the walls."""


class AntennaError(ValueError):
    """An antenna pattern with wrong columns, or not on a grid over the whole sphere."""


class MapFileError(ValueError):
    """A radio map file that cannot be used.

    Attributes
    ----------
    kind
        "damaged-map" (truncated, data missing, or another version of the format), "other-plan"
        (the map of another plan), "occupied" (another file stands where a map should go), or ""
        (not a radio map).
    path
        The file; None where the map is in none.
    """

    def __init__(self, message: str, kind: str = "", path: Path | None = None) -> None:
        super().__init__(message)
        self.kind = kind
        self.path = path


class MissingMapError(FileNotFoundError):
    """No radio map file at a path."""

    kind = "missing-map"

    def __init__(self, path: Path) -> None:
        super().__init__(errno.ENOENT, "no such radio map file", str(path))
        self.path = path
