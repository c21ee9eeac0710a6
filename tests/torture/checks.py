"""What may be in a folder after an attack, and whether two folders hold the same results."""

from __future__ import annotations

import csv
import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from PIL import Image

import floorplans
from raytrace import RadioMap, TransmitterMaps
from raytrace.results.map_file import is_radio_map
from rssnav import TrainingResult
from rssnav.datasets.container import read_plan_file
from rssnav.datasets.spec import load_spec
from rssnav.experiments.search_store import read_search

VOLATILE = ("_time_s", "_cpu_s", "cpu_s")
"""Ends of names of measured times, which no two runs share."""
TIMES = ("step_us", "cpu_s", "sha256")
"""Keys of JSON files that hold measured times, or the hash of what does."""
TIMED = re.compile("cpu|claim_verdict", re.IGNORECASE)
"""Words in columns and rows of tables with measured times; a claim may rest on one of them."""
EXACT = (".toml", ".geojson", ".yaml", ".pgm", ".glb", ".md", ".parquet")
"""Suffixes of files that are the same in every run."""
OF_THE_RUN = ("lock", "journal.jsonl", "times.parquet")
"""Files of a data set that say how it was made."""


def files_in(folder: Path) -> set[str]:
    """All files below a folder."""
    return {str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file()}


def temporary_in(folder: Path) -> set[str]:
    """Files that a writer has not finished."""
    return {name for name in files_in(folder) if ".part" in Path(name).name}


def half_files(folder: Path) -> Iterator[str]:
    """Finished files that cannot be read to their end."""
    for name in sorted(files_in(folder) - temporary_in(folder)):
        try:
            _read(folder / name)
        except Exception as error:
            yield f"{name} is damaged: {type(error).__name__}: {error}"


def _read(path: Path) -> None:
    match path.suffix:
        case _ if path.name in OF_THE_RUN:
            pass
        case ".h5" if re.fullmatch(r"[a-z]+-[0-9]{6}\.h5", path.name):
            read_plan_file(path)
        case ".toml" if path.stem == "spec":
            load_spec(path)
        case ".h5" if "-search-" in path.name:
            read_search(path)
        case ".h5" if path.parent.parent.name == "benchmark":
            TransmitterMaps.load(path)
        case ".h5":
            (RadioMap if is_radio_map(path) else TrainingResult).load(path)
        case ".png" | ".gif":
            with Image.open(path) as picture:
                for frame in range(getattr(picture, "n_frames", 1)):
                    picture.seek(frame)
                    picture.load()
        case ".json" | ".geojson":
            json.loads(path.read_text())
        case ".toml" if path.stem != "misfit":
            floorplans.load(path)
        case ".html":
            _expect_end(path, "</html>")
        case ".svg":
            _expect_end(path, "</svg>")
        case _:
            if not path.read_bytes():
                raise ValueError("the file is empty")


def _expect_end(path: Path, end: str) -> None:
    if not path.read_text().rstrip().endswith(end):
        raise ValueError(f"does not end with {end}")


def differences(found: Path, wanted: Path) -> Iterator[str]:
    """What is missing, too much or different in a folder."""
    yield from (f"{name} is missing" for name in sorted(files_in(wanted) - files_in(found)))
    yield from (f"{name} is litter" for name in sorted(files_in(found) - files_in(wanted)))
    for name in sorted(files_in(wanted) & files_in(found)):
        one, other = found / name, wanted / name
        if one.name in OF_THE_RUN:
            continue
        if one.suffix in EXACT and _untimed(one.read_text("latin-1")) != _untimed(
            other.read_text("latin-1")
        ):
            yield f"{name} is different"
        of_flights = "benchmark" in name and one.suffix == ".json"
        if of_flights and _timeless(one) != _timeless(other):
            yield f"{name} is different"
        if one.suffix == ".csv" and _rows(one) != _rows(other):
            yield f"{name} is different"
        if one.suffix == ".h5":
            yield from (f"{name}: {key} is different" for key in _differing(one, other))


def _untimed(text: str) -> str:
    """Return a text without the last column of its tables, if that holds times."""
    if "s a step |" not in text:
        return text
    lines = text.splitlines()
    return "\n".join(line.rpartition(" | ")[0] if line.startswith("|") else line for line in lines)


def _timeless(path: Path) -> Any:
    """Content of a JSON file without measured times, and hashes of these."""

    def kept(value: Any) -> Any:
        if isinstance(value, dict):
            names = (name for name in value if name not in TIMES)
            return {name: kept(value[name]) for name in names}
        return list(map(kept, value)) if isinstance(value, list) else value

    return kept(json.loads(path.read_text()))


def _rows(path: Path) -> list[list[str]]:
    """Rows of a table without those, and without the columns, that measured times decide."""
    with path.open(newline="") as file:
        titles, *rows = csv.reader(file)
    kept = [number for number, title in enumerate(titles) if not TIMED.search(title)]
    untimed = [row for row in rows if not TIMED.search(" ".join(row))]
    return [[row[number] for number in kept] for row in (titles, *untimed)]


def _differing(one: Path, other: Path) -> list[str]:
    a, b = _content(one), _content(other)
    return sorted(key for key in a.keys() | b.keys() if not _same(a.get(key), b.get(key)))


def _content(path: Path) -> dict[str, Any]:
    """Datasets and attributes of an HDF5 file without measured times."""
    found: dict[str, Any] = {}
    with h5py.File(path) as file:

        def visit(name: str, item: Any) -> None:
            found.update({f"{name}@{key}": value for key, value in item.attrs.items()})
            if isinstance(item, h5py.Dataset):
                found[name] = item[()]

        visit("", file)
        file.visititems(visit)
    ignored = ("REFERENCE_LIST", "DIMENSION_LIST")
    return {key: v for key, v in found.items() if not key.endswith((*VOLATILE, *ignored))}


def _same(one: Any, other: Any) -> bool:
    if isinstance(one, h5py.Empty) or isinstance(other, h5py.Empty):
        return type(one) is type(other)
    one, other = np.asarray(one), np.asarray(other)
    if one.shape != other.shape or one.dtype != other.dtype:
        return False
    return bool(np.array_equal(one, other, equal_nan=one.dtype.kind == "f"))
