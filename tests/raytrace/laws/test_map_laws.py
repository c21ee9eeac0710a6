"""What a map may not depend on, and what it must."""

from dataclasses import replace

import numpy as np
import pytest
from buildings import CONCRETE, Building, box, door, mesh_of, ring, wall, window
from comparing import as_found, assert_same_paths
from numpy.typing import NDArray

from raytrace import (
    Grid,
    Isotropic,
    Paths,
    RadioMap,
    Scene,
    TraceConfig,
    Transmitter,
    compute_radio_map,
    trace_paths,
)

Floats = NDArray[np.float64]

OFFICE = box(
    10.0, 7.0,
    *wall((4.0, 0.0), (4.0, 7.0), door(1.0, 2.0), window(4.0, 5.5)),
    *wall((4.0, 3.0), (10.0, 3.0), door(3.0, 4.0)),
    *wall((7.0, 5.0), (7.0, 7.0), high=1.25, slab=CONCRETE),
)  # fmt: skip
SOURCE = (1.734, 5.219, 1.5)
LIMITS = TraceConfig(4, 1)
GRID = Grid.over((0.317, 0.291, 9.8, 6.9), 0.77, 2.0)
QUARTER = np.array([[0.0, -1.0], [1.0, 0.0]])
MIRROR = np.array([[-1.0, 0.0], [0.0, 1.0]])


def traced(
    building: Building, source: tuple[float, ...], receivers: Floats, limits: TraceConfig = LIMITS
) -> Paths:
    return trace_paths(building.scene, Transmitter(source), receivers, limits)


def office_map(scene: Scene | None = None, threads: int | None = None) -> RadioMap:
    return compute_radio_map(
        scene or OFFICE.scene, Transmitter(SOURCE), GRID, LIMITS, threads=threads
    )


def powers(paths: Paths, n: int) -> Floats:
    return np.bincount(paths.receiver, np.abs(paths.gain) ** 2, minlength=n)


def test_a_map_is_the_sum_of_its_paths() -> None:
    radio_map = office_map()
    paths = traced(OFFICE, SOURCE, GRID.points())
    n = radio_map.rss_dbm.size
    field = np.zeros(n, dtype=np.complex128)
    np.add.at(field, paths.receiver, paths.gain)
    counted = np.bincount(paths.receiver, minlength=n)
    np.testing.assert_array_equal(radio_map.path_count.ravel(), counted)
    power = 10.0 ** ((radio_map.rss_dbm.ravel() - 25.0) / 10.0)
    np.testing.assert_allclose(power, powers(paths, n), rtol=1e-10)
    coherent = 10.0 ** ((radio_map.rss_coherent_dbm.ravel() - 25.0) / 10.0)
    np.testing.assert_allclose(coherent, np.abs(field) ** 2, rtol=1e-8)


@pytest.mark.parametrize("threads", [1, 2, 3])
def test_threads_and_runs_change_no_bit(threads: int) -> None:
    one, other = office_map(), office_map(threads=threads)
    for layer in ("rss_dbm", "rss_coherent_dbm", "path_count"):
        np.testing.assert_array_equal(getattr(one, layer), getattr(other, layer))


def test_the_triangulation_does_not_matter() -> None:
    rng = np.random.default_rng(41)
    mesh = mesh_of(OFFICE.triangles)
    slab = OFFICE.triangle_slab
    finer = mesh.subdivide()
    triangles = np.asarray(finer.triangles)
    parts = len(triangles) // len(slab)
    order = rng.permutation(len(triangles))
    turned = np.array([np.roll(t, k, axis=0) for t, k in zip(triangles, order, strict=True)])
    scene = Scene.from_mesh(mesh_of(turned[order]), np.repeat(slab, parts)[order], OFFICE.slabs)
    assert same_maps(office_map(), office_map(scene))


def same_maps(one: RadioMap, other: RadioMap) -> bool:
    np.testing.assert_array_equal(one.path_count, other.path_count)
    np.testing.assert_allclose(one.rss_dbm, other.rss_dbm, rtol=0, atol=1e-9)
    np.testing.assert_allclose(one.rss_coherent_dbm, other.rss_coherent_dbm, rtol=0, atol=1e-6)
    return True


@pytest.mark.parametrize(
    ("matrix", "shift"),
    [
        (np.eye(2), np.array([64.0, -32.5])),
        (QUARTER, np.array([0.0, 0.0])),
        (QUARTER @ QUARTER, np.array([16.0, 8.0])),
        (MIRROR, np.array([0.0, 0.0])),
    ],
    ids=["moved", "turned", "turned twice and moved", "mirrored"],
)
def test_paths_move_with_the_building(matrix: Floats, shift: Floats) -> None:
    """No ray between transmitter and receivers grazes an edge."""
    receivers = OFFICE.random_points(5, seed=42)
    moved_source = matrix @ np.array(SOURCE[:2]) + shift
    moved_receivers = receivers.copy()
    moved_receivers[:, :2] = receivers[:, :2] @ matrix.T + shift
    there = (float(moved_source[0]), float(moved_source[1]), SOURCE[2])
    here = traced(OFFICE, SOURCE, receivers)
    moved = traced(OFFICE.moved(matrix, shift), there, moved_receivers)
    assert len(here) == len(moved)
    moved_vertices = here.vertices.copy()
    moved_vertices[..., :2] = here.vertices[..., :2] @ matrix.T + shift
    assert_same_paths(as_found(moved), as_found(replace(here, vertices=moved_vertices)), 1e-9)
    np.testing.assert_allclose(powers(moved, 5), powers(here, 5), rtol=1e-7)


def test_a_path_and_its_reverse_have_one_gain() -> None:
    ends = OFFICE.random_points(6, seed=43)
    for a, b in zip(ends[:3], ends[3:], strict=True):
        limits = TraceConfig(3, 1)
        forth = traced(OFFICE, tuple(a), b[None], limits)
        back = traced(OFFICE, tuple(b), a[None], limits)
        assert len(forth) == len(back) > 100
        order_forth, order_back = np.argsort(forth.length_m), np.argsort(back.length_m)
        np.testing.assert_allclose(
            forth.length_m[order_forth], back.length_m[order_back], rtol=0, atol=1e-9
        )
        np.testing.assert_allclose(
            forth.gain[order_forth], back.gain[order_back], rtol=1e-6, atol=1e-15
        )


def test_more_reflections_only_add_paths() -> None:
    receivers = OFFICE.random_points(4, seed=44)
    deepest = traced(OFFICE, SOURCE, receivers, TraceConfig(4, 1))
    for order in range(4):
        paths = traced(OFFICE, SOURCE, receivers, TraceConfig(order, 1))
        reflections = (deepest.interactions == 1).sum(axis=1)
        expected = np.sort(deepest.length_m[reflections <= order])
        np.testing.assert_allclose(np.sort(paths.length_m), expected, rtol=0, atol=1e-9)


def test_without_diffraction_the_reflections_stay() -> None:
    receivers = OFFICE.random_points(4, seed=45)
    both = traced(OFFICE, SOURCE, receivers, TraceConfig(3, 1))
    only = traced(OFFICE, SOURCE, receivers, TraceConfig(3, 0))
    kept = ~(both.interactions == 2).any(axis=1)
    np.testing.assert_array_equal(np.sort(both.length_m[kept]), np.sort(only.length_m))


def test_a_metal_room_keeps_more_than_one_of_plasterboard() -> None:
    metal = replace(OFFICE, slabs=tuple(("metal", d) for _, d in OFFICE.slabs))
    grid_power = office_map().rss_dbm
    assert (office_map(metal.scene).rss_dbm > grid_power).all()


@pytest.mark.parametrize("receiver", [(11.0, 3.0, 2.0), (5.0, -1.0, 2.0), (5.0, 3.5, 4.0)])
def test_outside_the_building_there_is_nothing(receiver: tuple[float, float, float]) -> None:
    assert len(traced(OFFICE, SOURCE, np.array([receiver]))) == 0
    grid = Grid(np.array([receiver[0]]), np.array([receiver[1]]), receiver[2], 1.0)
    radio_map = compute_radio_map(OFFICE.scene, Transmitter(SOURCE), grid, LIMITS)
    assert radio_map.rss_dbm[0, 0] == radio_map.rss_coherent_dbm[0, 0] == -np.inf
    assert radio_map.path_count[0, 0] == 0


def test_a_room_without_a_door_is_dark() -> None:
    cell = ((6.0, 1.0), (8.0, 1.0), (8.0, 3.0), (6.0, 3.0))
    closed = replace(OFFICE, sheets=(*OFFICE.sheets[:4], *ring(cell)))
    grid = Grid.over((6.0, 1.0, 8.0, 3.0), 0.5, 1.5)
    radio_map = compute_radio_map(closed.scene, Transmitter(SOURCE), grid, LIMITS)
    assert (radio_map.rss_dbm == -np.inf).all()
    assert (radio_map.path_count == 0).all()


def test_no_number_is_nan() -> None:
    """Receivers on walls, on corners, on the source, straight above it, and outside."""
    places = [(4.0, 2.5), (0.0, 0.0), (4.0, 1.0), SOURCE[:2], (7.0, 5.0), (-1.0, 2.0)]
    receivers = np.array([(x, y, z) for x, y in places for z in (1.25, 1.5, 2.25)])
    paths = traced(OFFICE, SOURCE, receivers, TraceConfig(2, 1))
    assert np.isfinite(paths.gain).all()
    assert np.isfinite(paths.vertices).all()
    assert np.isfinite(paths.length_m).all()


def test_paths_are_sorted_and_tell_their_angles_and_delays() -> None:
    receivers = OFFICE.random_points(3, seed=46)
    source = Transmitter(SOURCE, antenna=Isotropic())
    paths = trace_paths(OFFICE.scene, source, receivers, TraceConfig(2, 1))
    for k in range(3):
        mine = paths.at(k)
        assert (np.diff(np.abs(mine.gain)) <= 0.0).all()
        steps = np.linalg.norm(np.diff(mine.vertices, axis=1), axis=2)
        np.testing.assert_allclose(mine.length_m, steps.sum(axis=1), atol=1e-12)
        np.testing.assert_allclose(mine.delay_s * 299_792_458.0, mine.length_m)
        last = mine.n_interactions
        for angles, ray in (
            (mine.departure, mine.vertices[:, 1] - mine.vertices[:, 0]),
            (mine.arrival, mine.vertices[range(len(mine)), last] - receivers[k]),
        ):
            azimuth, zenith = angles.T
            sine = np.sin(zenith)
            unit = np.column_stack([sine * np.cos(azimuth), sine * np.sin(azimuth), np.cos(zenith)])
            length = np.linalg.norm(ray, axis=1)[:, None]
            np.testing.assert_allclose(unit, ray / length, atol=1e-9)
