"""Whatever stands in a plan, the tracer finds the brute force's paths, each one, to 1e-9 m."""

import re
from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import pytest
from buildings import (
    CONCRETE,
    GLASS,
    PLASTERBOARD,
    Building,
    Sheet,
    box,
    door,
    mesh_of,
    ring,
    wall,
    window,
)
from comparing import check_every_gain, check_every_path

from raytrace import Scene, SceneError, SceneWarning, TraceConfig, Transmitter, trace_paths
from raytrace.geometry.junctions import NEAR_M

SOURCE = (1.25, 1.53125, 1.1875)
TOLERANCE_M = 1e-9
PILLAR = ((3.0, 1.5), (3.5, 1.5), (3.5, 2.0), (3.0, 2.0))
DIAMOND = ((3.0, 1.0), (4.25, 2.0), (3.25, 3.25), (2.25, 2.25))
SMALL_DIAMOND = ((3.0, 1.75), (3.5, 2.0), (3.125, 2.5))


def boards(start: tuple[float, float], end: tuple[float, float], *tops: float) -> tuple[Sheet, ...]:
    """Return boards above each other, every other interval of height open."""
    intervals = zip(tops[::2], tops[1::2], strict=True)
    return tuple(Sheet(start, end, *z, k % 3) for k, z in enumerate(intervals))


def boards_of(
    start: tuple[float, float], end: tuple[float, float], *tops: float
) -> tuple[Sheet, ...]:
    """Return a wall of boards of different slabs, without an opening."""
    intervals = pairwise((0.0, *tops))
    return tuple(Sheet(start, end, *z, k % 3) for k, z in enumerate(intervals))


def storey(*inside: Sheet) -> Building:
    """Return a room of 6 m x 4 m around walls."""
    return box(6.0, 4.0, *inside)


ACROSS = (3.5, 0.0), (3.5, 4.0)

PLANS: dict[str, Building] = {
    "pillar with a spur": storey(*ring(PILLAR), *wall((3.5, 1.75), (4.5, 2.25))),
    "wall through a pillar": storey(*ring(DIAMOND), *wall((2.875, 1.875), (5.0, 2.5))),
    "pillars tied by a wall": storey(
        *ring(PILLAR),
        *ring([(x + 1.5, y + 0.75) for x, y in PILLAR]),
        *wall((3.5, 1.75), (4.5, 2.5)),
    ),
    "pillar in a hollow pillar": storey(*ring(DIAMOND), *ring(SMALL_DIAMOND)),
    "pillar on a wall": storey(*wall(*ACROSS, door(0.25, 1.25)), *ring(PILLAR)),
    "free walls that cross": storey(
        *wall((2.5, 1.0), (4.5, 3.0)), *wall((2.75, 3.0), (4.25, 1.25))
    ),
    "wall of half height to a wall": storey(
        *wall(*ACROSS, door(2.5, 3.5)), *wall((3.5, 1.5), (5.25, 1.5), high=1.0)
    ),
    "half-height walls of two heights that cross": storey(
        *wall((2.5, 1.0), (4.5, 3.0), high=1.0), *wall((2.75, 3.0), (4.25, 1.25), high=1.5)
    ),
    "openings at different heights": storey(
        *wall(*ACROSS, window(0.25, 1.0), door(1.25, 2.0), door(2.25, 2.75, head=2.625))
    ),
    "opening above an opening": storey(
        *wall((3.5, 0.0), (3.5, 1.0)),
        *boards((3.5, 1.0), (3.5, 2.25), 0.75, 1.25, 2.0, 3.0),
        *wall((3.5, 2.25), (3.5, 4.0)),
    ),
    "as many wall heights as storeys have": storey(
        *boards((3.5, 0.0), (3.5, 4.0), 0.25, 0.5, 0.75, 1.0, 1.25, 1.5, 1.75, 2.0, 2.25, 2.5),
        *boards((4.75, 0.0), (4.75, 3.0), 0.0, 0.625, 1.375, 1.625, 2.375, 3.0),
    ),
    "the same wall twice": storey(*wall(*ACROSS, door(1.0, 2.0)), *wall(*ACROSS, door(1.0, 2.0))),
    "walls that overlap": storey(
        *wall((3.5, 0.0), (3.5, 2.5)), *wall((3.5, 1.5), (3.5, 3.25), slab=CONCRETE)
    ),
    "a low wall before a wall with a window": storey(
        *wall(*ACROSS, window(1.0, 2.5)), *wall((3.5, 0.5), (3.5, 3.0), slab=GLASS, high=1.25)
    ),
    "a shut door and an open one": storey(
        *wall(*ACROSS, door(0.5, 1.5, filling=GLASS), door(2.0, 3.0))
    ),
    "a glazed window": storey(*wall(*ACROSS, window(0.5, 2.5, GLASS))),
    "boards of three materials": storey(*boards_of(*ACROSS, 0.75, 1.75, 3.0)),
    "a shut door behind a half-height wall": storey(
        *wall(*ACROSS, door(1.0, 2.5, filling=CONCRETE)), *wall((4.5, 0.0), (4.5, 4.0), high=1.25)
    ),
    "a wall along the outside wall": storey(*wall((6.0, 1.0), (6.0, 3.0), slab=PLASTERBOARD)),
    "two rooms without a door": storey(*wall(*ACROSS)),
}


@pytest.mark.parametrize("name", PLANS)
def test_every_path_with_a_diffraction_is_found(name: str) -> None:
    receivers = PLANS[name].random_points(3, seed=61)
    check_every_path(PLANS[name], SOURCE, receivers, TraceConfig(2, 1), TOLERANCE_M)


@pytest.mark.parametrize("name", PLANS)
def test_every_path_of_four_reflections_is_found(name: str) -> None:
    receivers = PLANS[name].random_points(3, seed=62)
    check_every_path(PLANS[name], SOURCE, receivers, TraceConfig(4, 0), TOLERANCE_M)


@pytest.mark.parametrize("limits", [(1, 1, 3), (2, 0, 2)])
@pytest.mark.parametrize("name", PLANS)
def test_every_path_through_walls_is_found(name: str, limits: tuple[int, int, int]) -> None:
    receivers, config = PLANS[name].random_points(3, seed=65), TraceConfig(*limits)
    check_every_path(PLANS[name], SOURCE, receivers, config, TOLERANCE_M)
    check_every_gain(PLANS[name], SOURCE, receivers, config)


@pytest.mark.parametrize("name", ["pillar with a spur", "walls that overlap"])
@pytest.mark.parametrize("degrees", [3.7, 30.0, 211.0])
def test_every_path_is_found_at_any_angle(name: str, degrees: float) -> None:
    turn = np.radians(degrees)
    matrix = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    building = PLANS[name].moved(matrix, np.array([-71.3, 40.9]))
    source, *receivers = building.random_points(3, seed=63)
    check_every_path(building, tuple(source), np.array(receivers), TraceConfig(2, 1), TOLERANCE_M)


def test_behind_a_closed_wall_it_is_dark() -> None:
    receivers = np.array([[4.5, 1.7, 1.2], [2.5, 1.7, 1.2]])
    paths = trace_paths(PLANS["two rooms without a door"].scene, Transmitter(SOURCE), receivers)
    assert len(paths.at(0)) == 0
    assert len(paths.at(1)) == 377


def test_a_source_in_a_pillar_lights_the_pillar_alone() -> None:
    hollow = PLANS["pillar in a hollow pillar"]
    receivers = np.array([[3.1, 1.4, 1.2], [3.2, 2.1, 1.2], [1.0, 1.0, 1.2]])
    paths = trace_paths(hollow.scene, Transmitter((3.375, 2.8125, 1.0)), receivers)
    reached = [len(paths.at(k)) > 0 for k in range(3)]
    assert reached == [True, False, False]


JOINTS: dict[str, Sequence[tuple[tuple[float, float], tuple[float, float]]]] = {
    "T short of the wall": [((3.5, 0.0), (3.5, 3.9995))],
    "T through the wall": [((3.5, -0.0004), (3.5, 4.0))],
    "slanted T": [((2.9995, 0.0007), (3.9996, 3.9993))],
    "corner with a gap": [((3.5, 0.0), (3.5, 1.9994)), ((3.5004, 2.0), (6.0, 2.0))],
    "wall with a gap": [((3.5, 0.0), (3.5, 1.9994)), ((3.5, 2.0), (3.5, 4.0))],
}
EXACT = {
    "T short of the wall": [((3.5, 0.0), (3.5, 4.0))],
    "T through the wall": [((3.5, 0.0), (3.5, 4.0))],
    "corner with a gap": [((3.5, 0.0), (3.5, 2.0)), ((3.5, 2.0), (6.0, 2.0))],
    "wall with a gap": [((3.5, 0.0), (3.5, 2.0)), ((3.5, 2.0), (3.5, 4.0))],
}


def scene_of(building: Building) -> Scene:
    return Scene.from_mesh(mesh_of(building.triangles), building.triangle_slab, building.slabs)


@pytest.mark.parametrize("name", JOINTS)
def test_walls_that_nearly_meet_are_joined_with_a_warning(name: str) -> None:
    building = storey(*(s for ends in JOINTS[name] for s in wall(*ends)))
    with pytest.warns(SceneWarning, match="moved onto it: the wall from .* onto the wall from"):
        scene = scene_of(building)
    behind = np.array([[5.5, 1.0, 1.2]])
    assert len(trace_paths(scene, Transmitter(SOURCE), behind)) == 0


@pytest.mark.parametrize("name", EXACT)
def test_joined_walls_are_traced_like_exact_ones(name: str) -> None:
    nearly, exactly = (
        storey(*(s for ends in walls[name] for s in wall(*ends))) for walls in (JOINTS, EXACT)
    )
    with pytest.warns(SceneWarning):
        joined = scene_of(nearly)
    receivers = exactly.random_points(4, seed=64)
    lengths = [
        np.sort(trace_paths(scene, Transmitter(SOURCE), receivers, TraceConfig(3, 1)).length_m)
        for scene in (joined, exactly.scene)
    ]
    np.testing.assert_allclose(*lengths, rtol=0, atol=TOLERANCE_M)


def test_the_warning_names_both_walls_and_how_far() -> None:
    building = storey(*wall((3.5, 0.0), (3.5, 3.9995)))
    expected = re.escape(
        "1 wall end within 1 mm of another wall moved onto it: the wall from (3.5, 0) to "
        "(3.5, 3.9995) by 0.5 mm at (3.5, 4), onto the wall from (6, 4) to (0, 4)"
    )
    with pytest.warns(SceneWarning, match=expected):
        scene_of(building)


def test_a_wider_gap_stays_open() -> None:
    building = storey(*wall((3.5, 0.0), (3.5, 4.0 - 1.5 * NEAR_M)))
    paths = trace_paths(
        building.scene, Transmitter(SOURCE), np.array([[5.5, 1.0, 1.2]]), TraceConfig(1, 1)
    )
    assert len(paths) > 0


def test_a_gap_in_the_outside_wall_is_refused() -> None:
    corners = ((0.0, 0.0), (6.0, 0.0), (6.0, 4.0), (0.0, 4.0))
    sheets = (*ring(corners)[:-1], *wall((0.0, 3.9), (0.0, 0.0)))
    with pytest.raises(SceneError, match="enclose"):
        _ = Building(corners, sheets).scene
