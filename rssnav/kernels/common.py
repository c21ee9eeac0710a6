"""What the learning loops share: their arguments, and the bookkeeping between episodes."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

HASH_START = np.uint64(0xCBF29CE484222325)
_HASH_FACTOR = np.uint64(0x9E3779B97F4A7C15)
_ONE = np.uint64(1)


class Moves(NamedTuple):
    """Steps of a world; ``A = 8`` actions a state, rows laid end to end."""

    next_state: NDArray[np.int32]  # (S * 8,) -1 where the step would crash
    possible: NDArray[np.uint8]  # (S * 8,) the possible actions of a state first, in action order
    n_possible: NDArray[np.uint8]  # (S,)
    terminal: NDArray[np.bool_]  # (S,)
    start: int


class Parameters(NamedTuple):
    """Scalars of Algorithm 1 and of its readings."""

    gamma: float
    epsilon_min: float
    alpha_min: float
    step_decay: float  # factor on epsilon and alpha before every step
    episode_decay: float  # and before every episode
    max_steps: int
    all_actions: bool  # the maximum runs over blocked actions too
    random_ties: bool  # among equally good actions pick at random, not the first


class Run(NamedTuple):
    """One realisation while it learns: everything a later call needs to go on."""

    q: NDArray[np.float64]  # (rows * 8,)
    visits: NDArray[np.int32]  # (S,)
    generator: NDArray[np.uint64]  # (4,)
    rates: NDArray[np.float64]  # (2,) epsilon, alpha
    counters: NDArray[np.int64]  # (N_COUNTERS,) see below
    path_hash: NDArray[np.uint64]  # (1,) of the previous episode


EPISODE, TOTAL_STEPS, SAME_PATHS, CONVERGED_EPISODE, CONVERGED_STEPS, N_ROWS = range(6)
N_COUNTERS = 6


class Log(NamedTuple):
    """What is kept of every episode, and the visit counts at chosen episodes."""

    steps: NDArray[np.int32]  # (episodes,)
    diagonal_steps: NDArray[np.int32]  # (episodes,)
    truncated: NDArray[np.bool_]  # (episodes,)
    snapshots: NDArray[np.int32]  # (snapshots, S)
    snapshot_episodes: NDArray[np.int64]  # (snapshots,)


@njit(inline="always")
def extended_hash(path_hash, action):
    """Hash of a path one action longer.

    Every extension is a bijection of the 64 bits, so paths that differ in one action never share
    a hash; others do with a probability of about 2^-64 (and must have the same length to count).
    """
    return (path_hash ^ (np.uint64(action) + _ONE)) * _HASH_FACTOR


@njit(inline="always")
def decay_before_episode(parameters, rates):
    """Decay epsilon and alpha once an episode (factor 1 when they decay every step)."""
    if rates[0] >= parameters.epsilon_min:
        rates[0] *= parameters.episode_decay
    if rates[1] >= parameters.alpha_min:
        rates[1] *= parameters.episode_decay


@njit(cache=True, nogil=True)
def record_episode(run, log, steps, diagonal, path_hash, terminated):
    """Log an episode, take a snapshot if one is due, apply the convergence rule.

    A run converges with the third episode in a row that reached the goal by the same actions.
    Returns whether it did so in this episode.
    """
    counters = run.counters
    episode = counters[EPISODE]
    log.steps[episode] = steps
    log.diagonal_steps[episode] = diagonal
    log.truncated[episode] = not terminated
    same = (
        terminated
        and episode > 0
        and not log.truncated[episode - 1]
        and log.steps[episode - 1] == steps
        and run.path_hash[0] == path_hash
    )
    counters[SAME_PATHS] = counters[SAME_PATHS] + 1 if same else 0
    run.path_hash[0] = path_hash
    counters[EPISODE] = episode + 1
    counters[TOTAL_STEPS] += steps
    for k in range(log.snapshot_episodes.size):
        if log.snapshot_episodes[k] == episode + 1:
            log.snapshots[k] = run.visits
    converged = counters[SAME_PATHS] >= 2 and counters[CONVERGED_EPISODE] < 0
    if converged:
        counters[CONVERGED_EPISODE] = episode + 1
        counters[CONVERGED_STEPS] = counters[TOTAL_STEPS]
    return converged
