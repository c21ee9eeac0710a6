"""What the learning loops share: their arguments, and the counters between episodes."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rssnav.kernels.compiling import jit

HASH_START = np.uint64(0xCBF29CE484222325)
_HASH_FACTOR = np.uint64(0x9E3779B97F4A7C15)
_1 = np.uint64(1)

Index = int | np.uint64
"""Unsigned in the fast loop, where numba then omits its check for negative indices."""


class Parameters(NamedTuple):
    """Scalars of Algorithm 1 and of its interpretation."""

    gamma: float
    epsilon_min: float
    alpha_min: float
    step_decay: float  # factor on epsilon and alpha before every step
    episode_decay: float  # and before every episode
    max_steps: int
    all_actions: bool  # the maximum runs over blocked actions too
    rule: int  # Q_LEARNING, SARSA or DOUBLE_Q


class Run(NamedTuple):
    """One realisation while it learns: all that a later call needs to continue."""

    q: NDArray[np.float64]  # (rows * 8,)
    visits: NDArray[np.int32]  # (S,)
    generator: NDArray[np.uint64]  # (4,) exploration and fluctuation
    tie_generator: NDArray[np.uint64]  # (4,) among equally good actions, where that is random
    rates: NDArray[np.float64]  # (2,) epsilon, alpha
    whole: NDArray[np.int64]  # (5,) the flight, where a sensor reads: see `stepping.Flight`
    real: NDArray[np.float64]  # (3,) likewise
    counters: NDArray[np.int64]  # (N_COUNTERS,) indexed by the names below
    episodes: NDArray[np.int32]  # (E, 3) of each episode: steps, diagonal steps, 1 if truncated


(
    EPISODE,
    TOTAL_STEPS,
    SAME_PATHS,
    PATH_HASH,
    CONVERGED_EPISODE,
    CONVERGED_STEPS,
) = range(6)
N_COUNTERS = 6
STEPS, DIAGONAL_STEPS, TRUNCATED = range(3)
_SAME_PATHS_TO_CONVERGE = 3


@jit(inline=True)
def extended_hash(path_hash: np.uint64, action: Index) -> np.uint64:
    """Hash of a path with one more action.

    Every extension is a bijection of the 64 bits, so paths that differ in one action never share
    a hash; others do with a probability of about 2^-64, and must be equally long to count.
    """
    return (path_hash ^ (np.uint64(action) + _1)) * _HASH_FACTOR


@jit(inline=True)
def decayed(rate: float, minimum: float, factor: float) -> float:
    """Epsilon or alpha after one decay (Algorithm 1: while not below its minimum)."""
    return rate * factor if rate >= minimum else rate


@jit(inline=True)
def close_episode(
    counters: NDArray[np.int64],
    episodes: NDArray[np.int32],
    steps: int,
    diagonal: int,
    path_hash: np.uint64,
    terminated: bool,
) -> bool:
    """Log an episode and apply the convergence rule; returns whether the run converged in it.

    A run converges with the third episode in a row that reached the goal by the same actions.
    """
    k = counters[EPISODE]
    same = (
        terminated
        and counters[SAME_PATHS] > 0
        and np.uint64(counters[PATH_HASH]) == path_hash
        and episodes[k - 1, STEPS] == steps
    )
    counters[SAME_PATHS] = counters[SAME_PATHS] + 1 if same else np.int64(terminated)
    counters[PATH_HASH] = np.int64(path_hash)
    episodes[k, STEPS] = steps
    episodes[k, DIAGONAL_STEPS] = diagonal
    episodes[k, TRUNCATED] = not terminated
    counters[EPISODE] = k + 1
    counters[TOTAL_STEPS] += steps
    if counters[SAME_PATHS] < _SAME_PATHS_TO_CONVERGE or counters[CONVERGED_EPISODE] >= 0:
        return False
    counters[CONVERGED_EPISODE] = k + 1
    counters[CONVERGED_STEPS] = counters[TOTAL_STEPS]
    return True
