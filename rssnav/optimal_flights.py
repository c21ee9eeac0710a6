"""Optimal flights, the oracles that learning is compared with: shortest paths, value iteration.

Shortest paths come from Dijkstra's algorithm over the graph of moves, counting steps or metres;
value iteration solves the decision process that an agent learns in, so its policy is the one that
Q-learning converges to.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra

from rssnav.arguments import require
from rssnav.decision_process import DecisionProcess
from rssnav.world import GridWorld


@dataclass(frozen=True, eq=False)
class Flight:
    """A flight from the start.

    Attributes
    ----------
    states : (n + 1,) int32
        States of the decision process visited, the start first.
    cells : (n + 1,) int32
        Cell of each of them: the row of the world's arrays.
    reached : bool
        Whether it ends in a terminal state.
    length_m : float
        Its length [m].
    """

    states: NDArray[np.int32]
    cells: NDArray[np.int32]
    reached: bool
    length_m: float

    @property
    def steps(self) -> int:
        """Number n of steps."""
        return self.states.size - 1


@dataclass(frozen=True, eq=False)
class Solution:
    """Optimal values and policy of a decision process.

    Attributes
    ----------
    q : (S, 8) float64
        Optimal action values; -inf where the action is impossible, 0 in terminal states.
    policy : (S,) int32
        First action that attains the maximum.
    sweeps : int
        Sweeps that value iteration took.
    """

    q: NDArray[np.float64]
    policy: NDArray[np.int32]
    sweeps: int

    def __repr__(self) -> str:
        """Number of states in one line."""
        return f"<Solution: action values of {len(self.q)} states>"


def path_length_m(world: GridWorld, cells: NDArray[np.int32]) -> float:
    """Length [m] of a flight through cells (n + 1,)."""
    steps = np.diff(world.position[cells], axis=0)
    return float(np.hypot(steps[:, 0], steps[:, 1]).sum())


def shortest_path(
    world: GridWorld, terminal: NDArray[np.bool_], cost: Literal["steps", "metres"] = "steps"
) -> Flight:
    """Shortest flight from the start to any terminal cell; its states are the cells.

    Parameters
    ----------
    world : GridWorld
        Gives the possible steps and their lengths.
    terminal : (S,) bool
        Where a flight may end.
    cost : {"steps", "metres"}
        What is minimised; for the agents a diagonal step costs as much as a straight one. Of the
        flights with the fewest steps the shortest is taken.

    Raises
    ------
    ValueError
        When no terminal cell can be reached.
    """
    state, action = np.nonzero(world.action_mask)
    length_m = world.step_length_m[action]
    # Fewer than n_states steps sum to less than 1/4 of a step: this only breaks ties.
    tie_break = length_m / (length_m.max(initial=0.0) * 4.0 * world.n_states)
    weight = length_m if cost == "metres" else 1.0 + tie_break
    graph = csr_array(
        (weight, (state, world.next_state[state, action])), shape=(world.n_states,) * 2
    )
    distance, previous = dijkstra(graph, indices=world.start_state, return_predecessors=True)
    goals = np.flatnonzero(terminal)
    if goals.size == 0 or not np.isfinite(distance[goals]).any():
        raise ValueError("no terminal state can be reached from the start")
    states = [int(goals[np.argmin(distance[goals])])]
    while states[-1] != world.start_state:
        states.append(int(previous[states[-1]]))
    path = np.array(states[::-1], dtype=np.int32)
    return Flight(path, path, True, path_length_m(world, path))


def value_iteration(
    process: DecisionProcess, gamma: float, *, tolerance: float = 1e-10
) -> Solution:
    """Solve Q(s, a) = r(s, a) + gamma max_a' Q(s', a') over the possible actions.

    Parameters
    ----------
    process : DecisionProcess
        Made by an agent from a world.
    gamma : float
        Discount factor, below 1.
    tolerance : float
        Sweeps stop when no value is farther than this from its optimum.

    Raises
    ------
    ValueError
        For a discount factor that is not from 0 to below 1.
    """
    expected = "a number in [0, 1), for value iteration to converge"
    require(0.0 <= gamma < 1.0, "gamma", gamma, expected)
    value = np.zeros(process.terminal.size)
    sweeps, change = 0, np.inf
    while change * gamma > tolerance * (1.0 - gamma):
        new = np.max(_backup(process, value, gamma), axis=1)
        new[process.terminal] = 0.0
        change = float(np.max(np.abs(new - value)))
        value, sweeps = new, sweeps + 1
    q = _backup(process, value, gamma)
    q[process.terminal] = np.where(process.action_mask[process.terminal], 0.0, -np.inf)
    return Solution(q, np.argmax(q, axis=1).astype(np.int32), sweeps)


def _backup(
    process: DecisionProcess, value: NDArray[np.float64], gamma: float
) -> NDArray[np.float64]:
    """One application of the Bellman operator, shape (S, 8)."""
    q = process.reward + gamma * value[process.next_state]
    return np.where(process.action_mask, q, -np.inf)


def greedy_path(world: GridWorld, process: DecisionProcess, q: NDArray[np.float64]) -> Flight:
    """Flight that takes the best action of each state until the goal or a state seen before.

    Parameters
    ----------
    world : GridWorld
        Gives the lengths.
    process : DecisionProcess
        Gives steps, start and goal.
    q : (S, 8) float64
        Action values, -inf where impossible; the first maximum is taken.
    """
    follows = process.next_state[np.arange(q.shape[0]), np.argmax(q, axis=1)].tolist()
    states, seen = [process.start], {process.start}
    while not process.terminal[states[-1]]:
        states.append(follows[states[-1]])
        if states[-1] in seen:
            break
        seen.add(states[-1])
    path = np.array(states, dtype=np.int32)
    cells = process.cell_of_state[path]
    return Flight(path, cells, bool(process.terminal[path[-1]]), path_length_m(world, cells))


def discounted_return(process: DecisionProcess, states: NDArray[np.int32], gamma: float) -> float:
    """Return sum_t gamma^t r_t of a flight through states (n + 1,)."""
    here, there = states[:-1], states[1:]
    action = np.argmax(process.next_state[here] == there[:, None], axis=1)
    return float(np.sum(gamma ** np.arange(here.size) * process.reward[here, action]))
