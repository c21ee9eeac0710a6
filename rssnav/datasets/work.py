"""A plan's piece of work: trace its maps, write its files, return a small summary."""

from __future__ import annotations

import hashlib
import json
import time
from dataclasses import asdict, dataclass, field
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

import floorplans
from atomicfiles import atomic_write
from floorplans import PlanError
from raytrace import SceneError
from raytrace.trace import TRACER_VERSION
from rssnav.datasets.configuration import Configuration
from rssnav.datasets.container import About, read_plan_file, write_plan_file
from rssnav.datasets.errors import DatasetError
from rssnav.datasets.plan_maps import PlanMaps
from rssnav.datasets.plans import PlanSource, building_of
from rssnav.datasets.tracing import Limits, trace_plan

MARK = "spec.toml"
"""File that every folder of a data set has."""


@dataclass(frozen=True)
class Summary:
    """What is known of a plan's files without opening them.

    Attributes
    ----------
    name
        Of the plan.
    key
        Hash of all that its maps depend on.
    n_bytes, sha256
        Size and hash of the file; 0 and empty where there is none.
    rows
        A row of the manifest for each map.
    seconds
        Wall time of each map [s]; empty where it is not known.
    failure
        Why it could not be traced; empty where it was.
    is_final
        Whether a failure is the plan's own, so that a further attempt would fail too.
    """

    name: str
    key: str
    n_bytes: int = 0
    sha256: str = ""
    rows: list[dict[str, Any]] = field(default_factory=list[dict[str, Any]])
    seconds: list[float] = field(default_factory=list[float])
    failure: str = ""
    is_final: bool = True

    @classmethod
    def of_failure(
        cls, source: PlanSource, key: str, error: BaseException, *, is_final: bool
    ) -> Summary:
        """Return the summary of a plan whose maps an error has prevented."""
        return cls(source.name, key, failure=f"{type(error).__name__}: {error}", is_final=is_final)

    def to_json(self) -> str:
        """Return it as a line of JSON."""
        return json.dumps(asdict(self), separators=(",", ":"))

    @classmethod
    def from_json(cls, line: str) -> Summary | None:
        """Read a line; None for one that is not whole."""
        try:
            return cls(**json.loads(line))
        except (ValueError, TypeError):
            return None


def make_plan(
    source: PlanSource, configuration: Configuration, folder: Path, limits: Limits
) -> Summary:
    """Trace a plan and write its files; a plan that cannot be traced is a summary too.

    Raises
    ------
    TraceStoppedError, MemoryLimitError
        As for `raytrace.compute_radio_map`.
    DatasetError, OSError
        Where the folder cannot be seen or written.
    """
    if not (folder / MARK).is_file():
        raise DatasetError(
            "this worker does not see the data set's folder: expected a file system that all "
            "workers share, under the same path",
            folder,
        )
    key = source.key(configuration.key)
    started = time.perf_counter()
    try:
        plan = source.plan()
        maps = trace_plan(plan, configuration, limits)
    except (PlanError, SceneError, ValueError) as error:
        return Summary.of_failure(source, key, error, is_final=True)
    about = About(
        name=source.name,
        split=source.split,
        building=building_of(plan),
        source=json.dumps(source.described, sort_keys=True),
        key=key,
        plan_text=floorplans.dumps(plan),
        plan_sha256=plan.sha256,
        configuration=json.dumps(configuration.described(), sort_keys=True),
        material_edition=configuration.edition,
        rssnav_version=version("rssnav"),
        tracer_version=TRACER_VERSION,
    )
    path = folder / source.file
    with atomic_write(path.with_suffix(".toml")) as beside:
        beside.write_text(about.plan_text, encoding="utf-8", newline="\n")
    content = write_plan_file(maps, about, path)
    took = time.perf_counter() - started
    return _summary(source, maps, about, content, _shared_out(maps.seconds, took))


def _shared_out(seconds: tuple[float, ...], took: float) -> list[float]:
    """Share the time for scene and files among the maps [s]."""
    each = max(took - sum(seconds), 0.0) / len(seconds)
    return [round(s + each, 4) for s in seconds]


def found_plan(source: PlanSource, key: str, folder: Path) -> Summary | None:
    """Return the summary of files that an earlier run has written; None where there are none.

    A file that is damaged, or of something else, counts as none.
    """
    path = folder / source.file
    if not path.is_file() or not path.with_suffix(".toml").is_file():
        return None
    try:
        maps, about = read_plan_file(path)
    except DatasetError:
        return None
    if about.key != key or about.split != source.split:
        return None
    return _summary(source, maps, about, path.read_bytes(), [])


def _summary(
    source: PlanSource, maps: PlanMaps, about: About, content: bytes, seconds: list[float]
) -> Summary:
    sha256 = hashlib.sha256(content).hexdigest()
    return Summary(
        source.name, about.key, len(content), sha256, _rows(source, maps, about), seconds
    )


def _rows(source: PlanSource, maps: PlanMaps, about: About) -> list[dict[str, Any]]:
    """Return a row of the manifest for each map."""
    described = source.described
    shared = {
        "plan": source.name,
        "split": source.split,
        "building": about.building,
        "kind": str(described.get("kind", "file")),
        "seed": described.get("seed"),
        "file": source.file,
        "plan_sha256": about.plan_sha256,
        "key": about.key,
        "tracer_version": about.tracer_version,
        "rssnav_version": about.rssnav_version,
        "n_y": len(maps.y),
        "n_x": len(maps.x),
    }
    rows: list[dict[str, Any]] = []
    for index in maps.indices():
        x, y, z = maps.positions[index.transmitter].tolist()
        rows.append(
            {
                "map": f"{source.name}/{'.'.join(map(str, index))}",
                **shared,
                "preset": maps.presets[index.preset],
                "height_m": maps.heights_m[index.height],
                "antenna": maps.antennas[index.antenna],
                "frequency_hz": maps.frequencies_hz[index.frequency],
                "transmitter": maps.transmitters[index.transmitter],
                "transmitter_x": x,
                "transmitter_y": y,
                "transmitter_z": z,
                "power_dbm": maps.power_dbm,
                **{f"index_{axis}": number for axis, number in index._asdict().items()},
                "cells_inside": int(maps.inside[index.height].sum()),
                **_extremes(maps, index),
                "sha256": maps.map_sha256(index),
            }
        )
    return rows


def _extremes(maps: PlanMaps, index: Any) -> dict[str, float | None]:
    """Return the range of RSS, where it is kept."""
    if "rss_dbm" not in maps.layers:
        return {"rss_dbm_min": None, "rss_dbm_max": None}
    rss = maps.layers["rss_dbm"][index]
    reached = rss[np.isfinite(rss)]
    if not reached.size:
        return {"rss_dbm_min": None, "rss_dbm_max": None}
    return {"rss_dbm_min": float(reached.min()), "rss_dbm_max": float(reached.max())}
