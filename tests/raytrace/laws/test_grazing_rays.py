"""Rays through corners and horizontal edges; transmitters and receivers on portals and walls."""

from typing import NamedTuple

import numpy as np
import pytest
from helpers.buildings import box, door, wall
from numpy.typing import NDArray

import floorplans
from raytrace import HalfWaveDipole, Scene, TraceConfig, Transmitter, trace_paths
from raytrace.kernels.sums import Sums
from raytrace.solver.accumulate import sum_paths
from raytrace.solver.evaluation import evaluation_of
from raytrace.solver.extruded_classes import path_classes
from raytrace.solver.setup import prepare
from raytrace.solver.workers import Workers

Floats = NDArray[np.float64]
LIMITS = TraceConfig(2, 1)

MOVES = {
    "mirrored in x": (np.diag([-1.0, 1.0]), (0.0, 0.0)),
    "mirrored in y": (np.diag([1.0, -1.0]), (0.0, 0.0)),
    "turned": (np.array([[0.0, -1.0], [1.0, 0.0]]), (0.0, 0.0)),
    "turned twice and shifted": (-np.eye(2), (10.1, -3.7)),
    "shifted": (np.eye(2), (-33.3, 12.7)),
}


class Case(NamedTuple):
    """A plan on a lattice; transmitter and receivers lie on many of its lines and diagonals."""

    plan: floorplans.FloorPlan
    source: Floats
    receivers: Floats
    limits: TraceConfig = LIMITS
    axis: tuple[float, float, float] = (0.0, 0.0, 1.0)

    def moved(self, matrix: Floats, shift: tuple[float, float]) -> Sums:
        """Sums at the receivers, plan, transmitter and receivers moved together."""
        solid = np.eye(3)
        solid[:2, :2] = matrix
        walls = self.plan.to_mesh()
        mesh = walls.mesh.copy()
        mesh.vertices = mesh.vertices @ solid.T + [*shift, 0.0]
        scene = Scene.from_mesh(mesh, walls.face_material, walls.materials)
        x, y, z = solid @ self.source + [*shift, 0.0]
        receivers = self.receivers @ solid.T + [*shift, 0.0]
        antenna = HalfWaveDipole(axis=tuple(solid @ self.axis))
        source = Transmitter((x, y, z), antenna=antenna)
        classes = path_classes(prepare(scene, source.position, receivers, self.limits))
        with Workers() as workers:
            evaluation = evaluation_of(scene.slabs, source, self.limits, antenna)
            return sum_paths(workers, classes, [evaluation])[0]


def lattice(plan: floorplans.FloorPlan, step: float, z: float) -> Floats:
    """Points of a lattice through the walls' own ends."""
    x_min, y_min, x_max, y_max = plan.bounds
    x, y = np.meshgrid(np.arange(x_min, x_max, step), np.arange(y_min, y_max, step))
    return np.column_stack([x.ravel(), y.ravel(), np.full(x.size, z)])


def beside_joints(plan: floorplans.FloorPlan) -> Floats:
    """Return a lattice without the joint of brick and glass at (6, 0).

    What a receiver at a joint of two materials gets of a path over a lintel and through a wall may
    be reflected by either of them (docs/conventions.md).
    """
    points = lattice(plan, 0.75, 1.0)
    return points[~np.all(points[:, :2] == (6.0, 0.0), axis=1)]


def cases() -> dict[str, Case]:
    """Return a building whose cells lie on its lattice, and one with sills and lintels."""
    office = floorplans.load("scenario1")
    flat = floorplans.load("flat")
    window = {o.sill_m for w in flat.walls for o in w.openings if o.sill_m > 0.0}
    at_sill = max(window)
    return {
        "office": Case(office, np.array(office.source), lattice(office, 2.5, 2.0)[::3]),
        "flat": Case(flat, np.array(flat.source), lattice(flat, 0.75, 1.0)),
        "flat, at the height of its sills": Case(
            flat, np.array([*flat.source[:2], at_sill]), lattice(flat, 0.75, at_sill)
        ),
        "flat, through a wall": Case(
            flat, np.array(flat.source), beside_joints(flat), TraceConfig(2, 1, 1)
        ),
        "flat, slanted antennas": Case(
            flat, np.array(flat.source), lattice(flat, 0.75, 1.0), axis=(0.3, -0.5, 0.8)
        ),
    }


@pytest.fixture(scope="module", params=cases())
def case(request: pytest.FixtureRequest) -> Case:
    return cases()[request.param]


@pytest.fixture(scope="module")
def unmoved(case: Case) -> Sums:
    return case.moved(np.eye(2), (0.0, 0.0))


def decibels(size: Floats) -> Floats:
    return 10.0 * np.log10(np.maximum(size, 1e-300))


@pytest.mark.parametrize("move", MOVES)
def test_a_map_moves_with_its_plan(case: Case, unmoved: Sums, move: str) -> None:
    moved = case.moved(*MOVES[move])
    np.testing.assert_allclose(moved.n_paths, unmoved.n_paths, rtol=1e-12)
    power, moved_power = decibels(unmoved.power), decibels(moved.power)
    np.testing.assert_allclose(moved_power, power, rtol=0, atol=1e-9)
    field, moved_field = (decibels(np.abs(s.field[:, 0]) ** 2) for s in (unmoved, moved))
    np.testing.assert_allclose(moved_field, field, rtol=0, atol=1e-9)


def test_some_rays_graze(unmoved: Sums) -> None:
    assert (unmoved.n_paths % 1.0 > 0.0).any()


def test_a_reflection_at_the_end_of_a_lintel_is_the_limit_of_those_close_to_it() -> None:
    """The reflection comes before the diffraction on one side, and behind it on the other."""
    room = box(10.0, 5.0, *wall((4.0, 0.0), (4.0, 5.0), door(3.0, 5.0, head=2.5)))
    y = 3.0 + np.array([-1e-4, 0.0, 1e-4])
    receivers = np.column_stack([np.full(3, 8.0), y, np.full(3, 1.5)])
    paths = trace_paths(room.scene, Transmitter((2.0, 4.0, 2.0)), receivers, TraceConfig(1, 1))
    near_end = np.linalg.norm(paths.vertices[:, 1:3] - [4.0, 5.0, 2.5], axis=2) < 1e-3
    at_end = paths.rows(near_end.all(axis=1))
    before, exact, after = (at_end.rows(at_end.receiver == k) for k in range(3))
    assert len(before.gain) == len(after.gain) == 1
    np.testing.assert_array_equal(exact.weight, 0.5)
    assert {tuple(row) for row in exact.interactions} == {(1, 2), (2, 1)}
    limit = (before.gain + after.gain) / 2.0
    np.testing.assert_allclose(exact.gain, [*limit, *limit], rtol=1e-5)
