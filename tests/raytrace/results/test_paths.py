"""Every path of the tracer is one of the brute force's, and the other way round."""

import numpy as np
import pytest
import shapely
from brute_force import find_paths
from buildings import GLASS, Building, door, ring, wall, window
from comparing import (
    Facets,
    as_found,
    assert_same_paths,
    check_every_path,
    facets_of,
    off_ties,
)
from hypothesis import given, settings
from hypothesis import strategies as st
from rooms import L_SHAPE, ROOMS, SLANTED, SOURCE

import floorplans
from raytrace import Scene, TraceConfig, Transmitter, trace_paths

EXACT_M = 1e-9

RECTANGLE = ((0.0, 0.0), (6.0, 0.0), (6.0, 4.0), (0.0, 4.0))


@pytest.mark.parametrize("name", ROOMS)
def test_reflections_and_a_diffraction_are_all_found(name: str) -> None:
    receivers = ROOMS[name].random_points(4, seed=11)
    check_every_path(ROOMS[name], SOURCE, receivers, TraceConfig(3, 1), EXACT_M)


@pytest.mark.parametrize("name", ROOMS)
def test_four_reflections_are_all_found(name: str) -> None:
    receivers = ROOMS[name].random_points(3, seed=12)
    check_every_path(ROOMS[name], SOURCE, receivers, TraceConfig(4, 0), EXACT_M)


@pytest.mark.parametrize("degrees", [17.0, 45.0, 101.3])
@pytest.mark.parametrize("name", ["door with lintel", "pillar", "corner of 270 degrees"])
def test_a_building_may_stand_at_any_angle(name: str, degrees: float) -> None:
    turn = np.radians(degrees)
    matrix = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    building = ROOMS[name].moved(matrix, np.array([3.3, -20.7]))
    source, *receivers = building.random_points(4, seed=13)
    check_every_path(building, tuple(source), np.array(receivers), TraceConfig(2, 1), EXACT_M)


@st.composite
def walls(draw: st.DrawFn, outline: tuple) -> tuple:
    """Draw a wall between two points of a lattice: free, joined, crossing others, any height."""
    ground = shapely.Polygon(outline)
    lattice = st.tuples(st.integers(0, 12), st.integers(0, 9))
    ends = st.tuples(lattice, lattice).map(lambda ab: tuple((x / 2, y / 2) for x, y in ab))
    a, b = draw(ends.filter(lambda ab: ab[0] != ab[1] and ground.covers(shapely.LineString(ab))))
    length = float(np.hypot(b[0] - a[0], b[1] - a[1]))
    near, far = 0.25 * length, 0.625 * length
    holes = draw(
        st.sampled_from(
            [(), (door(near, far),), (window(near, far),), (window(near, far, GLASS),)],
        )
    )
    heights = {} if holes else draw(st.sampled_from([{}, {"high": 1.25}, {"low": 1.75}]))
    return wall(a, b, *holes, slab=draw(st.integers(0, 2)), **heights)


@st.composite
def buildings(draw: st.DrawFn) -> Building:
    """Draw a room with one to three walls in it."""
    outline = draw(st.sampled_from([RECTANGLE, L_SHAPE, SLANTED]))
    inside = draw(st.lists(walls(outline), min_size=1, max_size=3))
    return Building(outline, (*ring(outline), *(s for sheets in inside for s in sheets)))


@given(building=buildings(), seed=st.integers(0, 1000))
@settings(max_examples=10)
def test_random_buildings_hide_no_path(building: Building, seed: int) -> None:
    source, *receivers = building.random_points(3, seed)
    check_every_path(building, tuple(source), np.array(receivers), TraceConfig(2, 1), EXACT_M)


def check_scenario(name: str, n_receivers: int, config: TraceConfig) -> None:
    plan = floorplans.load(name)
    walls = plan.to_mesh()
    scene = Scene.from_mesh(walls.mesh, walls.face_material, walls.materials)
    x_min, y_min, x_max, y_max = plan.bounds
    low, high = (x_min, y_min, 0.3), (x_max, y_max, plan.height_m - 0.3)
    receivers = np.random.default_rng(14).uniform(low, high, (n_receivers, 3))
    source = off_ties(plan.source)
    paths = trace_paths(scene, Transmitter(source), receivers, config)
    facets = Facets(np.asarray(walls.mesh.triangles), walls.face_material)
    limits = config.max_reflections, config.max_diffractions
    found = find_paths(facets, np.array(source), receivers, *limits)
    assert len(paths) > 0
    assert_same_paths(as_found(paths), found, EXACT_M)


@pytest.mark.parametrize("name", ["scenario1", "scenario2"])
def test_four_reflections_in_a_scenario(name: str) -> None:
    check_scenario(name, 12, TraceConfig(4, 0))


@pytest.mark.parametrize(("name", "reflections"), [("scenario1", 3), ("scenario2", 2)])
def test_reflections_and_a_diffraction_in_a_scenario(name: str, reflections: int) -> None:
    check_scenario(name, 1, TraceConfig(reflections, 1))


@pytest.mark.parametrize("name", ["pillar", "doors of two heights"])
def test_the_brute_force_prunes_no_path(name: str) -> None:
    room, receivers = ROOMS[name], ROOMS[name].random_points(2, seed=15)
    pruned, whole = (
        find_paths(facets_of(room), np.array(off_ties(SOURCE)), receivers, 2, 1, prune=prune)
        for prune in (True, False)
    )
    assert_same_paths(pruned, whole, EXACT_M)
