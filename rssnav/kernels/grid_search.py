"""What searchers compute each second: shortest ways over what they know, and beliefs.

Cells here are those of the whole grid, row after row. Beliefs are kept as logarithms of weights
until they are used, so that many readings do not underflow.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from rssnav.kernels.compiling import jit

_LEAST = -1e300


@jit()
def explore(
    neighbour: NDArray[np.int32],
    possible: NDArray[np.bool_],
    here: int,
    hops: NDArray[np.int32],
    first: NDArray[np.int8],
    queue: NDArray[np.int32],
) -> None:
    """Fewest steps from a cell to every other, breadth first, and the first of these steps.

    Parameters
    ----------
    neighbour : (C, 8) int32
        Cell after each action; -1 off the grid.
    possible : (C, 8) bool
        Steps that are known or assumed to be possible.
    here : int
        Where they begin.
    hops, first, queue : (C,)
        Steps (-1 where there is no way), first action (-1), buffer.
    """
    hops[:], first[:] = -1, -1
    hops[here], queue[0] = 0, here
    head, tail = 0, 1
    while head < tail:
        cell = queue[head]
        head += 1
        for a in range(8):
            there = neighbour[cell, a]
            if there >= 0 and possible[cell, a] and hops[there] < 0:
                hops[there] = hops[cell] + 1
                first[there] = a if cell == here else first[cell]
                queue[tail] = there
                tail += 1


@jit()
def steps_to_found(
    next_state: NDArray[np.int32],
    found: NDArray[np.bool_],
    hops: NDArray[np.int32],
    queue: NDArray[np.int32],
    reached: NDArray[np.int32],
) -> None:
    """Fewest steps from each cell to where each hypothesis is found, breadth first.

    A step is possible if and only if the step back is.

    Parameters
    ----------
    next_state : (S, 8) int32
        Cell after each action; -1 where it is impossible.
    found : (S, H) bool
        Where each hypothesis is found.
    hops : (S, H) int32
        Receives the steps; cells without a way keep what they have.
    queue, reached : (S,) int32
        Buffers.
    """
    n_cells, count = found.shape
    reached[:] = -1
    for h in range(count):
        head, tail = 0, 0
        for cell in range(n_cells):
            if found[cell, h]:
                hops[cell, h], queue[tail], reached[cell] = 0, cell, h
                tail += 1
        while head < tail:
            cell = queue[head]
            head += 1
            for a in range(8):
                there = next_state[cell, a]
                if there >= 0 and reached[there] != h:
                    hops[there, h], queue[tail], reached[there] = hops[cell, h] + 1, there, h
                    tail += 1


@jit(inline=True)
def log_likelihood(
    reading_dbm: float, expected_dbm: float, sigma_db: float, sensitivity_dbm: float
) -> float:
    """Logarithm of a normal density, or where there is no signal of the probability below it."""
    misfit = (reading_dbm - expected_dbm) / sigma_db
    if reading_dbm > sensitivity_dbm:
        return -0.5 * misfit * misfit
    return math.log(max(0.5 * math.erfc(-math.sqrt(0.5) * misfit), 1e-300))


@jit()
def weigh_by_distance(
    log_weight: NDArray[np.float64],
    drop_db: NDArray[np.float64],
    here: tuple[int, int],
    n_x: int,
    model: tuple[float, float, float, float],
    reading_dbm: float,
) -> None:
    """Weigh hypotheses (transmitter's cell, path-loss exponent) by a reading.

    Parameters
    ----------
    log_weight : (C, E) float64
        Updated.
    drop_db : (n_y, n_x, E) float64
        Path loss after so many cells along y and x beyond that at 1 m [dB].
    here : (int, int)
        Row and column of the reading.
    n_x : int
        Columns of the grid.
    model : (float, float, float, float)
        Level at 1 m [dBm], standard deviation [dB], weight of a reading, sensitivity [dBm].
    reading_dbm : float
        Reading [dBm].
    """
    level_dbm, sigma_db, temper, sensitivity_dbm = model
    for cell in range(log_weight.shape[0]):
        rows, columns = abs(cell // n_x - here[0]), abs(cell % n_x - here[1])
        for e in range(log_weight.shape[1]):
            expected_dbm = level_dbm - drop_db[rows, columns, e]
            log_weight[cell, e] += temper * log_likelihood(
                reading_dbm, expected_dbm, sigma_db, sensitivity_dbm
            )


@jit()
def marginal(
    log_weight: NDArray[np.float64], alive: NDArray[np.bool_], weight: NDArray[np.float64]
) -> bool:
    """Probability (C,) of each cell that is not excluded; False where all are."""
    highest, total = _LEAST, 0.0
    for cell in range(alive.size):
        if alive[cell]:
            for value in log_weight[cell]:
                highest = max(highest, value)
    for cell in range(alive.size):
        weight[cell] = 0.0
        if alive[cell]:
            for value in log_weight[cell]:
                weight[cell] += math.exp(value - highest)
        total += weight[cell]
    if total <= 0.0:
        return False
    for cell in range(alive.size):
        weight[cell] /= total
    return True


@jit()
def expected_cost(
    belief: NDArray[np.float64],
    expected_dbm: NDArray[np.float64],
    found: NDArray[np.bool_],
    hops: NDArray[np.int32],
    levels_dbm: NDArray[np.float64],
    sigma_db: float,
    space_aware: bool,
) -> float:
    """Cost of the belief after a step to a cell, expected over whether and what is read there.

    The cost is the entropy (Vergassola et al. 2007), or log2(D + 2^(H - 1) - 1/2) with the mean
    number of steps D that are left and the entropy H in bits (Loisy and Eloy 2022, as in their
    program OTTO, with steps around walls in place of the Manhattan distance).

    Parameters
    ----------
    belief : (H,) float64
        Probability of each hypothesis.
    expected_dbm : (H,) float64
        Its RSS in the cell [dBm].
    found : (H,) bool
        Whether it would be found there, which costs nothing.
    hops : (H,) int32
        Steps from there to where it would be found.
    levels_dbm : (B,) float64
        Levels that stand for all readings, evenly spaced [dBm].
    sigma_db : float
        Standard deviation of readings about the expected RSS [dB].
    space_aware : bool
        Which cost.
    """
    cost, step_db = 0.0, levels_dbm[1] - levels_dbm[0]
    for level_dbm in levels_dbm:
        total, sum_log, distance = 0.0, 0.0, 0.0
        for h in range(belief.size):
            if found[h] or belief[h] == 0.0:
                continue
            misfit = (level_dbm - expected_dbm[h]) / sigma_db
            if abs(misfit) > 4.0:
                continue
            joint = belief[h] * math.exp(-0.5 * misfit * misfit)
            joint *= step_db / (sigma_db * math.sqrt(2.0 * math.pi))
            if joint > 0.0:
                total += joint
                sum_log += joint * math.log2(joint)
                distance += joint * hops[h]
        if total > 0.0:
            entropy = max(math.log2(total) - sum_log / total, 0.0)
            if space_aware:
                entropy = math.log2(distance / total + 2.0 ** (entropy - 1.0) - 0.5)
            cost += total * entropy
    return cost
