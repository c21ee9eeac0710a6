"""Learning by a model: explore, count, plan on what was counted.

Q-learning with a row per mode and cell learns little from a change of the mode: it is one sample
among hundreds, and a value must travel back step by step. Here the agent counts what it sees (where
each action leads, where the transmitter is found, how often one mode follows another) and plans on
the counts by value iteration (the limit of Dyna: Sutton and Barto, Reinforcement Learning, 2nd ed.,
chapter 8). The model assumes that modes change independently of the cell.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rssnav.arguments import require
from rssnav.kernels import fleet as kernel
from rssnav.kernels.stepping import CELL, FOUND, MODE, RUNNING
from rssnav.missions.mission import Mission
from rssnav.missions.observation import Observation
from rssnav.missions.planning import least_costs
from rssnav.missions.policy import GreedyTable
from rssnav.missions.tables import mission_moves, sensor_tables
from rssnav.missions.task import Task

_FLIGHTS = 256  # at the same time


def learn_by_model(
    mission: Mission, task: Task, *, steps: int, seed: int = 0
) -> tuple[GreedyTable, Observation]:
    """Explore at random, then plan the fewest steps on the counts.

    Parameters
    ----------
    mission : Mission
        World; only flown in. Exploration covers it best from many starts (`Mission.from_starts`).
    task : Task
        Aim.
    steps : int
        Seconds to explore, over all flights; about 30 for each mode, cell and action see nearly
        all of them.
    seed : int
        Same seed, same policy.

    Returns
    -------
    policy : GreedyTable
        What was never tried is never chosen, unless nothing was.
    observation : Observation
        What it sees: cell and mode. Where readings do not fluctuate and differ from place to place,
        they tell the mode.

    Raises
    ------
    ValueError
        For less than one step.
    """
    require(steps >= 1, "steps", steps, "at least 1")
    goal, found_steps, changes = _explore(mission, task, steps, seed)
    transition = (changes + np.eye(len(changes))) / (changes + np.eye(len(changes))).sum(1)[:, None]
    cost = np.ones((1, 8))
    _, q = least_costs(goal, found_steps, transition, cost, 1e-3, 10 * mission.n_states)
    table = np.where(np.isfinite(q), -q, -1e12).reshape(-1, 8)
    return GreedyTable(table, name="planning on counts"), Observation(None, cell=True, mode=True)


def _explore(
    mission: Mission, task: Task, steps: int, seed: int
) -> tuple[NDArray[np.bool_], NDArray[np.int32], NDArray[np.float64]]:
    """Fly at random: goals (M, S), steps (M, S, 8) with -1 where untried, changes (M, M)."""
    task.check(mission)
    observation = Observation(None, cell=True, mode=True)
    moves = mission_moves(mission)
    sensor = sensor_tables(mission, task, observation).of_one_run()
    random = np.random.default_rng(seed)
    fleet = kernel.Fleet.of_size(_FLIGHTS)
    fleet.generator[:] = random.integers(1, 2**63, fleet.generator.shape, np.uint64)
    kernel.begin_all(moves, sensor, fleet)
    m, s = mission.n_modes, mission.n_states
    goal = np.zeros((m, s), dtype=np.bool_)
    found_steps = np.full((m, s, 8), -1, dtype=np.int32)
    changes = np.zeros((m, m))
    for _ in range(-(-steps // _FLIGHTS)):
        mode, cell = fleet.whole[:, MODE].copy(), fleet.whole[:, CELL].copy()
        action = random.integers(0, 8, _FLIGHTS)
        kernel.step_running(moves, sensor, fleet, action)
        there = fleet.whole[:, CELL]
        moved = there != cell
        found_steps[mode[moved], cell[moved], action[moved]] = there[moved]
        np.add.at(changes, (mode, fleet.whole[:, MODE]), 1.0)
        found = fleet.status == FOUND
        goal[fleet.whole[found, MODE], there[found]] = True
        if (over := fleet.status != RUNNING).any():
            kernel.begin_some(moves, sensor, fleet, over)
    return goal, found_steps, changes
