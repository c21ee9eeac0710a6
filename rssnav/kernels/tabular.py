"""Q-learning with one Q row per cell: the loop the paper's twelve configurations run in.

The greedy action and the maximum of every row are kept beside the table and renewed when a step
changes the row. Where to fly next then hangs on two loads, not on a scan of the row, and the scan
of the row just left overlaps with the following steps. The row of the state arrived at is never the row
updated (a step always leaves its cell), so this is Algorithm 1 to the letter.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from rssnav.kernels.common import (
    EPISODE,
    HASH_START,
    decay_before_episode,
    extended_hash,
    record_episode,
)
from rssnav.kernels.xoshiro import index_from_low_bits, next_uint64, unit_from_high_bits

_8 = np.uint64(8)
_1 = np.uint64(1)


class Greedy(NamedTuple):
    """Maximum of each row of Q, and the first action that attains it."""

    value: NDArray[np.float64]  # (S,)
    action: NDArray[np.int8]  # (S,) -1 where that action is blocked


@njit(inline="always")
def first_best(q, row):
    """Largest of the eight values from ``row`` on, and the first action that attains it."""
    best, action = q[row], np.uint64(0)
    for a in range(_1, _8):
        value = q[row + a]
        better = value > best
        best = value if better else best
        action = a if better else action
    return best, action


@njit(cache=True, nogil=True)
def renew_greedy(q, next_state, greedy):
    """Fill ``greedy`` from the whole table."""
    for state in range(greedy.value.size):
        row = np.uint64(8 * state)
        best, action = first_best(q, row)
        greedy.value[state] = best
        greedy.action[state] = action if next_state[row + action] >= 0 else -1


@njit(cache=True, nogil=True)
def _random_best(q, next_state, row, best, bits):
    """Uniform choice among the actions of a row that attain ``best``; -1 when it is blocked."""
    ties = np.uint64(0)
    for a in range(_8):
        ties += np.uint64(q[row + a] == best)
    wanted = index_from_low_bits(bits, ties)
    for a in range(_8):
        if q[row + a] == best:
            if wanted == 0:
                return np.int64(a) if next_state[row + a] >= 0 else -1
            wanted -= _1
    return -1


@njit(cache=True, nogil=True)
def _fly_episode(moves, reward, parameters, run, greedy):
    """Fly and learn from the start to the goal or the cap.

    Returns (steps, diagonal steps, path hash, terminated).
    """
    next_state, possible, n_possible = moves.next_state, moves.possible, moves.n_possible
    terminal, q, visits = moves.terminal, run.q, run.visits
    best_value, best_action = greedy.value, greedy.action
    decay, gamma, max_steps = parameters.step_decay, parameters.gamma, parameters.max_steps
    epsilon, alpha = run.rates[0], run.rates[1]
    s0, s1, s2, s3 = run.generator[0], run.generator[1], run.generator[2], run.generator[3]
    path_hash, diagonal, steps, terminated = HASH_START, np.uint64(0), 0, False
    state = np.uint64(moves.start)
    visits[state] += 1
    while not terminated and steps < max_steps:
        if epsilon >= parameters.epsilon_min:
            epsilon *= decay
        if alpha >= parameters.alpha_min:
            alpha *= decay
        row = state * _8
        choice = np.int64(best_action[state])
        if parameters.random_ties:
            bits, s0, s1, s2, s3 = next_uint64(s0, s1, s2, s3)
            choice = _random_best(q, next_state, row, best_value[state], bits)
        bits, s0, s1, s2, s3 = next_uint64(s0, s1, s2, s3)
        any_possible = possible[row + index_from_low_bits(bits, np.uint64(n_possible[state]))]
        explore = (unit_from_high_bits(bits) < epsilon) | (choice < 0)
        action = np.uint64(np.int64(any_possible) if explore else choice)
        arrived = np.uint64(next_state[row + action])
        terminated = terminal[arrived]
        target = reward[row + action] + gamma * best_value[arrived]
        q[row + action] = (1.0 - alpha) * q[row + action] + alpha * target
        best, first = first_best(q, row)
        best_value[state] = best
        best_action[state] = np.int64(first) if next_state[row + first] >= 0 else -1
        path_hash = extended_hash(path_hash, action)
        diagonal += action & _1
        steps += 1
        visits[arrived] += 1
        state = arrived
    run.rates[0], run.rates[1] = epsilon, alpha
    run.generator[0], run.generator[1], run.generator[2], run.generator[3] = s0, s1, s2, s3
    return steps, np.int64(diagonal), path_hash, terminated


@njit(cache=True, nogil=True)
def learn(moves, reward, parameters, run, log, greedy, until_episode):
    """Go on learning to ``until_episode``, or to the episode in which the run converges."""
    while run.counters[EPISODE] < until_episode:
        decay_before_episode(parameters, run.rates)
        steps, diagonal, path_hash, terminated = _fly_episode(
            moves, reward, parameters, run, greedy
        )
        if record_episode(run, log, steps, diagonal, path_hash, terminated):
            return
