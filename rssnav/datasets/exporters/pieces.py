"""What exporters share: the maps of a data set, one plan after the other, and a new folder."""

from __future__ import annotations

import os
import shutil
from collections.abc import Generator, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path
from typing import Any
from uuid import uuid4

from rssnav.datasets.container import About, read_plan_file
from rssnav.datasets.errors import DatasetError
from rssnav.datasets.folder import MANIFEST
from rssnav.datasets.manifest import read_manifest
from rssnav.datasets.plan_maps import AXES, MapIndex, PlanMaps

Row = dict[str, Any]


@dataclass(frozen=True)
class PlanPiece:
    """A plan of a data set.

    Attributes
    ----------
    number
        Its place, from 0.
    rows
        Its maps in the manifest.
    maps, about
        What its file holds.
    """

    number: int
    rows: list[Row]
    maps: PlanMaps
    about: About


def plan_pieces(folder: Path) -> Iterator[PlanPiece]:
    """Yield the plans of a data set in their order; one is in memory at a time.

    Raises
    ------
    DatasetError
        Where the data set is not complete or damaged.
    """
    rows: list[Row] = read_manifest(folder / MANIFEST).to_pylist()
    for number, (file, group) in enumerate(groupby(rows, lambda row: row["file"])):
        yield PlanPiece(number, list(group), *read_plan_file(folder / file))


def index_of(row: Row) -> MapIndex:
    """Return the index of a map within its file."""
    return MapIndex(*(int(row[f"index_{axis}"]) for axis in AXES))


def n_plans(folder: Path) -> int:
    """Return the number of plans of a data set."""
    return len(set(read_manifest(folder / MANIFEST, ["file"]).to_pydict()["file"]))


@contextmanager
def new_folder(path: Path) -> Generator[Path]:
    """Provide a folder that becomes `path` when the block ends without an exception.

    Raises
    ------
    DatasetError
        Where `path` exists and is not an empty folder.
    """
    path = Path(os.path.realpath(path))
    if path.exists() and (not path.is_dir() or any(path.iterdir())):
        raise DatasetError("exists already: expected a new folder", path)
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = path.with_name(f".{path.name}.{uuid4().hex}.part")
    temporary.mkdir()
    try:
        yield temporary
        if path.exists():
            path.rmdir()
        temporary.rename(path)
    finally:
        shutil.rmtree(temporary, ignore_errors=True)
