"""Valid files of every format that is read, small; made once, and kept for the other processes."""

from __future__ import annotations

import csv
import io
import json
import os
import pickle
import tempfile
import tomllib
import zipfile
from collections.abc import Callable
from dataclasses import replace
from functools import cache, wraps
from pathlib import Path
from typing import Any

import dxf_drawings
import ifc_models
import small_plans
import small_worlds
from benchmark_records import SMALL, records
from small_datasets import SPEC

import floorplans
from floorplans.exporters import export
from raytrace import (
    Grid,
    HalfWaveDipole,
    PatternTable,
    Scene,
    TraceConfig,
    Transmitter,
    TransmitterMaps,
    compute_radio_map,
)
from rssnav import LocationAgent, RssAgent, train
from rssnav.benchmark.scores import scores
from rssnav.benchmark.submissions import as_json
from rssnav.datasets.spec import read_spec
from rssnav.datasets.tracing import Limits
from rssnav.datasets.work import make_plan

FOLDER = "FUZZ_SAMPLES"
"""Environment variable: the folder in which samples are kept for other processes."""

DRAWINGS = ("flat_of_bodies", "flat_of_single_lines", "flat_in_nested_blocks")

Maker = Callable[..., Any]


def _kept(make: Maker) -> Maker:
    """Keep what a function returns in the folder of samples, if there is one."""

    @cache
    @wraps(make)
    def made(*arguments: str) -> Any:
        folder = os.environ.get(FOLDER)
        if folder is None:
            return make(*arguments)
        path = Path(folder) / "-".join((make.__name__, *arguments))
        if not path.exists():
            path.write_bytes(pickle.dumps(make(*arguments)))
        return pickle.loads(path.read_bytes())

    return made


OWN_MATERIAL = """
[materials.wall]
layers = [
  { material = "plasterboard", thickness_m = 0.0125 },
  { material = "air", thickness_m = 0.07 },
  { material = "plasterboard", thickness_m = 0.0125 },
]
[materials.thing]
relative_permittivity = 4.2
conductivity = 0.02

[[transmitters]]
id = "hall"
position = [2.5, 1.5, 2]
power_dbm = 20
frequency_hz = 5.2e9
antenna = "dipole"
direction = [0, 0, 1]
"""


@cache
def plan_text() -> str:
    """A room with a partition, a door, a window and materials of its own."""
    return small_plans.ROOM + OWN_MATERIAL


@cache
def plan_data() -> dict[str, Any]:
    """The same as keys and values."""
    return tomllib.loads(plan_text())


@cache
def radio_map() -> Any:
    """A map of few cells."""
    plan = floorplans.loads(plan_text())
    walls = plan.to_mesh()
    scene = Scene.from_mesh(walls.mesh, walls.face_material, walls.materials)
    grid = Grid.over(plan.bounds, 1.0, 2.0)
    return compute_radio_map(scene, Transmitter(plan.source), grid, TraceConfig(1, 1))


@_kept
def map_file() -> bytes:
    """A map as it is written."""
    return _written("map.h5", radio_map().save)


@_kept
def transmitter_maps_file() -> bytes:
    """Maps of two transmitters with different antennas, as they are written."""
    first = radio_map()
    other = PatternTable.of(HalfWaveDipole(axis=(1.0, 0.0, 0.5)), 30.0)
    second = replace(first, transmitter=replace(first.transmitter, antenna=other))
    return _written("maps.h5", TransmitterMaps({"one": first, "two": second}).save)


@_kept
def result_file(agent: str) -> bytes:
    """A training of few episodes, as it is written."""
    world = small_worlds.world_of(small_worlds.room_plan())
    kinds = {"rss": RssAgent(), "location": LocationAgent()}
    result = train(world, kinds[agent], runs=2, episodes=3, keep_q=True, threads=1)
    return _written("result.h5", result.save)


@_kept
def dxf(kind: str) -> bytes:
    """A drawing of one of the habits of `dxf_drawings`."""
    return _written("flat.dxf", getattr(dxf_drawings, kind)().saveas)


@_kept
def geojson() -> dict[str, Any]:
    """A plan as its exporter writes it, without the plan itself."""
    plan = floorplans.loads(plan_text())
    data = json.loads(_written("room.geojson", lambda path: export(plan, path)))
    return {key: value for key, value in data.items() if key in ("type", "features")}


@_kept
def ros_map() -> dict[str, bytes]:
    """A picture and its description, by name."""
    with tempfile.TemporaryDirectory() as folder:
        export(floorplans.loads(plan_text()), Path(folder) / "room.yaml")
        return {path.name: path.read_bytes() for path in sorted(Path(folder).iterdir())}


@_kept
def ifc() -> bytes:
    """A house as ifcopenshell writes it."""
    return _written("house.ifc", ifc_models.house().write)


@cache
def imdf() -> dict[str, Any]:
    """Members of an IMDF archive: a venue, a level and its units, in degrees."""

    def collection(kind: str, *features: dict[str, Any]) -> dict[str, Any]:
        return {
            "type": "FeatureCollection",
            "features": [{"type": "Feature", "feature_type": kind, **each} for each in features],
        }

    def ring(x0: float, y0: float, x1: float, y1: float) -> dict[str, Any]:
        corners = [(x0, y0), (x1, y0), (x1, y1), (x0, y1), (x0, y0)]
        metres = 1e-5
        places = [[8.5 + x * metres, 47.3 + y * metres] for x, y in corners]
        return {"type": "Polygon", "coordinates": [places]}

    level = {
        "id": "level", "geometry": ring(0, 0, 20, 10),
        "properties": {"category": "unspecified", "ordinal": 0, "name": {"en": "Ground"}},
    }  # fmt: skip
    units = [
        {"id": f"unit{n}", "geometry": ring(10 * n, 0, 10 * n + 10, 10),
         "properties": {"category": "room", "level_id": "level"}} for n in (0, 1)
    ]  # fmt: skip
    door = {
        "id": "door",
        "geometry": {"type": "LineString", "coordinates": [[8.5001, 47.30003], [8.5001, 47.30004]]},
        "properties": {"category": "pedestrian", "level_id": "level"},
    }
    return {
        "manifest.json": {"version": "1.0.0", "language": "en"},
        "level.geojson": collection("level", level),
        "unit.geojson": collection("unit", *units),
        "opening.geojson": collection("opening", door),
    }


def zipped(members: dict[str, bytes]) -> bytes:
    """Pack files into an archive."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in members.items():
            archive.writestr(name, content)
    return buffer.getvalue()


@cache
def antenna() -> bytes:
    """A table of a gain over the sphere."""
    text = io.StringIO()
    rows = csv.writer(text)
    rows.writerow(["theta_deg", "phi_deg", "gain_dbi"])
    rows.writerows((theta, phi, 2.0) for theta in (0, 90, 180) for phi in (0, 120, 240, 360))
    return text.getvalue().encode()


def dataset_plan_file() -> bytes:
    """All maps of a plan of a small data set, with paths."""
    spec = read_spec(f"{SPEC}\n[keep]\nstrongest_paths = 1\n", Path("spec.toml"))
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "spec.toml").write_text(spec.text)
        source = spec.plans[0]
        make_plan(source, spec.configuration, Path(folder), Limits())
        return (Path(folder) / source.file).read_bytes()


def survey_text() -> str:
    """Readings of one transmitter in the room of `plan_text`, with every column."""
    rows = [
        f"A,{x / 4},{y / 4},1.5,{-40 - 2 * x - y},5,1.5,2.4e9,phone,{int(x == y)}"
        for x in range(4, 10, 2)
        for y in range(4, 12, 2)
    ]
    heading = "tx,x,y,z,rss_dbm,n,std_db,frequency_hz,device,below_sensitivity"
    return "\n".join([heading, *rows, ""])


@cache
def benchmark_results() -> Any:
    """Return results of two flights of the benchmark, as its JSON file holds them."""
    return json.loads(as_json(scores(records()), SMALL))


def transmitters_text() -> str:
    """Return the transmitter of `survey_text`."""
    return "tx,x,y,z,power_dbm,frequency_hz\nA,1.2,1.1,1.5,10,2.4e9\n"


def _written(name: str, write: Any) -> bytes:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / name
        write(path)
        return path.read_bytes()


def make_all() -> None:
    """Make all samples that take a while."""
    for make in (map_file, geojson, ros_map, ifc):
        make()
    for agent in ("rss", "location"):
        result_file(agent)
    for kind in DRAWINGS:
        dxf(kind)
