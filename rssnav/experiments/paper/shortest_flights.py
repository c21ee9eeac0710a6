"""Random shortest flights: the reference for trajectories.

On a grid very many flights are equally short, and a single one may happen to follow a wall. The
reference is therefore an average over shortest flights drawn with equal probability.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra

from rssnav.world import GridWorld

_SAME_M = 1e-6
_SEED = 0


def shortest_flights(
    world: GridWorld, terminal: NDArray[np.bool_], count: int
) -> list[NDArray[np.int64]]:
    """Draw shortest flights in metres from the start to a terminal state.

    Parameters
    ----------
    world : GridWorld
        World with the possible steps and their lengths.
    terminal : (S,) bool
        States that a flight may end in.
    count : int
        Number of flights to draw.

    Returns
    -------
    list of (n + 1,) int64
        States of each flight.
    """
    state, action = np.nonzero(world.action_mask)
    following = world.next_state[state, action]
    length_m = world.step_length_m[action]
    moves = csr_array((length_m, (state, following)), shape=(world.n_states,) * 2)
    distance_m = np.asarray(dijkstra(moves, indices=world.start_state))
    shortest = np.abs(distance_m[state] + length_m - distance_m[following]) < _SAME_M
    before = _lists(following[shortest], state[shortest], world.n_states)
    n_flights = _count_flights(before, distance_m, world.start_state)
    goals = np.flatnonzero(terminal)
    goals = goals[distance_m[goals] < distance_m[goals].min() + _SAME_M]
    rng = np.random.default_rng(_SEED)
    return [_draw(rng, before, n_flights, goals, world.start_state) for _ in range(count)]


def _lists(
    keys: NDArray[np.int32] | NDArray[np.int64], values: NDArray[np.int64], size: int
) -> list[NDArray[np.int64]]:
    """Values of each key 0..size-1."""
    order = np.argsort(keys, kind="stable")
    ends = np.cumsum(np.bincount(keys, minlength=size))
    return np.split(values[order], ends[:-1])


def _count_flights(
    before: list[NDArray[np.int64]], distance_m: NDArray[np.float64], start: int
) -> NDArray[np.float64]:
    """Number of shortest flights from the start to each state."""
    n_flights = np.zeros(distance_m.size)
    n_flights[start] = 1.0
    for state in np.argsort(distance_m, kind="stable"):
        if state != start and np.isfinite(distance_m[state]):
            n_flights[state] = n_flights[before[state]].sum()
    return n_flights


def _draw(
    rng: np.random.Generator,
    before: list[NDArray[np.int64]],
    n_flights: NDArray[np.float64],
    goals: NDArray[np.int64],
    start: int,
) -> NDArray[np.int64]:
    """Draw one flight backwards, each state in proportion to the flights that lead there."""
    states = [_pick(rng, goals, n_flights)]
    while states[-1] != start:
        states.append(_pick(rng, before[states[-1]], n_flights))
    return np.array(states[::-1], dtype=np.int64)


def _pick(
    rng: np.random.Generator, states: NDArray[np.int64], n_flights: NDArray[np.float64]
) -> int:
    """Draw a state in proportion to the number of shortest flights that lead there."""
    cumulative = np.cumsum(n_flights[states])
    return int(states[np.searchsorted(cumulative, rng.random() * cumulative[-1], side="right")])
