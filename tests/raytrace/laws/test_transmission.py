"""Paths through walls."""

import numpy as np
import pytest
from brute_force import find_paths
from brute_force_facets import Facets
from buildings import CONCRETE, PLASTERBOARD, Building, box, door, wall
from comparing import as_found, assert_same_paths, off_ties
from numpy.typing import NDArray

from floorplans import load
from raytrace import Isotropic, Scene, SceneError, TraceConfig, Transmitter, trace_paths
from raytrace.radio.materials import find_material

SLABS = (("concrete", 0.2), ("plasterboard", 0.1), ("glass", 0.01), ("vacuum", 0.1))
VACUUM = 3
SOURCE = (1.7342, 2.2191, 1.3)


def divided(slab: int) -> Building:
    """Return a room of concrete with a wall that has a door, a spur, and a slanted wall."""
    room = box(8.0, 6.0)
    inside = (
        *wall((4.0, 0.0), (4.0, 6.0), door(1.0, 2.0), slab=slab),
        *wall((4.0, 4.0), (6.5, 4.0), slab=slab),
        *wall((4.0, 3.0), (8.0, 0.5), slab=slab),
    )
    return Building(room.outline, (*room.sheets, *inside), slabs=SLABS)


def field(building: Building, receivers: NDArray[np.float64], limits: TraceConfig) -> NDArray:
    source = Transmitter(SOURCE, antenna=Isotropic())
    paths = trace_paths(building.scene, source, receivers, limits, receive_antenna=Isotropic())
    total = np.zeros(len(receivers), np.complex128)
    np.add.at(total, paths.receiver, paths.weight * paths.gain)
    return total


@pytest.mark.parametrize("limits", [TraceConfig(3, 0, 20), TraceConfig(2, 1, 20)])
def test_walls_of_nothing_are_not_there(limits: TraceConfig) -> None:
    """Every straight line through them is found once, and their edges diffract nothing."""
    empty = Building(box(8.0, 6.0).outline, box(8.0, 6.0).sheets, slabs=SLABS)
    receivers = empty.random_points(30, seed=5)
    expected = field(empty, receivers, TraceConfig(limits.max_reflections, 0))
    np.testing.assert_allclose(field(divided(VACUUM), receivers, limits), expected, rtol=1e-6)


def test_a_wall_weakens_the_straight_line_by_its_slab() -> None:
    receiver = np.array([[6.3, 1.9, 1.3]])
    building = Building(
        box(8.0, 6.0).outline,
        (*box(8.0, 6.0).sheets, *wall((4.0, 0.0), (4.0, 6.0), slab=CONCRETE)),
        slabs=SLABS,
    )  # fmt: skip
    (gain,) = field(building, receiver, TraceConfig(0, 0, 1))
    along = receiver[0] - SOURCE
    cos_i = np.array([abs(along[0]) / np.linalg.norm(along)])
    c = find_material("concrete").coefficients(0.2, 2.4e9, cos_i)
    free = Transmitter(SOURCE).wavelength_m / (4.0 * np.pi * np.linalg.norm(along))
    assert abs(gain) == pytest.approx(free * abs(c.t_te[0]), rel=1e-6)


def test_a_path_goes_through_no_more_walls_than_it_may() -> None:
    receivers = divided(PLASTERBOARD).random_points(10, seed=6)
    found = [
        trace_paths(
            divided(PLASTERBOARD).scene, Transmitter(SOURCE), receivers, TraceConfig(1, 1, n)
        )
        for n in range(4)
    ]
    for most, paths in enumerate(found):
        through = np.count_nonzero(paths.interactions == 3, axis=1)
        assert through.max() == most
        for fewer in range(most):
            assert np.count_nonzero(through <= fewer) == len(found[fewer])


@pytest.mark.parametrize(("limits", "n_paths"), [((1, 0, 1), 303), ((2, 0, 2), 2751)])
def test_every_path_through_the_doors_and_windows_of_a_flat(
    limits: tuple[int, int, int], n_paths: int
) -> None:
    """Numbers of paths to a grid of 1 m, as an independent tracer of meshes counts them too."""
    plan = load("flat")
    walls = plan.to_mesh()
    scene = Scene.from_mesh(walls.mesh, walls.face_material, walls.materials)
    source = np.array(off_ties(plan.source))
    x, y = np.meshgrid(np.arange(0.5, 12.0) + 1.1e-4, np.arange(0.5, 9.0) + 2.3e-4)
    receivers = np.column_stack([x.ravel(), y.ravel(), np.full(x.size, 1.1)])
    paths = trace_paths(scene, Transmitter(tuple(source)), receivers, TraceConfig(*limits))
    facets = Facets(np.asarray(walls.mesh.triangles), np.asarray(walls.face_material))
    assert_same_paths(as_found(paths), find_paths(facets, source, receivers, *limits), 1e-9)
    assert len(paths) == n_paths


def test_a_room_without_a_door_is_heard_through_its_walls() -> None:
    closed = (*box(8.0, 6.0).sheets, *wall((4.0, 0.0), (4.0, 6.0)))
    building = Building(box(8.0, 6.0).outline, closed, slabs=SLABS)
    receiver = np.array([[6.0, 3.0, 1.5]])
    assert field(building, receiver, TraceConfig(2, 1))[0] == 0.0
    assert abs(field(building, receiver, TraceConfig(2, 1, 1))[0]) > 0.0


def test_a_transmitter_does_not_stand_in_a_wall() -> None:
    with pytest.raises(SceneError, match=r"stands in the wall from \(4, .*move it"):
        trace_paths(divided(CONCRETE).scene, Transmitter((4.0, 5.0, 1.0)), np.zeros((1, 3)))
