"""Missions in which doors open and close: a shut door blocks steps, and changes the radio field.

Only doors that can be closed without cutting cells off make a mission: then a shut door means a
detour, not failure.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import dijkstra

from floorplans import FloorPlan
from raytrace import Antenna, Grid, TraceConfig
from rssnav.arguments import require
from rssnav.doors import Door, doors_of, shut_doors, with_changed
from rssnav.maps import CELL_SIZE_M, HEIGHT_M
from rssnav.missions.layout import Layout
from rssnav.missions.mission import Mission
from rssnav.missions.modes import ModeProcess
from rssnav.missions.places import fields_of_places, mission_of_fields
from rssnav.progress import Progress

MOST_DOORS = 6
"""Each further door doubles the number of radio maps."""


def detour_doors(
    plan: FloorPlan,
    layout: Layout,
    places: Sequence[tuple[float, float, float]],
    n: int,
) -> tuple[Door, ...]:
    """Choose doors that lengthen the ways to some places most when they are closed.

    One after another is added: the one that together with those before lengthens the ways from all
    cells most, if all cells can still be reached. Of equal ones the first is taken.

    Parameters
    ----------
    plan : FloorPlan
        Its open doors are chosen from.
    layout : Layout
        Cells that must stay reachable, connected with all doors as in the plan.
    places : sequence of (float, float, float)
        Where the ways lead [m].
    n : int
        Most doors.
    """
    shut = set(shut_doors(plan))
    doors = [door for door in doors_of(plan) if door not in shut]
    blocked = [_blocked(plan, layout, (door,)) for door in doors]
    goals = np.array([layout.nearest(x, y) for x, y, _ in places])
    chosen: list[int] = []
    closed, total = np.zeros_like(layout.action_mask), _steps_to(layout, goals)
    for _ in range(n):
        totals = {
            k: _steps_to(_without(layout, closed | blocked[k]), goals)
            for k in range(len(doors))
            if k not in chosen
        }
        longer = {k: steps for k, steps in totals.items() if total < steps < np.inf}
        if not longer:
            break
        best = max(longer, key=lambda k: longer[k])
        chosen.append(best)
        closed, total = closed | blocked[best], longer[best]
    return tuple(doors[k] for k in chosen)


def mission_of_doors(
    plan: FloorPlan,
    layout: Layout,
    doors: Sequence[Door],
    places: Sequence[tuple[float, float, float]],
    *,
    closed: float = 0.5,
    toggles: float = 0.0,
    starts: NDArray[np.integer] | None = None,
    config: TraceConfig | None = None,
    antenna: Antenna,
    threads: int | None = None,
    progress: Progress | None = None,
    path: Path | None = None,
) -> Mission:
    """Mission whose doors open and close independently, with a place drawn for each episode.

    With P places, mode ``k`` has door ``i`` closed if bit ``i`` of ``k // P`` is set, and the
    transmitter at place ``k % P``. A door is seen from the cells that have a step through it.

    Parameters
    ----------
    plan : FloorPlan
        In which the doors are open.
    layout : Layout
        Its cells, as of `Layout.of_plan` with the grid of radio maps.
    doors : sequence of Door
        Those that open and close, at most `MOST_DOORS`.
    places : sequence of (float, float, float)
        Places of the transmitter [m].
    closed : float
        Probability that a door is closed when an episode begins.
    toggles : float
        Probability that a door opens or closes, per second.
    starts : (n,) int, optional
        Cells that episodes begin in, by default all.
    config, threads, progress
        As for `rssnav.maps.make_map`.
    antenna : Antenna
        At both ends.
    path : Path, optional
        File that the maps are kept in; the number of the doors' state is added to its name.

    Raises
    ------
    ValueError
        For more than `MOST_DOORS` doors, and for one twice or that is no open door of the plan.
    """
    require(len(doors) <= MOST_DOORS, "doors", len(doors), f"at most {MOST_DOORS}")
    is_open = set(doors_of(plan)) - set(shut_doors(plan))
    proper = is_open.issuperset(doors) and len(set(doors)) == len(doors)
    require(proper, "doors", tuple(doors), f"different open doors of plan {plan.name!r}")
    states = [_subset(doors, state) for state in range(2 ** len(doors))]
    fields = [
        fields_of_places(
            with_changed(plan, shut),
            layout,
            places,
            config=config,
            antenna=antenna,
            threads=threads,
            progress=progress,
            path=None if path is None else path.with_stem(f"{path.stem}-doors{state}"),
        )
        for state, shut in enumerate(states)
    ]
    alone = [_blocked(plan, layout, (door,)) for door in doors]
    mission = mission_of_fields(
        plan,
        tuple(_without(layout, _blocked(plan, layout, shut)) for shut in states),
        np.concatenate(fields),
        tuple(places) * len(states),
        ModeProcess.switching(len(doors), closed, toggles).times(ModeProcess.steady(len(places))),
        np.arange(layout.n_states) if starts is None else starts,
    )
    if not doors:
        return mission
    bits = np.arange(len(states))[:, None] >> np.arange(len(doors)) & 1
    return replace(
        mission,
        closed=np.repeat(bits.astype(np.bool_), len(places), axis=0),
        sees=np.stack([steps.any(axis=1) for steps in alone], axis=1),
    )


def _subset(doors: Sequence[Door], state: int) -> tuple[Door, ...]:
    """Doors whose bit is set."""
    return tuple(door for i, door in enumerate(doors) if state >> i & 1)


def _blocked(plan: FloorPlan, layout: Layout, shut: Sequence[Door]) -> NDArray[np.bool_]:
    """Steps (S, 8) of a layout that shut doors block."""
    grid = Grid.over(plan.bounds, CELL_SIZE_M, HEIGHT_M)
    whole = Layout.of_plan(with_changed(plan, shut), grid, layout.speed)
    number = {tuple(cell): k for k, cell in enumerate(whole.cell.tolist())}
    own = np.array([number[tuple(cell)] for cell in layout.cell.tolist()], dtype=np.int64)
    return layout.action_mask & (whole.part(own).next_state < 0)


def _without(layout: Layout, blocked: NDArray[np.bool_]) -> Layout:
    """Return the layout without some steps (S, 8)."""
    return replace(layout, next_state=np.where(blocked, -1, layout.next_state).astype(np.int32))


def _steps_to(layout: Layout, goals: NDArray[np.int64]) -> float:
    """Fewest steps from each cell to each goal, summed up; infinite if there is no way."""
    size = layout.n_states
    state, action = np.nonzero(layout.action_mask)
    arrived = layout.next_state[state, action]
    back = coo_array((np.ones(state.size), (arrived, state)), shape=(size, size)).tocsr()
    return float(dijkstra(back, indices=goals, unweighted=True).sum())
