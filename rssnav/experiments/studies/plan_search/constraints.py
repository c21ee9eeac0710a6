"""Which printed flights exist in a floor plan, searched exactly.

As on the empty floor (:mod:`rssnav.experiments.studies.readings.empty_floor`), but along the steps
that the walls leave.
"""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from raytrace import Grid
from rssnav.agents import RssAgent
from rssnav.experiments.paper.counting import SUPPORTED_COUNT
from rssnav.experiments.paper.data import AGENTS, Configuration
from rssnav.experiments.paper.scenarios import SPEEDS
from rssnav.experiments.studies.readings.empty_floor import ONE, Arrivals, Words, entries
from rssnav.experiments.studies.readings.interpretations import STATED_GOAL
from rssnav.experiments.studies.readings.lengths import StepCounts, supposed_counts
from rssnav.maps import CELL_SIZE_M, HEIGHT_M
from rssnav.missions.layout import ACTIONS, Layout

if TYPE_CHECKING:
    from floorplans import FloorPlan
    from raytrace import RadioMap

UNKNOWN = Configuration(2, "rss", 2)
"""Its printed length, 121.65 m, is no flight's, so no flight of it is required."""

PAPERS_AGENT = RssAgent()


@cache
def required_counts(scenario: int, speed: int) -> tuple[StepCounts, ...]:
    """Counted steps of the flights that a plan must allow."""
    counts = supposed_counts()
    keys = [Configuration(scenario, agent, speed) for agent in AGENTS]
    return tuple(counts[key] for key in keys if key != UNKNOWN)


def fewest_wanted(scenario: int, speed: int) -> int:
    """Steps of the shorter one of the two printed flights, the one that is left out included."""
    return 1 + min(counts.steps for counts in required_counts(scenario, speed))


def allows_printed_flights(plan: FloorPlan, scenario: int) -> bool:
    """Whether the printed flights exist in a plan, and none has fewer steps.

    Trained agents fly the fewest steps or one or two more, so in a plan with shorter flights they
    would not fly as long as printed.

    Parameters
    ----------
    plan : FloorPlan
        With source and start.
    scenario : int
        Whose flights.

    Returns
    -------
    bool
    """
    return all(_allows(plan, scenario, speed) for speed in sorted(SPEEDS, reverse=True))


def _allows(plan: FloorPlan, scenario: int, speed: int) -> bool:
    required = required_counts(scenario, speed)
    found = arrivals(plan, speed, max(counts.steps for counts in required) + 1)
    return found.least_steps == fewest_wanted(scenario, speed) and all(
        found.has(counts, SUPPORTED_COUNT) for counts in required
    )


def has_the_stated_map(plan: FloorPlan, radio_map: RadioMap) -> bool:
    """Whether a plan's map is such as the paper says of its maps.

    Every cell can be flown to and is heard, no two cells read the same, since each reading is a
    state, and more than -21 dBm are read exactly at the cells of the goal, D < 2 m.

    Parameters
    ----------
    plan : FloorPlan
        With source and start.
    radio_map : RadioMap
        Its map.

    Returns
    -------
    bool
    """
    rss_dbm = radio_map.rss_dbm
    if rss_dbm.min() <= PAPERS_AGENT.sensitivity_dbm or np.unique(rss_dbm).size < rss_dbm.size:
        return False
    layout = Layout.of_plan(plan, radio_map.grid)
    near = STATED_GOAL.contains(layout.distance_m(*plan.require_source()[:2]))
    ends_flights = rss_dbm.ravel() > PAPERS_AGENT.terminal_dbm
    reached = layout.reachable(layout.nearest(*plan.require_start()))
    return np.array_equal(ends_flights, near) and reached.size == rss_dbm.size


def arrivals(plan: FloorPlan, speed: int, most_steps: int) -> Arrivals:
    """Find how flights in a plan enter the goal.

    Parameters
    ----------
    plan : FloorPlan
        With source and start.
    speed : int
        Cells a step moves along an axis.
    most_steps : int
        Most steps of a flight, all counted.

    Returns
    -------
    Arrivals
        Without flights whose first step is left out.
    """
    layout = Layout.of_plan(plan, _lattice(plan, speed))
    start = layout.nearest(*plan.require_start())
    goal = STATED_GOAL.contains(layout.distance_m(*plan.require_source()[:2]))
    words = np.zeros(layout.n_states, np.uint64)
    words[start] = ~goal[start]
    straight, diagonal = entries(goal, words, most_steps, _Steps(layout))
    return Arrivals(straight, diagonal, [0] * len(straight))


def _lattice(plan: FloorPlan, speed: int) -> Grid:
    """Grid of the cells that can be reached at a speed; one step moves by one of them."""
    x_min, y_min, x_max, y_max = plan.bounds
    step_m = speed * CELL_SIZE_M
    x, y = (
        np.arange(least + (start - least) % step_m, most, step_m)
        for start, least, most in zip(
            plan.require_start(), (x_min, y_min), (x_max, y_max), strict=True
        )
    )
    return Grid(x, y, HEIGHT_M, step_m)


class _Steps:
    """The steps of a layout, for words of its cells."""

    def __init__(self, layout: Layout) -> None:
        mask = layout.action_mask
        self._cells = [np.flatnonzero(mask[:, action]) for action in range(len(ACTIONS))]
        self._next = layout.next_state

    def __call__(self, words: Words) -> tuple[Words, Words]:
        """Words after one more step; the cells after one action differ from each other."""
        straight, diagonal = np.zeros_like(words), np.zeros_like(words)
        for action, cells in enumerate(self._cells):
            target = diagonal if action % 2 else straight
            target[self._next[cells, action]] |= words[cells]
        return straight, diagonal << ONE
