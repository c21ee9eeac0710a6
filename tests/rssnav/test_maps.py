"""A map's file is made again exactly when what it depends on has changed, and never harmed."""

from __future__ import annotations

from dataclasses import replace

import h5py
import numpy as np
import pytest
from cli_plans import ROOM, edited

import floorplans
from raytrace import MapFileError, RadioMap, SceneError, TraceConfig
from rssnav.maps import make_map, require_map_for
from rssnav.scenes import PlanScene, scene_of

QUICK = TraceConfig(max_reflections=1, max_diffractions=0)


@pytest.fixture(scope="module")
def plan():
    return floorplans.loads(ROOM)


@pytest.fixture
def made(plan, tmp_path):
    """Path of the room's map."""
    path = tmp_path / "room.h5"
    make_map(plan, path, config=QUICK)
    return path


class Watch:
    """Whether a map was traced, and what was said."""

    def __init__(self) -> None:
        self.parts: list[tuple[int, int]] = []
        self.notices: list[str] = []

    def make(self, plan, path, **options):
        options = {"config": QUICK, **options}
        return make_map(
            plan,
            path,
            progress=lambda *parts: self.parts.append(parts),
            notice=self.notices.append,
            **options,
        )


def folder_of(path) -> list[str]:
    return sorted(file.name for file in path.parent.iterdir())


def test_map_holds_its_plan(plan, made) -> None:
    radio_map = RadioMap.load(made)
    assert radio_map.plan_sha256 == plan.sha256
    assert floorplans.loads(radio_map.plan_text) == plan
    assert radio_map.transmitter.position == plan.source
    assert radio_map.rss_dbm.shape == (4, 6)
    assert folder_of(made) == ["room.h5"]


def test_current_map_is_not_traced_again(plan, made) -> None:
    before, watch = made.read_bytes(), Watch()
    radio_map = watch.make(plan, made)
    assert watch.parts == []
    assert watch.notices == [f"{made} is up to date"]
    assert made.read_bytes() == before
    assert np.array_equal(radio_map.rss_dbm, make_map(plan, config=QUICK).rss_dbm)


@pytest.mark.parametrize(
    ("options", "reason"),
    [
        ({"config": replace(QUICK, max_reflections=0)}, "with a different trace configuration"),
        ({"cell_size_m": 0.5}, "on a different grid"),
        ({"height_m": 1.9}, "on a different grid"),
        ({"power_dbm": 20.0}, "for a different transmitter"),
        ({"frequency_hz": 5e9}, "for a different transmitter"),
    ],
)
def test_changed_request_makes_the_map_again(plan, made, options, reason) -> None:
    watch = Watch()
    radio_map = watch.make(plan, made, **options)
    assert watch.parts[-1][0] == watch.parts[-1][1]
    assert watch.notices == [f"{made} was made {reason}; recomputing it"]
    assert np.array_equal(RadioMap.load(made).rss_dbm, radio_map.rss_dbm)
    assert Watch().make(plan, made, **options).provenance == radio_map.provenance


def test_changed_plan_makes_the_map_again_but_a_comment_does_not(made) -> None:
    watch = Watch()
    watch.make(floorplans.loads(f"# a comment\n{ROOM}"), made)
    assert watch.parts == []
    watch.make(floorplans.loads(edited("thickness_m = 0.1", "thickness_m = 0.15")), made)
    assert watch.parts != []
    assert "made for a different plan" in watch.notices[-1]


@pytest.mark.parametrize("key", ["material_edition", "tracer_version"])
def test_map_of_another_tracer_is_made_again(plan, made, key) -> None:
    with h5py.File(made, "r+") as file:
        file.attrs[f"made_with_{key}"] = "earlier"
    watch = Watch()
    watch.make(plan, made)
    assert watch.notices == [
        f"{made} was made with a different {key.replace('_', ' ')}; recomputing it"
    ]
    assert RadioMap.load(made).provenance[key] != "earlier"


def test_map_of_another_format_version_is_made_again(plan, made) -> None:
    with h5py.File(made, "r+") as file:
        file.attrs["format_version"] = 0
    watch = Watch()
    watch.make(plan, made)
    assert watch.notices == [f"{made} is damaged or of a different version; recomputing it"]
    assert RadioMap.load(made).plan_sha256 == plan.sha256


@pytest.mark.parametrize("length", [0, 5000, -100])
def test_truncated_map_is_made_again(plan, made, length) -> None:
    made.write_bytes(made.read_bytes()[:length])
    watch = Watch()
    watch.make(plan, made)
    assert watch.notices == [f"{made} is damaged or of a different version; recomputing it"]
    assert RadioMap.load(made).plan_sha256 == plan.sha256


def foreign_hdf5(path) -> None:
    with h5py.File(path, "w") as file:
        file["temperature"] = np.arange(9.0)


def damaged_foreign_hdf5(path) -> None:
    foreign_hdf5(path)
    path.write_bytes(path.read_bytes()[:-1])


def text_about_maps(path) -> None:
    path.write_text("rssnav radio map, rss_coherent_dbm")


@pytest.mark.parametrize("write", [foreign_hdf5, damaged_foreign_hdf5, text_about_maps])
def test_file_that_is_no_map_is_replaced_only_by_force(plan, tmp_path, write) -> None:
    path, watch = tmp_path / "data.h5", Watch()
    write(path)
    before = path.read_bytes()
    with pytest.raises(MapFileError, match=r"data\.h5: exists but is not .*force=True"):
        watch.make(plan, path)
    assert path.read_bytes() == before
    assert watch.parts == []
    watch.make(plan, path, force=True)
    assert RadioMap.load(path).plan_sha256 == plan.sha256


def test_folder_in_the_place_of_a_map_is_left_alone(plan, tmp_path) -> None:
    with pytest.raises(MapFileError, match="not overwritten"):
        make_map(plan, tmp_path, config=QUICK)


def test_interrupted_map_leaves_the_old_file(plan, made) -> None:
    before = made.read_bytes()

    def interrupt(_done, _total):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        make_map(plan, made, config=QUICK, power_dbm=1.0, progress=interrupt)
    assert made.read_bytes() == before
    assert folder_of(made) == ["room.h5"]


@pytest.mark.parametrize("height_m", [0.0, 3.0, -1.0])
def test_receivers_lie_between_floor_and_ceiling(plan, height_m) -> None:
    with pytest.raises(ValueError, match=r"height_m = .*above 0 and below 3 m"):
        make_map(plan, height_m=height_m, config=QUICK)


def test_one_scene_serves_maps_of_other_sources_and_heights(plan, monkeypatch) -> None:
    scene = PlanScene.of(plan)
    moved = replace(plan, source=(4.3, 2.2, 1.1), name="moved")
    expected = make_map(moved, config=QUICK, height_m=1.2)
    monkeypatch.setattr("rssnav.maps.scene_of", None)
    found = make_map(moved, config=QUICK, height_m=1.2, scene=scene)
    for name, layer in expected.layers.items():
        assert np.array_equal(layer, found.layers[name])
    assert found.plan_sha256 == moved.sha256


@pytest.mark.parametrize(
    "options", [{"edition": "P.2040-1"}, {"plan": edited("thickness_m = 0.1", "thickness_m = 0.2")}]
)
def test_scene_of_another_building_is_refused(plan, options) -> None:
    scene = PlanScene.of(plan)
    if "plan" in options:
        plan = floorplans.loads(options.pop("plan"))
    with pytest.raises(ValueError, match=r"does not fit plan 'room'.*PlanScene\.of"):
        make_map(plan, config=QUICK, scene=scene, **options)


def test_map_of_another_plan_is_refused(plan, made) -> None:
    radio_map = RadioMap.load(made)
    require_map_for(plan, radio_map)
    other = replace(plan, height_m=3.0, name="other room")
    with pytest.raises(MapFileError, match=r"room\.h5: .*different plan.*'other room'.*compute it"):
        require_map_for(other, radio_map, made)
    unmarked = radio_map.with_plan("", "")
    with pytest.raises(MapFileError, match="plan_sha256 = none"):
        require_map_for(plan, unmarked)


def test_error_of_the_tracer_names_the_plan() -> None:
    with pytest.raises(SceneError, match="plan 'room': concrete of thickness"):
        scene_of(floorplans.loads(edited("thickness_m = 0.2", "thickness_m = 20")))
