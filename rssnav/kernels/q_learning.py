"""Q-learning with one row of Q per state: the loop of the paper's twelve configurations.

The maximum of every row and the first action that attains it are stored beside the table and
updated when a step changes the row, which seldom needs a scan. The row of the state arrived at is
never the row updated (a step always leaves its cell), so this is exactly Algorithm 1.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rssnav.kernels.common import (
    EPISODE,
    HASH_START,
    Index,
    Moves,
    Parameters,
    Run,
    close_episode,
    decayed,
    extended_hash,
)
from rssnav.kernels.compiling import jit
from rssnav.kernels.xoshiro import draw, index_from_low_bits, next_uint64, unit_from_high_bits

_8 = np.uint64(8)
_1 = np.uint64(1)


class Greedy(NamedTuple):
    """Maximum of each row of Q, and the first action that attains it."""

    value: NDArray[np.float64]  # (S,)
    action: NDArray[np.uint8]  # (S,)


@jit(inline=True)
def _first_best(q: NDArray[np.float64], row: Index) -> tuple[float, Index]:
    """Largest of the eight values from ``row`` on, and the first action that attains it."""
    best, action = q[row], np.uint64(0)
    for a in range(_1, _8):
        value = q[row + a]
        better = value > best
        best = value if better else best
        action = a if better else action
    return best, action


@jit(inline=True)
def _updated_best(
    q: NDArray[np.float64], row: Index, changed: Index, best: float, first: Index
) -> tuple[float, Index]:
    """Maximum of a row and its first action after the value of ``changed`` has changed."""
    value = q[row + changed]
    if changed == first and value < best:
        return _first_best(q, row)
    if value > best or (value == best and changed < first):
        return value, changed
    return best, first


@jit()
def fill_greedy(q: NDArray[np.float64], greedy: Greedy) -> None:
    """Find the greedy action of every row."""
    for state in range(greedy.value.size):
        greedy.value[state], greedy.action[state] = _first_best(q, np.uint64(8 * state))


@jit()
def _random_best(
    q: NDArray[np.float64], row: Index, best: float, generator: NDArray[np.uint64]
) -> Index:
    """Uniform choice among the actions of a row that attain ``best``."""
    ties = np.uint64(0)
    for a in range(_8):
        ties += np.uint64(q[row + a] == best)
    skip = index_from_low_bits(draw(generator), ties)
    for a in range(_8):
        if q[row + a] == best:
            if skip == 0:
                return a
            skip -= _1
    return np.uint64(0)


@jit()
def learn(
    moves: Moves,
    reward: NDArray[np.float64],
    parameters: Parameters,
    run: Run,
    greedy: Greedy,
    ties: NDArray[np.uint64] | None,
    until_episode: int,
    trace: NDArray[np.int32] | None = None,
) -> None:
    """Continue learning up to ``until_episode``, or to the episode in which the run converges.

    ``ties`` is the generator that breaks ties at random; with None the first greedy action is
    taken. ``trace`` (max_steps,) receives the states that an episode arrives at; each episode
    overwrites the one before. Numba compiles a loop for each combination of None and an array, so
    that none holds the code of another.
    """
    next_state, terminal, q, visits = moves.next_state, moves.terminal, run.q, run.visits
    possible, n_possible = moves.possible, moves.n_possible
    best_value, best_action = greedy.value, greedy.action
    counters, episodes, rates, generator = run.counters, run.episodes, run.rates, run.generator
    epsilon_min, alpha_min = parameters.epsilon_min, parameters.alpha_min
    decay, gamma, max_steps = parameters.step_decay, parameters.gamma, parameters.max_steps
    epsilon, alpha, episode_decay = rates[0], rates[1], parameters.episode_decay
    s0, s1, s2, s3 = generator[0], generator[1], generator[2], generator[3]
    converged = False
    while counters[EPISODE] < until_episode and not converged:
        epsilon = decayed(epsilon, epsilon_min, episode_decay)
        alpha = decayed(alpha, alpha_min, episode_decay)
        path_hash, diagonal, steps, terminated = HASH_START, np.uint64(0), 0, False
        state = np.uint64(moves.start)
        visits[state] += 1
        while not terminated and steps < max_steps:
            epsilon = decayed(epsilon, epsilon_min, decay)
            alpha = decayed(alpha, alpha_min, decay)
            row = state * _8
            action = np.uint64(best_action[state])
            if ties is not None:
                action = _random_best(q, row, best_value[state], ties)
            bits, s0, s1, s2, s3 = next_uint64(s0, s1, s2, s3)
            arrived = next_state[row + action]
            if arrived < 0 or unit_from_high_bits(bits) < epsilon:
                pick = index_from_low_bits(bits, np.uint64(n_possible[state]))
                action = np.uint64(possible[row + pick])
                arrived = next_state[row + action]
            there = np.uint64(arrived)
            terminated = terminal[there]
            target = reward[row + action] + gamma * best_value[there]  # 0 beyond a terminal
            q[row + action] = (1.0 - alpha) * q[row + action] + alpha * target
            best_value[state], best_action[state] = _updated_best(
                q, row, action, best_value[state], np.uint64(best_action[state])
            )
            path_hash = extended_hash(path_hash, action)
            diagonal += action & _1
            if trace is not None:
                trace[steps] = arrived
            steps += 1
            visits[there] += 1
            state = there
        converged = close_episode(counters, episodes, steps, int(diagonal), path_hash, terminated)
    rates[0], rates[1] = epsilon, alpha
    generator[0], generator[1], generator[2], generator[3] = s0, s1, s2, s3
