"""Algorithm 1 and its relatives: the one loop in which agents fly and learn.

Numba compiles it for each combination of arguments that are None, so that none holds the code of
another:

``sensor``
    None where states, rewards and terminal states are tables; else rows of Q and rewards come from
    readings, and the world may change.
``greedy``
    Maximum of each row of Q and the first action that attains it, kept beside the table and updated
    when a step changes the row, which seldom needs a scan. The row of the state arrived at is never
    the row updated (a step always leaves its cell), so this is exactly Algorithm 1. For Q-learning
    without a sensor: the paper's twelve configurations.
``ties``
    Generator that breaks ties at random; with None the first greedy action is taken.
``trace``
    Receives the states that an episode arrives at, one a second.

The rules differ in the value of the state arrived at: the maximum of its row (Q-learning), the
value of the action taken there next (SARSA; Sutton and Barto, Reinforcement Learning, 2nd ed.,
section 6.4), or one table's value of the action that is best in the other (Double Q-learning; van
Hasselt 2010). Double Q-learning stores its two tables one after the other in ``run.q`` and acts by
their sum.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rssnav.kernels.common import (
    EPISODE,
    HASH_START,
    Index,
    Parameters,
    Run,
    close_episode,
    decayed,
    extended_hash,
)
from rssnav.kernels.compiling import jit
from rssnav.kernels.reading_states import row_of
from rssnav.kernels.stepping import (
    CELL,
    FOUND,
    RUNNING,
    SECONDS,
    Flight,
    Moves,
    Sensor,
    begin,
    drawn,
    first_entry,
    fly,
)
from rssnav.kernels.xoshiro import draw, index_from_low_bits, next_uint64, unit_from_high_bits

Q_LEARNING, SARSA, DOUBLE_Q = range(3)
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


@jit(inline=True)
def _score(q: NDArray[np.float64], entry: Index, second: Index) -> float:
    """Value by which the policy ranks an action; ``second`` is the offset of a second table."""
    return q[entry] + q[entry + second] if second > 0 else q[entry]


@jit()
def _best_of(
    moves: Moves,
    parameters: Parameters,
    q: NDArray[np.float64],
    row: Index,
    entry: Index,
    second: Index,
    ties: NDArray[np.uint64] | None,
) -> Index:
    """Best of the actions that count in a state, of several the first, or any with ``ties``.

    ``entry`` is the state's first entry in the table of steps. The choice may be blocked when the
    maximum runs over all actions.
    """
    best, attain, first = -np.inf, np.uint64(0), np.uint64(0)
    for a in range(_8):
        if parameters.all_actions or moves.next_state[entry + a] >= 0:
            value = _score(q, row + a, second)
            attain = _1 if value > best else attain + np.uint64(value == best)
            first = a if value > best else first
            best = max(best, value)
    if ties is None:
        return first
    skip = index_from_low_bits(draw(ties), attain)
    for a in range(_8):
        counts = parameters.all_actions or moves.next_state[entry + a] >= 0
        if counts and _score(q, row + a, second) == best:
            if skip == 0:
                return a
            skip -= _1
    return first


@jit(inline=True)
def _explored(
    moves: Moves, entry: Index, choice: Index, bits: np.uint64, epsilon: float
) -> tuple[Index, int]:
    """Replace a greedy choice with probability epsilon, or if it is blocked, by any possible.

    Returns the action and the state it leads to.
    """
    arrived = moves.next_state[entry + choice]
    if arrived < 0 or unit_from_high_bits(bits) < epsilon:
        pick = index_from_low_bits(bits, np.uint64(moves.n_possible[entry // _8]))
        choice = np.uint64(moves.possible[entry + pick])
        arrived = moves.next_state[entry + choice]
    return choice, arrived


@jit(inline=True)
def _start(moves: Moves, sensor: Sensor | None, run: Run) -> tuple[Index, Index, Index]:
    """State in which an episode begins, its row of Q, and its first entry in the table of steps."""
    if sensor is None:
        state = np.uint64(moves.starts[drawn(moves.start_cumulative, run.generator)])
        return state, state * _8, state * _8
    flight = Flight(run.whole, run.real, run.generator)
    begin(moves, sensor, flight)
    row = np.uint64(8 * row_of(sensor, flight))
    return np.uint64(run.whole[CELL]), row, np.uint64(first_entry(sensor, flight))


@jit(inline=True)
def _step(
    moves: Moves,
    sensor: Sensor | None,
    parameters: Parameters,
    run: Run,
    entry: Index,
    action: Index,
    arrived: int,
    steps: int,
) -> tuple[float, bool, bool, int, Index, Index]:
    """Fly: (reward, terminated, over, steps flown, row and entry of the state arrived at)."""
    if sensor is None:
        terminated, row = moves.terminal[np.uint64(arrived)], np.uint64(arrived) * _8
        over = terminated or steps + 1 >= parameters.max_steps
        return moves.reward[entry + action], terminated, over, steps + 1, row, row
    flight = Flight(run.whole, run.real, run.generator)
    reward, status = fly(sensor, flight, int(action), int(arrived))
    row = np.uint64(8 * row_of(sensor, flight))
    next_entry = np.uint64(first_entry(sensor, flight))
    return reward, status == FOUND, status != RUNNING, int(run.whole[SECONDS]), row, next_entry


@jit(fused=True)
def _bootstrap(
    moves: Moves,
    parameters: Parameters,
    run: Run,
    there: tuple[Index, Index],
    epsilon: float,
    ties: NDArray[np.uint64] | None,
    terminated: bool,
) -> tuple[float, Index, Index]:
    """Value of the state arrived at, of which ``there`` is the row and the entry of the steps.

    Returns also the action that SARSA takes there next, and the offset of the table that learns.
    """
    q, rule, zero = run.q, parameters.rule, np.uint64(0)
    learning, other, following, value = zero, zero, zero, 0.0
    row, entry = there
    second = np.uint64(q.size // 2) if rule == DOUBLE_Q else zero
    if rule == DOUBLE_Q:
        learning = second * (draw(run.generator) >> np.uint64(63))
        other = second - learning
    if not terminated and rule == SARSA:
        following = _best_of(moves, parameters, q, row, entry, zero, ties)
        following, _ = _explored(moves, entry, following, draw(run.generator), epsilon)
        value = q[row + following]
    elif not terminated:
        best = _best_of(moves, parameters, q, row + learning, entry, zero, None)
        value = q[row + other + best]
    return value, following, learning


@jit()
def learn(
    moves: Moves,
    sensor: Sensor | None,
    parameters: Parameters,
    run: Run,
    greedy: Greedy | None,
    ties: NDArray[np.uint64] | None,
    until_episode: int,
    trace: NDArray[np.int32] | None = None,
) -> None:
    """Continue learning up to ``until_episode``, or to the episode in which the run converges."""
    q, visits, generator, gamma = run.q, run.visits, run.generator, parameters.gamma
    second = np.uint64(q.size // 2 if parameters.rule == DOUBLE_Q else 0)
    epsilon, alpha, converged = run.rates[0], run.rates[1], False
    while run.counters[EPISODE] < until_episode and not converged:
        epsilon = decayed(epsilon, parameters.epsilon_min, parameters.episode_decay)
        alpha = decayed(alpha, parameters.alpha_min, parameters.episode_decay)
        path_hash, diagonal, steps, following = HASH_START, np.uint64(0), 0, np.uint64(0)
        state, row, entry = _start(moves, sensor, run)
        visits[state] += 1
        s0, s1, s2, s3 = generator[0], generator[1], generator[2], generator[3]
        terminated, over = False, False
        while not over:
            epsilon = decayed(epsilon, parameters.epsilon_min, parameters.step_decay)
            alpha = decayed(alpha, parameters.alpha_min, parameters.step_decay)
            if greedy is not None:
                action = np.uint64(greedy.action[state])
                if ties is not None:
                    action = _random_best(q, row, greedy.value[state], ties)
                bits, s0, s1, s2, s3 = next_uint64(s0, s1, s2, s3)
                action, arrived = _explored(moves, entry, action, bits, epsilon)
            else:
                if parameters.rule != SARSA or steps == 0:
                    best = _best_of(moves, parameters, q, row, entry, second, ties)
                    following, _ = _explored(moves, entry, best, draw(generator), epsilon)
                action, arrived = following, moves.next_state[entry + following]
            there, before = np.uint64(arrived), steps
            reward, terminated, over, steps, next_row, next_entry = _step(
                moves, sensor, parameters, run, entry, action, arrived, steps
            )
            if greedy is not None:
                target = reward + gamma * greedy.value[there]  # 0 beyond a terminal
                q[row + action] = (1.0 - alpha) * q[row + action] + alpha * target
                greedy.value[state], greedy.action[state] = _updated_best(
                    q, row, action, greedy.value[state], np.uint64(greedy.action[state])
                )
            else:
                value, following, learning = _bootstrap(
                    moves, parameters, run, (next_row, next_entry), epsilon, ties, terminated
                )
                target, learns = reward + gamma * value, row + action + learning
                q[learns] = (1.0 - alpha) * q[learns] + alpha * target
            path_hash = extended_hash(path_hash, action)
            diagonal += action & _1
            if trace is not None:
                trace[before:steps] = arrived
            visits[there] += 1
            state, row, entry = there, next_row, next_entry
        if greedy is not None:
            generator[0], generator[1], generator[2], generator[3] = s0, s1, s2, s3
        converged = close_episode(
            run.counters, run.episodes, steps, int(diagonal), path_hash, terminated
        )
    run.rates[0], run.rates[1] = epsilon, alpha
