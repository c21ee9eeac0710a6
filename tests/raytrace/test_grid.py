"""A grid covers a rectangle with square cells, and is compared by its receivers."""

from dataclasses import replace

import pytest

from raytrace import Grid

GRID = Grid.over((0.0, 0.0, 7.0, 5.0), 0.5, 2.0)


def test_a_grid_is_the_same_up_to_rounding() -> None:
    assert GRID.same_as(replace(GRID, x=GRID.x + 1e-12))


@pytest.mark.parametrize(
    "other",
    [
        replace(GRID, x=GRID.x + 1e-6),
        replace(GRID, y=GRID.y[:-1]),
        replace(GRID, height_m=2.1),
        replace(GRID, cell_size_m=0.6),
    ],
)
def test_a_grid_of_other_receivers_is_another(other: Grid) -> None:
    assert not GRID.same_as(other)
