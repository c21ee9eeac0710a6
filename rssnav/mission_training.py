"""Tabular learning in a mission: the loop of the paper's agents, in a world that may change."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from rssnav.arguments import require
from rssnav.kernels import common
from rssnav.learning_parameters import QLearning
from rssnav.learning_rules import N_ACTIONS, Learner
from rssnav.missions import GreedyTable, Mission, Observation, Task
from rssnav.missions.tables import mission_moves, sensor_tables

_CHUNK_EPISODES = 64  # between two reports of progress
_EXPLORATION = 0.5  # fraction of the steps after which epsilon is at its minimum


def mission_learner(
    mission: Mission,
    task: Task,
    observation: Observation,
    learning: QLearning,
    generators: NDArray[np.uint64],
    episodes: int,
) -> Learner:
    """Begin a realisation of learning in a mission (see `LearningProblem.learner`).

    Step limit and goal reward are the task's.

    Raises
    ------
    WorldError
        When the task cannot be done in the mission.
    ValueError
        When the maximum of Q runs over all actions, or the table would not fit into memory.
    """
    task.check(mission)
    require(
        learning.maximum_over == "possible", "maximum_over", learning.maximum_over, "'possible'"
    )
    tables = sensor_tables(mission, task, observation)
    both = 2 if learning.rule == "double_q" else 1
    q = np.full((both * tables.n_rows, N_ACTIONS), learning.initial_q)
    return Learner(mission_moves(mission), tables, learning, q, (generators, episodes))


def train_mission(
    mission: Mission,
    task: Task,
    observation: Observation,
    *,
    steps: int,
    seed: int = 0,
    learning: QLearning | None = None,
    epsilon: float = 0.0,
    progress: Callable[[int, int], None] | None = None,
) -> GreedyTable:
    """Learn a table of Q in a mission, and return the policy that flies by it.

    Parameters
    ----------
    mission, task, observation
        World, aim and senses.
    steps : int
        Seconds to fly in training; the last episodes may exceed them.
    seed : int
        Same seed, same table.
    learning : QLearning, optional
        Parameters of Algorithm 1. By default epsilon and alpha decay over the first half of the
        steps: the paper's eta suits some 2 000 states, and a process of more needs a smaller one.
    epsilon : float
        Probability of a random action when the policy flies.
    progress : callable, optional
        Called as ``progress(flown, steps)``.
    """
    require(steps >= 1, "steps", steps, "at least 1")
    if learning is None:
        learning = QLearning(eta=math.log(100.0) / (_EXPLORATION * steps))
    episodes = int(min(steps, 2**26))
    words = np.random.SeedSequence(seed, spawn_key=(0,)).generate_state(8, np.uint64)
    learner = mission_learner(
        mission, task, observation, learning, words.astype(np.uint64), episodes
    )
    counters = learner.run.counters
    while counters[common.TOTAL_STEPS] < steps and counters[common.EPISODE] < episodes:
        learner.advance(min(int(counters[common.EPISODE]) + _CHUNK_EPISODES, episodes))
        if progress is not None:
            progress(min(int(counters[common.TOTAL_STEPS]), steps), steps)
    return GreedyTable(learner.rows(), epsilon)
