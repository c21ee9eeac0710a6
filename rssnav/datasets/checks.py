"""Whether a data set is whole: every file and hash, every value, and no building in two splits."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from itertools import groupby
from pathlib import Path
from typing import Any

import numpy as np

from floorplans import PlanError
from floorplans import load as load_plan
from rssnav.datasets.container import read_plan_file
from rssnav.datasets.errors import DatasetError
from rssnav.datasets.folder import CARD, JOURNAL, MANIFEST, spec_of
from rssnav.datasets.journal import Journal
from rssnav.datasets.manifest import read_manifest
from rssnav.datasets.plan_maps import PlanMaps
from rssnav.progress import Progress

Row = dict[str, Any]


def problems(folder: Path, progress: Progress | None = None) -> Iterator[str]:
    """Yield what is wrong with a data set, a sentence each; nothing for one that is whole.

    Parameters
    ----------
    folder
        Of the data set.
    progress
        Called with the number of plans that are checked, and of all plans.

    Raises
    ------
    DatasetError
        Where the folder is no data set, or has no manifest.
    """
    spec = spec_of(folder)
    rows: list[Row] = read_manifest(folder / MANIFEST).to_pylist()
    yield from _missing_plans(folder, {row["plan"] for row in rows})
    yield from _shared_buildings(rows)
    by_file = [(file, list(group)) for file, group in groupby(rows, lambda row: row["file"])]
    for done, (file, of_file) in enumerate(by_file, 1):
        yield from (f"{file}: {problem}" for problem in _of_plan(folder / file, of_file))
        if progress is not None:
            progress(done, len(by_file))
    yield from _unlisted(folder, {file for file, _ in by_file})
    yield from _card(folder, rows, spec.sha256)


def _missing_plans(folder: Path, found: set[str]) -> Iterator[str]:
    """Yield plans of the spec that are neither in the manifest nor known not to be traceable."""
    entries = Journal(folder / JOURNAL).entries
    failed = {name for name, entry in entries.items() if entry.is_failed}
    spec = spec_of(folder)
    if not any(hasattr(entry, "folder") for entry in spec.entries):
        for source in spec.plans:
            if source.name not in found and source.name not in failed:
                yield f"plan {source.name!r} of the spec is missing in the manifest"


def _shared_buildings(rows: list[Row]) -> Iterator[str]:
    split_of: dict[str, str] = {}
    told = set[str]()
    for row in rows:
        split = split_of.setdefault(row["building"], row["split"])
        if split != row["split"] and row["building"] not in told:
            told.add(row["building"])
            yield f"the building of plan {row['plan']!r} is in {split} and in {row['split']}"


def _of_plan(path: Path, rows: list[Row]) -> Iterator[str]:
    if not path.is_file():
        yield "missing"
        return
    if hashlib.sha256(path.read_bytes()).hexdigest() != rows[0]["file_sha256"]:
        yield "its content is not that of the manifest"
        return
    try:
        maps, about = read_plan_file(path)
    except DatasetError as error:
        yield str(error)
        return
    try:
        if load_plan(path.with_suffix(".toml")).sha256 != about.plan_sha256:
            yield f"{path.with_suffix('.toml').name} is not the plan of the maps"
    except PlanError as error:
        yield str(error)
    if len(rows) != len(maps):
        yield f"holds {len(maps)} maps, but the manifest lists {len(rows)}"
        return
    hashes: dict[str, str] = {row["map"]: row["sha256"] for row in rows}
    for index in maps.indices():
        name = f"{about.name}/{'.'.join(map(str, index))}"
        if hashes.get(name) != maps.map_sha256(index):
            yield f"the values of map {name} are not those of the manifest"
    yield from _values(maps)


def _values(maps: PlanMaps) -> Iterator[str]:
    """Yield what contradicts itself in the layers; the reader has checked their bounds."""
    outside = ~maps.inside[None, :, None, None, None]
    rss, count = maps.layers.get("rss_dbm"), maps.layers.get("path_count")
    if rss is not None:
        if (np.isfinite(rss) & outside).any():
            yield "rss_dbm has values outside the building"
        if (rss > maps.power_dbm + 1e-3).any():
            yield "rss_dbm exceeds the transmit power"
    if rss is not None and count is not None and ((count == 0) != np.isneginf(rss)).any():
        yield "path_count is not 0 exactly where rss_dbm is -inf"


def _unlisted(folder: Path, listed: set[str]) -> Iterator[str]:
    for path in sorted(folder.glob("*/*/*.h5")):
        if path.relative_to(folder).as_posix() not in listed:
            yield f"{path.relative_to(folder).as_posix()}: not in the manifest"


def _card(folder: Path, rows: list[Row], spec_sha256: str) -> Iterator[str]:
    card = folder / CARD
    if not card.is_file():
        yield f"{CARD}: missing"
        return
    text = card.read_text("utf-8", "replace")
    found = hashlib.sha256("".join(f"{r['map']} {r['sha256']}\n" for r in rows).encode())
    for what, sha256 in (("the maps", found.hexdigest()), ("the spec", spec_sha256)):
        if sha256 not in text:
            yield f"{CARD}: does not hold the hash of {what}"
