"""One loop for Q-learning, SARSA and Double Q-learning, with one row of Q per state.

The three differ in the value of the state arrived at: the maximum of its row (Q-learning), the
value of the action taken there next (SARSA; Sutton and Barto, Reinforcement Learning, 2nd ed.,
section 6.4), or one table's value of the action that is best in the other (Double Q-learning; van
Hasselt 2010). With the first it equals :mod:`rssnav.kernels.q_learning` bit for bit, but is slower.

Double Q-learning stores its two tables one after the other in ``run.q`` and acts by their sum.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rssnav.kernels.common import (
    EPISODE,
    HASH_START,
    Moves,
    Parameters,
    Run,
    close_episode,
    decayed,
    extended_hash,
)
from rssnav.kernels.compiling import jit
from rssnav.kernels.xoshiro import draw, index_from_low_bits, unit_from_high_bits

Q_LEARNING, SARSA, DOUBLE_Q = range(3)


@jit(inline=True)
def _score(q: NDArray[np.float64], entry: int, rule: int) -> float:
    """Value by which the policy ranks an action."""
    return q[entry] + q[entry + q.size // 2] if rule == DOUBLE_Q else q[entry]


@jit(inline=True)
def _greedy(q: NDArray[np.float64], row: int, rule: int, ties: NDArray[np.uint64] | None) -> int:
    """First of the best actions or, with a generator for ties, any; it may be blocked."""
    best, attain, first = -np.inf, np.uint64(0), 0
    for a in range(8):
        value = _score(q, row + a, rule)
        attain = np.uint64(1) if value > best else attain + np.uint64(value == best)
        first = a if value > best else first
        best = max(best, value)
    if ties is None:
        return first
    skip = index_from_low_bits(draw(ties), attain)
    for a in range(8):
        if _score(q, row + a, rule) == best:
            if skip == 0:
                return a
            skip -= np.uint64(1)
    return first


@jit(inline=True)
def _choose(
    moves: Moves,
    run: Run,
    state: int,
    epsilon: float,
    rule: int,
    ties: NDArray[np.uint64] | None,
) -> int:
    """Epsilon-greedy choice among the possible actions of a state."""
    action = _greedy(run.q, 8 * state, rule, ties)
    bits = draw(run.generator)
    if unit_from_high_bits(bits) < epsilon or moves.next_state[8 * state + action] < 0:
        pick = index_from_low_bits(bits, np.uint64(moves.n_possible[state]))
        action = int(moves.possible[8 * state + int(pick)])
    return action


@jit(inline=True)
def _first_best(q: NDArray[np.float64], row: int) -> int:
    """First of the eight entries from ``row`` on with the largest value."""
    best = row
    for entry in range(row + 1, row + 8):
        best = entry if q[entry] > q[best] else best
    return best


@jit()
def _fly_episode(
    moves: Moves,
    reward: NDArray[np.float64],
    parameters: Parameters,
    run: Run,
    rule: int,
    ties: NDArray[np.uint64] | None,
    trace: NDArray[np.int32] | None,
) -> tuple[int, int, np.uint64, bool]:
    """Fly and learn from the start to the goal or to ``max_steps``.

    Returns (steps, diagonal steps, path hash, terminated).
    """
    q, rates = run.q, run.rates
    half = q.size // 2
    state, steps, diagonal, terminated, following = moves.start, 0, 0, False, 0
    path_hash = HASH_START
    run.visits[state] += 1
    while not terminated and steps < parameters.max_steps:
        rates[0] = decayed(rates[0], parameters.epsilon_min, parameters.step_decay)
        rates[1] = decayed(rates[1], parameters.alpha_min, parameters.step_decay)
        action = following
        if rule != SARSA or steps == 0:
            action = _choose(moves, run, state, rates[0], rule, ties)
        entry = 8 * state + action
        arrived = int(moves.next_state[entry])
        terminated = moves.terminal[arrived]
        learning, other = 0, 0  # offsets of the table that learns and of the one that evaluates
        if rule == DOUBLE_Q:
            learning = half * int(draw(run.generator) >> np.uint64(63))
            other = half - learning
        value = 0.0
        if not terminated and rule == SARSA:
            following = _choose(moves, run, arrived, rates[0], rule, ties)
            value = q[8 * arrived + following]
        elif not terminated:
            value = q[_first_best(q, learning + 8 * arrived) - learning + other]
        target = reward[entry] + parameters.gamma * value
        q[learning + entry] = (1.0 - rates[1]) * q[learning + entry] + rates[1] * target
        path_hash = extended_hash(path_hash, np.uint64(action))
        diagonal += action & 1
        if trace is not None:
            trace[steps] = arrived
        steps += 1
        run.visits[arrived] += 1
        state = arrived
    return steps, diagonal, path_hash, terminated


@jit()
def learn(
    moves: Moves,
    reward: NDArray[np.float64],
    parameters: Parameters,
    run: Run,
    rule: int,
    ties: NDArray[np.uint64] | None,
    until_episode: int,
    trace: NDArray[np.int32] | None = None,
) -> None:
    """Continue learning up to ``until_episode``, or to the episode in which the run converges.

    ``trace`` (max_steps,) receives the states that an episode arrives at; each episode overwrites
    the one before.
    """
    rates, converged = run.rates, False
    while run.counters[EPISODE] < until_episode and not converged:
        rates[0] = decayed(rates[0], parameters.epsilon_min, parameters.episode_decay)
        rates[1] = decayed(rates[1], parameters.alpha_min, parameters.episode_decay)
        steps, diagonal, path_hash, terminated = _fly_episode(
            moves, reward, parameters, run, rule, ties, trace
        )
        converged = close_episode(
            run.counters, run.episodes, steps, diagonal, path_hash, terminated
        )
