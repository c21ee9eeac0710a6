"""A particle filter over the source's place and a log-distance path-loss model.

A particle says: the source is at (x, y), and at distance d it reads p - 10 n log10(d / 1 m). The
weights are those of bootstrap filtering (Gordon, Salmond and Smith 1993) with systematic
resampling; a share of fresh particles lets it recover from a wrong belief (augmented Monte Carlo
localisation: Thrun, Burgard and Fox, Probabilistic Robotics, section 8.3). The flight goes to the
place that a particle drawn by its weight says, along a way of fewest steps, and draws anew from
time to time (posterior sampling).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rssnav.kernels.common import Moves
from rssnav.kernels.compiling import jit
from rssnav.kernels.searching import Flight, Receiver, is_over, read, spend_second
from rssnav.kernels.xoshiro import draw, gaussian, unit_from_high_bits

X, Y, POWER, EXPONENT = range(4)


class Model(NamedTuple):
    """What the filter believes before any reading, and how it weighs readings."""

    low: NDArray[np.float64]  # (4,) particles are fresh between ``low`` and ``high``:
    high: NDArray[np.float64]  # (4,) x, y [m], power at 1 m [dBm], exponent
    jitter: NDArray[np.float64]  # (4,) standard deviations added when resampled
    sigma_db: float  # of readings about the model
    fresh_share: float  # of the particles, when resampled
    found_m: float  # a reading that does not find the source says it is not nearer than this
    steps_to_draw: int  # after which a place is drawn anew


class Belief(NamedTuple):
    """The particles of one flight."""

    particles: NDArray[np.float64]  # (N, 4)
    weights: NDArray[np.float64]  # (N,) their sum is 1
    resampled: NDArray[np.float64]  # (N, 4) room for the next particles


class Chart(NamedTuple):
    """What the filter knows of the plan: where its states are, and the steps to a place."""

    position: NDArray[np.float64]  # (S, 2) [m]
    hops: NDArray[np.int32]  # (S,) steps to the place it flies to
    queue: NDArray[np.int32]  # (S,) room for the search


@jit(inline="always")
def _unit(generator: NDArray[np.uint64]) -> float:
    return unit_from_high_bits(draw(generator))


@jit()
def _make_fresh(particle: NDArray[np.float64], model: Model, generator: NDArray[np.uint64]) -> None:
    for k in range(4):
        particle[k] = model.low[k] + (model.high[k] - model.low[k]) * _unit(generator)


@jit()
def _begin(belief: Belief, model: Model, generator: NDArray[np.uint64]) -> None:
    """Spread fresh particles, all of the same weight."""
    for particle in belief.particles:
        _make_fresh(particle, model, generator)
    belief.weights[:] = 1.0 / belief.weights.size


@jit()
def weigh(belief: Belief, model: Model, x: float, y: float, reading_dbm: float) -> bool:
    """Weigh the particles by a reading at (x, y) that did not find the source.

    Returns whether any particle can be true.
    """
    weights = belief.weights
    for k in range(weights.size):
        particle = belief.particles[k]
        distance_m = math.hypot(particle[X] - x, particle[Y] - y)
        if distance_m < model.found_m:
            weights[k] = 0.0
            continue
        expected_dbm = particle[POWER] - 10.0 * particle[EXPONENT] * math.log10(distance_m)
        misfit = (reading_dbm - expected_dbm) / model.sigma_db
        weights[k] *= math.exp(-0.5 * misfit * misfit)
    total = 0.0
    for weight in weights:
        total += weight
    if total <= 0.0:
        return False
    for k in range(weights.size):
        weights[k] /= total
    return True


@jit()
def _concentration(weights: NDArray[np.float64]) -> float:
    """Number of particles over the effective number that the weights amount to."""
    squares = 0.0
    for weight in weights:
        squares += weight * weight
    return squares * weights.size


@jit()
def resample(belief: Belief, model: Model, generator: NDArray[np.uint64]) -> None:
    """Draw particles by weight (systematic resampling), jitter them, and add fresh ones."""
    count = belief.weights.size
    offset, reached, k = _unit(generator), belief.weights[0], 0
    for drawn in range(count):
        while reached * count < drawn + offset and k < count - 1:
            k += 1
            reached += belief.weights[k]
        particle = belief.resampled[drawn]
        if _unit(generator) < model.fresh_share:
            _make_fresh(particle, model, generator)
            continue
        for c in range(4):
            shift = model.jitter[c] * gaussian(draw(generator), draw(generator))
            value = belief.particles[k, c] + shift
            particle[c] = min(max(value, model.low[c]), model.high[c])
    for drawn in range(count):
        for c in range(4):
            belief.particles[drawn, c] = belief.resampled[drawn, c]
        belief.weights[drawn] = 1.0 / count


@jit()
def _drawn_place(belief: Belief, chart: Chart, generator: NDArray[np.uint64]) -> int:
    """State nearest to the place of a particle drawn by weight."""
    target, k = _unit(generator), 0
    reached = belief.weights[0]
    while reached < target and k < belief.weights.size - 1:
        k += 1
        reached += belief.weights[k]
    nearest, least = 0, np.inf
    for state in range(chart.position.shape[0]):
        gap_x = chart.position[state, 0] - belief.particles[k, X]
        gap_y = chart.position[state, 1] - belief.particles[k, Y]
        gap = gap_x * gap_x + gap_y * gap_y
        if gap < least:
            nearest, least = state, gap
    return nearest


@jit()
def count_hops(moves: Moves, chart: Chart, place: int) -> None:
    """Fewest steps from every state to a place, breadth first; a step can be flown both ways."""
    chart.hops[:] = -1
    chart.hops[place], chart.queue[0] = 0, place
    head, tail = 0, 1
    while head < tail:
        state = chart.queue[head]
        head += 1
        for a in range(8):
            there = moves.next_state[8 * state + a]
            if there >= 0 and chart.hops[there] < 0:
                chart.hops[there] = chart.hops[state] + 1
                chart.queue[tail] = there
                tail += 1


@jit(inline="always")
def _nearer(moves: Moves, hops: NDArray[np.int32], state: int) -> int:
    """State a step nearer to the place, the same state at the place."""
    for a in range(8):
        there = moves.next_state[8 * state + a]
        if there >= 0 and hops[there] < hops[state]:
            return int(there)
    return state


@jit()
def track(
    moves: Moves, receiver: Receiver, flight: Flight, model: Model, belief: Belief, chart: Chart
) -> bool:
    """Fly by the belief until a reading finds the source or the time is up; which of them."""
    generator, state = flight.generator, int(flight.states[0])
    _begin(belief, model, generator)
    since_drawn = model.steps_to_draw
    reading_dbm = read(receiver, generator, state)
    while reading_dbm <= receiver.found_dbm and not is_over(flight):
        x, y = chart.position[state]
        if not weigh(belief, model, x, y, reading_dbm):
            _begin(belief, model, generator)
        if _concentration(belief.weights) > 2.0:
            resample(belief, model, generator)
        if since_drawn >= model.steps_to_draw or chart.hops[state] == 0:
            count_hops(moves, chart, _drawn_place(belief, chart, generator))
            since_drawn = 0
        state = _nearer(moves, chart.hops, state)
        since_drawn += 1
        spend_second(flight, state)
        reading_dbm = read(receiver, generator, state)
    return reading_dbm > receiver.found_dbm
