"""The layouts that a data set can be exported to."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from rssnav.datasets.exporters.challenge import export_challenge
from rssnav.datasets.exporters.deepmimo import export_deepmimo
from rssnav.datasets.exporters.hugging_face import export_hugging_face
from rssnav.datasets.exporters.pieces import n_plans
from rssnav.datasets.exporters.zarr_store import export_zarr
from rssnav.progress import Progress

FORMATS: dict[str, Callable[[Path, Path, int, Progress], None]] = {
    "challenge": export_challenge,
    "deepmimo": export_deepmimo,
    "zarr": export_zarr,
    "parquet": export_hugging_face,
}
"""Exporters by the name of their layout."""


def export_dataset(folder: Path, out: Path, layout: str, progress: Progress) -> None:
    """Write a data set in another layout, whole or not at all.

    Parameters
    ----------
    folder, out
        The data set, and the folder to be made.
    layout
        One of `FORMATS`.
    progress
        Called with the number of plans that are written, and of all plans.

    Raises
    ------
    DatasetError
        Where the layout cannot hold the data set, or `out` exists.
    """
    FORMATS[layout](folder, out, n_plans(folder), progress)
