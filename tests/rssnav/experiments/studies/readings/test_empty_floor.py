"""The exact search of flights on the empty floor, beside an enumeration of all flights."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest

from rssnav.experiments.paper.counting import Count
from rssnav.experiments.studies.readings.empty_floor import (
    FLOORS,
    Floor,
    Lattice,
    arrivals,
    lattice,
)
from rssnav.experiments.studies.readings.interpretations import STATED_GOAL, Geometry, Goal
from rssnav.experiments.studies.readings.lengths import StepCounts
from rssnav.world import ACTIONS

MOST_STEPS = 4


def enumerated(receivers: Lattice, count: Count) -> set[tuple[int, int]]:
    """Counted (steps, diagonal) of every flight of at most MOST_STEPS counted steps."""
    found: set[tuple[int, int]] = set()
    n_y, n_x = receivers.goal.shape

    def fly(row: int, column: int, diagonals: tuple[bool, ...]) -> None:
        if receivers.goal[row, column]:
            if diagonals:
                counted = {
                    Count.ALL: diagonals,
                    Count.WITHOUT_LAST: diagonals[:-1],
                    Count.WITHOUT_FIRST: diagonals[1:],
                }[count]
                found.add((len(counted), sum(counted)))
            return
        if len(diagonals) > MOST_STEPS:
            return
        for dx, dy in ACTIONS.tolist():
            if 0 <= row + dy < n_y and 0 <= column + dx < n_x:
                fly(row + dy, column + dx, (*diagonals, dx != 0 and dy != 0))

    fly(*receivers.start, ())
    return {counts for counts in found if counts[0] <= MOST_STEPS}


@pytest.mark.parametrize("count", Count)
@pytest.mark.parametrize("goal_at", [(0, 0), (0, 3), (2, 3), (1, 1)])
def test_the_search_finds_the_flights_that_an_enumeration_finds(
    goal_at: tuple[int, int], count: Count
) -> None:
    goal = np.zeros((3, 4), bool)
    goal[goal_at] = True
    receivers = Lattice((2, 1), goal)
    found = arrivals(receivers, MOST_STEPS)
    searched = {
        (n, b)
        for n, b in product(range(MOST_STEPS + 1), range(MOST_STEPS + 1))
        if b <= n and found.has(StepCounts(n, b), count)
    }
    assert searched == enumerated(receivers, count)


def test_a_start_in_the_goal_is_no_flight() -> None:
    receivers = Lattice((0, 0), np.array([[True, False]]))
    assert arrivals(receivers, 3).least_steps == -1


@pytest.mark.parametrize("speed", [1, 2, 4])
@pytest.mark.parametrize("offset_m", [0.5, 0.0, -0.5, -1.0])
def test_receivers_of_a_speed_are_the_reachable_ones_of_the_finest_grid(
    speed: int, offset_m: float
) -> None:
    geometry = Geometry(offset_m, (0.0, 0.0), Goal(2.5, closed=True))
    fine, coarse = (lattice(FLOORS[1], geometry, v) for v in (1, speed))
    row, column = fine.start
    assert np.array_equal(fine.goal[row % speed :: speed, column % speed :: speed], coarse.goal)
    assert coarse.start == (row // speed, column // speed)


def test_receivers_stay_off_the_border() -> None:
    floor = Floor((4, 3), (2, 1), (1.0, 1.0))
    assert lattice(floor, Geometry(0.0, (0.0, 0.0), STATED_GOAL), 1).goal.shape == (2, 3)
    assert lattice(floor, Geometry(0.5, (0.0, 0.0), STATED_GOAL), 1).goal.shape == (3, 4)


def test_straight_steps_fix_the_parity_of_the_receiver_at_the_end() -> None:
    """The premise of the proof by parity, in the search itself."""
    goal = np.zeros((5, 6), bool)
    goal[3, 4] = True
    found = arrivals(Lattice((1, 1), goal), 9)
    for n in range(10):
        for b in range(n + 1):
            if found.has(StepCounts(n, b), Count.ALL):
                assert (n - b) % 2 == (3 + 4 - 1 - 1) % 2
