"""The error of data sets."""

from __future__ import annotations

from pathlib import Path


class DatasetError(ValueError):
    """A spec, or a folder of a data set, that cannot be used; the message says what would be.

    Attributes
    ----------
    path
        The file or folder.
    """

    def __init__(self, message: str, path: Path | None = None) -> None:
        super().__init__(message if path is None else f"{path}: {message}")
        self.path = path
