"""What the tracer refuses, and that it says why."""

from dataclasses import replace

import numpy as np
import pytest
from buildings import CONCRETE, box, mesh_of, wall
from numpy.typing import NDArray

from raytrace import Grid, Scene, SceneError, TraceConfig, Transmitter, trace_paths

ROOM = box(6.0, 4.0)
SLABS = ROOM.slabs


def with_triangle(*corners: tuple[float, float, float]) -> NDArray[np.float64]:
    return np.concatenate([ROOM.triangles, np.array([corners])])


def refused(triangles: NDArray[np.float64], slab: NDArray[np.int64] | None = None) -> str:
    if slab is None:
        slab = np.zeros(len(triangles), dtype=np.int64)
    with pytest.raises(SceneError) as error:
        Scene.from_mesh(mesh_of(triangles), slab, SLABS)
    return str(error.value)


def test_a_sloped_face_is_named() -> None:
    message = refused(with_triangle((1, 1, 0), (2, 1, 0), (1, 2, 1)))
    assert f"faces {len(ROOM.triangles)}" in message
    assert "neither vertical nor horizontal" in message


def test_a_partial_slab_is_named() -> None:
    message = refused(with_triangle((1, 1, 1), (2, 1, 1), (1, 2, 1)))
    assert f"face {len(ROOM.triangles)}" in message
    assert "between floor and ceiling" in message


def test_a_wall_that_is_no_rectangle_is_refused() -> None:
    assert "rectangles" in refused(with_triangle((3, 1, 0), (3, 3, 0), (3, 2, 2)))


def test_floor_and_ceiling_are_needed() -> None:
    assert "floor" in refused(ROOM.triangles[:-4])


def test_floor_and_ceiling_must_cover_the_same_ground() -> None:
    bigger = ROOM.triangles.copy()
    bigger[-2:, :, 0] *= 2.0
    assert "same ground" in refused(bigger)


def test_a_building_must_be_closed() -> None:
    message = refused(ROOM.triangles[2:])
    assert "(" in message
    assert any(word in message for word in ("open", "enclose"))


@pytest.mark.parametrize("high", [1.0, 2.9])
def test_outer_walls_must_reach_the_ceiling(high: float) -> None:
    first = ROOM.sheets[0]._replace(high=high)
    low = replace(ROOM, sheets=(first, *ROOM.sheets[1:]))
    assert "floor to ceiling" in refused(low.triangles)


@pytest.mark.parametrize("number", [4, -1])
def test_a_material_index_must_be_in_the_table(number: int) -> None:
    slab = ROOM.triangle_slab.copy()
    slab[3] = number
    assert f"face 3 refers to material {number}" in refused(ROOM.triangles, slab)


def test_every_face_needs_a_material() -> None:
    assert "each of the 12 faces" in refused(ROOM.triangles, ROOM.triangle_slab[:-1])


def test_an_unknown_material_is_met_with_the_nearest_name() -> None:
    with pytest.raises(SceneError, match="'concrte': did you mean 'concrete'"):
        Scene.from_mesh(mesh_of(ROOM.triangles), ROOM.triangle_slab * 0, [("concrte", 0.2)])


@pytest.mark.parametrize("thickness_m", [0.0, -0.1, np.nan, np.inf])
def test_a_thickness_must_be_positive(thickness_m: float) -> None:
    with pytest.raises(SceneError, match="thickness"):
        Scene.from_mesh(mesh_of(ROOM.triangles), ROOM.triangle_slab * 0, [("wood", thickness_m)])


@pytest.mark.parametrize("place", [(-1.0, 2.0, 1.5), (3.0, 2.0, 3.5), (3.0, 2.0, -0.5)])
def test_a_transmitter_outside_is_refused(place: tuple[float, float, float]) -> None:
    with pytest.raises(SceneError, match="not inside the building"):
        trace_paths(ROOM.scene, Transmitter(place), np.array([[1.0, 1.0, 1.0]]))


@pytest.mark.parametrize("receivers", [np.zeros(3), np.zeros((2, 2)), np.full((1, 3), np.nan)])
def test_receivers_are_finite_points_in_space(receivers: NDArray[np.float64]) -> None:
    with pytest.raises(ValueError, match="receivers"):
        trace_paths(ROOM.scene, Transmitter((1.0, 1.0, 1.0)), receivers)


def test_no_receivers_have_no_paths() -> None:
    paths = trace_paths(ROOM.scene, Transmitter((1.0, 1.0, 1.0)), np.empty((0, 3)))
    assert len(paths) == 0


@pytest.mark.parametrize(
    ("limits", "name"),
    [((-1, 1), "max_reflections"), ((21, 1), "max_reflections"), ((6, 2), "max_diffractions")],
)
def test_limits_are_checked(limits: tuple[int, int], name: str) -> None:
    with pytest.raises(ValueError, match=name):
        TraceConfig(*limits)


@pytest.mark.parametrize(
    ("fields", "name"),
    [
        ({"position": (1.0, 2.0)}, "position"),
        ({"position": (1.0, np.nan, 1.0)}, "position"),
        ({"position": (1.0, np.inf, 1.0)}, "position"),
        ({"frequency_hz": 0.0}, "frequency_hz"),
        ({"frequency_hz": -1.0}, "frequency_hz"),
        ({"power_dbm": np.nan}, "power_dbm"),
    ],
)
def test_a_transmitter_is_checked(fields: dict, name: str) -> None:
    with pytest.raises(ValueError, match=name):
        Transmitter(**({"position": (1.0, 1.0, 1.0)} | fields))


def test_a_grid_lies_at_the_cell_centres() -> None:
    grid = Grid.over((0.0, 10.0, 3.0, 12.0), 0.5, 2.0)
    assert grid.shape == (4, 6)
    np.testing.assert_allclose(grid.x, [0.25, 0.75, 1.25, 1.75, 2.25, 2.75])
    np.testing.assert_allclose(grid.y, [10.25, 10.75, 11.25, 11.75])
    points = grid.points()
    assert points.shape == (24, 3)
    np.testing.assert_allclose(points[1], [0.75, 10.25, 2.0])


@pytest.mark.parametrize(
    ("bounds", "size"),
    [((0.0, 0.0, 1.0, 1.0), 0.0), ((0.0, 0.0, 1.0, 1.0), -1.0), ((1.0, 0.0, 0.0, 1.0), 1.0)],
)
def test_an_impossible_grid_is_refused(bounds: tuple, size: float) -> None:
    with pytest.raises(ValueError, match="no grid"):
        Grid.over(bounds, size, 2.0)


def test_a_wall_that_sticks_out_of_the_building_is_refused() -> None:
    out = box(6.0, 4.0, *wall((3.0, 2.0), (3.0, 6.0), slab=CONCRETE))
    with pytest.raises(SceneError, match="out of the building"):
        out.scene  # noqa: B018
