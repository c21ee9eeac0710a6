"""A grid covers a rectangle with square cells, and is compared by its receivers."""

from dataclasses import replace

import numpy as np
import pytest

from raytrace import Grid, SceneError

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


@pytest.mark.parametrize(
    ("bounds", "cell_size_m", "error"),
    [((0, 0, 1), 1.0, ValueError), ((0, 0, 1, np.nan), 1.0, ValueError),
     ((0, 0, 1, 1), np.inf, ValueError), ((0, 0, 1e3, 1e3), 1e-3, SceneError)],
)  # fmt: skip
def test_numbers_that_make_no_grid_are_refused(bounds, cell_size_m, error) -> None:
    with pytest.raises(error, match="expected"):
        Grid.over(bounds, cell_size_m, 1.0)
