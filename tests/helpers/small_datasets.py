"""Data sets that are made in a second."""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import Any

from rssnav.datasets.engines.job import Engine
from rssnav.datasets.engines.threads import Threads
from rssnav.datasets.making import MadeDataset, make_dataset
from rssnav.datasets.spec import DatasetSpec, read_spec

SPEC = """
name = "small"

[[plans]]
kind = "flat"
seeds = 3
area_m2 = 50

[transmitters]
count = 2
frequencies_ghz = [2.4, 5.2]
antennas = ["isotropic"]

[receivers]
antenna = "isotropic"
cell_size_m = 2.0

[presets.quick]
reflections = 1
diffractions = 0
transmissions = 1
"""

NOT_DATA = (".state", "times.parquet")
"""What may differ between two data sets of the same spec."""


def edited(old: str, new: str, text: str = SPEC) -> str:
    """Return SPEC with its one occurrence of `old` replaced."""
    assert text.count(old) == 1, f"{old!r} is not once in the spec"
    return text.replace(old, new)


def spec_of(text: str = SPEC, folder: Path = Path()) -> DatasetSpec:
    """Read a spec as if from a folder."""
    return read_spec(text, folder / "spec.toml")


def made(
    folder: Path, text: str = SPEC, engine: Engine | None = None, **options: Any
) -> tuple[MadeDataset, list[str]]:
    """Make a data set; return what came of it, and what the user was told."""
    told: list[str] = []
    options = {"notice": told.append, "progress": lambda _done, _total: None, **options}
    result = make_dataset(spec_of(text, folder.parent), folder, engine or Threads(1), **options)
    return result, told


def bits(folder: Path) -> dict[str, str]:
    """Return the hash of every file that belongs to the data, by its name."""
    return {
        str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in sorted(folder.rglob("*"))
        if path.is_file() and path.relative_to(folder).parts[0] not in NOT_DATA
    }
