"""What is attacked: how inputs are drawn, how one is run, and which errors are right there."""

from __future__ import annotations

import shutil
import zipfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from benchmark_records import SMALL
from hypothesis import strategies as st
from small_datasets import SPEC

import floorplans
from floorplans import PlanError
from floorplans.checks.inspection import inspect
from floorplans.importers import import_plan
from floorplans.repair.plan import repair_plan
from fuzz import calls, commands, samples
from fuzz.hdf5_files import damaged_hdf5
from fuzz.mutations import mutated_bytes, mutated_lines, mutated_tree
from fuzz.text_formats import json_text, toml_text
from raytrace import (
    AntennaError,
    MapFileError,
    MemoryLimitError,
    PatternTable,
    RadioMap,
    Scene,
    SceneError,
    TransmitterMaps,
)
from rssnav import ResultFileError, TrainingResult
from rssnav.benchmark.errors import BenchmarkError
from rssnav.benchmark.page import as_markdown, as_page
from rssnav.benchmark.submissions import merged, read_scores
from rssnav.datasets.container import read_plan_file
from rssnav.datasets.errors import DatasetError
from rssnav.datasets.spec import load_spec
from rssnav.measurements.survey import SurveyError, SurveyTransmitter
from rssnav.measurements.survey_csv import read_survey
from rssnav.measurements.validation import validate

Cases = Callable[[], st.SearchStrategy[bytes]]


@dataclass(frozen=True)
class Target:
    """Something that reads input from outside.

    Attributes
    ----------
    cases
        Strategy of inputs.
    run
        Reads the input, which is also in a file in a folder of its own.
    errors
        What it may raise.
    suffix
        Of the file.
    by_lines
        Whether an input is made smaller line by line instead of byte by byte.
    """

    cases: Cases
    run: Callable[[Path], object]
    errors: tuple[type[Exception], ...]
    suffix: str
    by_lines: bool = False


def _plans() -> st.SearchStrategy[bytes]:
    text = samples.plan_text().encode()
    trees = mutated_tree(samples.plan_data()).map(toml_text)
    return st.one_of(trees, trees, mutated_lines(text), mutated_bytes(text))


def _run_plan(path: Path) -> None:
    """Read, check, write and read back a plan, and build what is traced."""
    plan = floorplans.load(path)
    assert floorplans.loads(floorplans.dumps(plan)) == plan
    walls = plan.to_mesh()
    Scene.from_mesh(walls.mesh, walls.face_material, walls.materials)


def _run_repair(path: Path) -> None:
    """Check and repair a plan; what was right stays right."""
    text, origin = floorplans.loading.read_text(path)
    file = floorplans.loading.loads_unchecked(text, origin=origin)
    inspect(file)
    repaired = repair_plan(file.plan).toml()
    assert _is_plan(repaired) or not _is_plan(text), "a good plan is spoilt"


def _is_plan(text: str) -> bool:
    try:
        floorplans.loads(text)
    except PlanError:
        return False
    return True


def _run_map(path: Path) -> None:
    radio_map = RadioMap.load(path)
    for layer in radio_map.layers.values():
        assert layer.shape == radio_map.grid.shape
        assert not np.isnan(layer).any()


def _run_result(path: Path) -> None:
    result = TrainingResult.load(path)
    assert np.all(result.steps >= -1)
    assert np.isfinite(result.world.position).all()


def _importer(name: str) -> Callable[[Path], object]:
    def run(path: Path) -> None:
        imported = import_plan(path.rename(path.with_name(name)))
        assert floorplans.loads(imported.toml()) == imported.plan

    return run


def _run_transmitter_maps(path: Path) -> None:
    maps = TransmitterMaps.load(path)
    shape = maps.first.grid.shape
    for found in (maps.best_server, maps.total_dbm, maps.sinr_db(), maps.best_server_map.rss_dbm):
        assert found.shape == shape
        assert not np.isnan(found).any()


def _run_ros_map(path: Path) -> None:
    """Unpack picture and description, and import them."""
    folder = path.parent / "map"
    with zipfile.ZipFile(path) as archive:
        archive.extractall(folder)
    try:
        import_plan(folder / "room.yaml")
    finally:
        shutil.rmtree(folder)


def _ros_maps() -> st.SearchStrategy[bytes]:
    files = samples.ros_map()
    damage: dict[str, Any] = {
        name: st.one_of(st.just(content), mutated_lines(content), mutated_bytes(content))
        for name, content in files.items()
    }
    return st.fixed_dictionaries(damage).map(samples.zipped)


def _imdf_archives() -> st.SearchStrategy[bytes]:
    def packed(members: Any) -> bytes:
        return samples.zipped(
            {name.strip("\x00") or "?": json_text(m) for name, m in members.items()}
        )

    whole = samples.zipped({name: json_text(m) for name, m in samples.imdf().items()})
    return mutated_tree(samples.imdf()).map(packed) | mutated_bytes(whole)


def _geojson() -> st.SearchStrategy[bytes]:
    trees = mutated_tree(samples.geojson()).map(json_text)
    return st.one_of(trees, trees, mutated_bytes(json_text(samples.geojson())))


def _drawings() -> st.SearchStrategy[bytes]:
    texts = [samples.dxf(kind) for kind in samples.DRAWINGS]
    return st.sampled_from(texts).flatmap(lambda t: mutated_lines(t) | mutated_bytes(t))


def _texts(sample: Callable[[], bytes]) -> Cases:
    return lambda: mutated_lines(sample()) | mutated_bytes(sample())


def _run_survey(path: Path) -> None:
    """Read a survey of the small plan, and compare it with predictions."""
    plan = floorplans.loads(samples.plan_text())
    source = SurveyTransmitter("A", (1.2, 1.1, 1.5))
    survey = read_survey(path, plan, [source])
    assert np.isfinite(survey.points).all()
    assert np.isfinite(survey.rss_dbm).all()
    for row in validate(plan, survey, -20.0 * np.log10(survey.distance_m + 1.0)).rows:
        assert row.space is None or np.isfinite(row.space.sigma_db)


def _results() -> st.SearchStrategy[bytes]:
    return st.sampled_from(("rss", "location")).flatmap(
        lambda agent: damaged_hdf5(samples.result_file(agent))
    )


def _scores() -> st.SearchStrategy[bytes]:
    trees = mutated_tree(samples.benchmark_results()).map(json_text)
    return st.one_of(trees, trees, mutated_bytes(json_text(samples.benchmark_results())))


def _run_scores(path: Path) -> None:
    """Read results of the benchmark, and write the tables that hold them."""
    scores = merged([read_scores(path, SMALL)])
    assert "<script" not in as_page(scores, SMALL)
    assert as_markdown(scores)


TARGETS = {
    "plan": Target(_plans, _run_plan, (PlanError, SceneError), ".toml", by_lines=True),
    "repair": Target(_plans, _run_repair, (PlanError,), ".toml", by_lines=True),
    "map": Target(lambda: damaged_hdf5(samples.map_file()), _run_map, (MapFileError,), ".h5"),
    "maps": Target(
        lambda: damaged_hdf5(samples.transmitter_maps_file()), _run_transmitter_maps,
        (MapFileError,), ".h5",
    ),
    "result": Target(_results, _run_result, (ResultFileError,), ".h5"),
    "dxf": Target(_drawings, _importer("flat.dxf"), (PlanError,), ".dxf", by_lines=True),
    "geojson": Target(_geojson, _importer("room.geojson"), (PlanError,), ".geojson"),
    "imdf": Target(_imdf_archives, _importer("venue.zip"), (PlanError,), ".zip"),
    "ifc": Target(
        _texts(samples.ifc), _importer("house.ifc"), (PlanError,), ".ifc", by_lines=True
    ),
    "ros": Target(_ros_maps, _run_ros_map, (PlanError,), ".zip"),
    "antenna": Target(
        _texts(samples.antenna), PatternTable.from_csv, (AntennaError,), ".csv", by_lines=True
    ),
    "spec": Target(
        _texts(lambda: SPEC.encode()), load_spec, (DatasetError, AntennaError), ".toml",
        by_lines=True
    ),
    "dataset": Target(
        lambda: damaged_hdf5(samples.dataset_plan_file()), read_plan_file, (DatasetError,), ".h5"
    ),
    "survey": Target(
        _texts(lambda: samples.survey_text().encode()), _run_survey, (SurveyError,), ".csv",
        by_lines=True
    ),
    "benchmark": Target(_scores, _run_scores, (BenchmarkError,), ".json"),
    "options": Target(commands.cases, commands.run, (), ".txt", by_lines=True),
    "library": Target(
        calls.cases, calls.run,
        (PlanError, SceneError, ValueError, TypeError, MemoryLimitError), ".txt",
        by_lines=True
    ),
}  # fmt: skip
"""By name."""
