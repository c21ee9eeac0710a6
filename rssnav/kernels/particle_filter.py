"""A particle filter over the transmitter's position and a log-distance path-loss model.

The hypothesis of a particle: the transmitter is at (x, y), and at distance d the reading is
p - 10 n log10(d / 1 m). The weights are those of bootstrap filtering (Gordon, Salmond and Smith
1993) with systematic resampling; random new particles let it recover from a wrong belief
(augmented Monte Carlo localisation: Thrun, Burgard and Fox, Probabilistic Robotics, section 8.3).
The flight goes to the position of a particle drawn by weight, by the fewest steps, and draws
another from time to time (posterior sampling).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rssnav.kernels.compiling import jit
from rssnav.kernels.searchers import FlightLog, is_over, reading_of, spend_second
from rssnav.kernels.stepping import Moves, Receiver
from rssnav.kernels.xoshiro import draw, gaussian, unit_from_high_bits

X, Y, POWER, EXPONENT = range(4)


class Model(NamedTuple):
    """Prior and likelihood of the filter."""

    low: NDArray[np.float64]  # (4,) new particles lie between ``low`` and ``high``:
    high: NDArray[np.float64]  # (4,) x, y [m], power at 1 m [dBm], exponent
    jitter: NDArray[np.float64]  # (4,) standard deviations added when resampled
    sigma_db: float  # of readings about the model
    fresh_fraction: float  # of new particles, when resampled
    found_m: float  # a reading that does not find the transmitter means it is not nearer than this
    steps_to_draw: int  # after which another position is drawn
    sensitivity_dbm: float  # a reading that is not above it means a level of at most this


class Belief(NamedTuple):
    """The particles of one flight."""

    particles: NDArray[np.float64]  # (N, 4)
    weights: NDArray[np.float64]  # (N,) their sum is 1
    resampled: NDArray[np.float64]  # (N, 4) buffer for the next particles


class Chart(NamedTuple):
    """What the filter knows of the plan: the positions of states, and the steps to a target."""

    position: NDArray[np.float64]  # (S, 2) [m]
    hops: NDArray[np.int32]  # (S,) steps to the target
    queue: NDArray[np.int32]  # (S,) buffer for the search


@jit(inline=True)
def _unit(generator: NDArray[np.uint64]) -> float:
    return unit_from_high_bits(draw(generator))


@jit()
def _draw_new(particle: NDArray[np.float64], model: Model, generator: NDArray[np.uint64]) -> None:
    for k in range(4):
        particle[k] = model.low[k] + (model.high[k] - model.low[k]) * _unit(generator)


@jit()
def _begin(belief: Belief, model: Model, generator: NDArray[np.uint64]) -> None:
    """Draw new particles, all of the same weight."""
    for particle in belief.particles:
        _draw_new(particle, model, generator)
    belief.weights[:] = 1.0 / belief.weights.size


@jit()
def weigh(belief: Belief, model: Model, x: float, y: float, reading_dbm: float) -> bool:
    """Weigh the particles by a reading at (x, y) that did not find the transmitter.

    Returns whether any particle keeps a positive weight.
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
        if reading_dbm <= model.sensitivity_dbm:  # censored: probability of any lower level
            weights[k] *= 0.5 * math.erfc(-math.sqrt(0.5) * misfit)
        else:
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
    """Number of particles divided by their effective number."""
    squares = 0.0
    for weight in weights:
        squares += weight * weight
    return squares * weights.size


@jit()
def resample(belief: Belief, model: Model, generator: NDArray[np.uint64]) -> None:
    """Draw particles by weight (systematic resampling), jitter them, and add new ones."""
    count = belief.weights.size
    offset, reached, k = _unit(generator), belief.weights[0], 0
    for drawn in range(count):
        while reached * count < drawn + offset and k < count - 1:
            k += 1
            reached += belief.weights[k]
        particle = belief.resampled[drawn]
        if _unit(generator) < model.fresh_fraction:
            _draw_new(particle, model, generator)
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
def _draw_target(belief: Belief, chart: Chart, generator: NDArray[np.uint64]) -> int:
    """State nearest to the position of a particle drawn by weight."""
    level, k = _unit(generator), 0
    reached = belief.weights[0]
    while reached < level and k < belief.weights.size - 1:
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
def count_hops(moves: Moves, chart: Chart, target: int) -> None:
    """Fewest steps from every state to a target, breadth first; steps are symmetric."""
    chart.hops[:] = -1
    chart.hops[target], chart.queue[0] = 0, target
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


@jit(inline=True)
def _nearer(moves: Moves, hops: NDArray[np.int32], state: int) -> int:
    """State one step nearer to the target; at the target the same state."""
    for a in range(8):
        there = moves.next_state[8 * state + a]
        if there >= 0 and hops[there] < hops[state]:
            return int(there)
    return state


@jit()
def track(
    moves: Moves, receiver: Receiver, flight: FlightLog, model: Model, belief: Belief, chart: Chart
) -> bool:
    """Fly by the belief until a reading finds the transmitter or the time is up.

    Returns whether a reading found it.
    """
    generator, state = flight.generator, int(flight.states[0])
    _begin(belief, model, generator)
    since_drawn = model.steps_to_draw
    reading_dbm = reading_of(receiver, flight, state)
    while reading_dbm <= receiver.found_dbm and not is_over(flight):
        x, y = chart.position[state]
        if not weigh(belief, model, x, y, reading_dbm):
            _begin(belief, model, generator)
        if _concentration(belief.weights) > 2.0:
            resample(belief, model, generator)
        if since_drawn >= model.steps_to_draw or chart.hops[state] == 0:
            count_hops(moves, chart, _draw_target(belief, chart, generator))
            since_drawn = 0
        state = _nearer(moves, chart.hops, state)
        since_drawn += 1
        spend_second(flight, state)
        reading_dbm = reading_of(receiver, flight, state)
    return reading_dbm > receiver.found_dbm
