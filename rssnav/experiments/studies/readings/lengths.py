"""Numbers of straight and diagonal steps that give a printed length.

A straight step at speed v has the length v, a diagonal one d v. With a rounded diagonal d, such as
1.4142, other lengths are possible than with the square root of two.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from rssnav.experiments.paper.data import CONFIGURATIONS, Configuration
from rssnav.experiments.paper.printed_values import PATH_LENGTH_M

DIAGONALS = {"√2": math.sqrt(2), "1.4142": 1.4142, "1.4143": 1.4143, "1.414": 1.414, "1.41": 1.41}
"""Lengths of a diagonal step [straight steps], by name."""

PRINTED_DIAGONAL = "1.4142"
"""The diagonal that explains the most printed lengths."""

CHANCE_RANGE_M = (90.0, 130.0)
"""Range of the random lengths that :func:`chance_of_a_solution` considers [m]."""

ROUNDING = 1e-9
"""Slack of a comparison of lengths that are rounded to centimetres [m]."""


@dataclass(frozen=True, order=True)
class StepCounts:
    """Numbers of steps of a flight: all of them, and the diagonal ones among them."""

    steps: int
    diagonal: int

    @property
    def straight(self) -> int:
        """Number of straight steps."""
        return self.steps - self.diagonal

    def __str__(self) -> str:
        """Return both numbers."""
        return f"{self.steps}, {self.diagonal}"


def step_counts(length_m: float, speed: int, diagonal: float) -> tuple[StepCounts, ...]:
    """Find every number of steps whose length is printed as ``length_m``.

    Parameters
    ----------
    length_m : float
        Length rounded to centimetres [m].
    speed : int
        Length of a straight step [m].
    diagonal : float
        Length of a diagonal step [straight steps].

    Returns
    -------
    tuple of StepCounts
        By the number of diagonal steps.
    """
    found: list[StepCounts] = []
    for n_diagonal in range(math.floor((length_m + 0.01) / (speed * diagonal)) + 1):
        straight = round(length_m / speed - n_diagonal * diagonal)
        exact_m = speed * (straight + n_diagonal * diagonal)
        if straight >= 0 and abs(exact_m - length_m) <= 0.005 + ROUNDING:
            found.append(StepCounts(straight + n_diagonal, n_diagonal))
    return tuple(found)


def chance_of_a_solution(speed: int, diagonal: float) -> float:
    """Fraction of all lengths of whole centimetres in `CHANCE_RANGE_M` that have a solution."""
    first, last = (round(100 * bound) for bound in CHANCE_RANGE_M)
    lengths = range(first, last)
    return sum(bool(step_counts(cm / 100, speed, diagonal)) for cm in lengths) / len(lengths)


def printed_counts(diagonal: float) -> dict[Configuration, tuple[StepCounts, ...]]:
    """Find the solutions of each printed length."""
    return {key: step_counts(PATH_LENGTH_M[key], key.speed, diagonal) for key in CONFIGURATIONS}


def supposed_counts() -> dict[Configuration, StepCounts]:
    """Return one solution of each printed length, the nearest one where none is exact.

    With `PRINTED_DIAGONAL` each length has one solution, except 121.65 m, which has none; the
    nearest length to it has the solution that is used.
    """
    diagonal = DIAGONALS[PRINTED_DIAGONAL]
    return {
        key: found[0] if found else nearest_counts(PATH_LENGTH_M[key], key.speed, diagonal)
        for key, found in printed_counts(diagonal).items()
    }


def nearest_counts(length_m: float, speed: int, diagonal: float) -> StepCounts:
    """Return the number of steps whose length is nearest to ``length_m`` [m]."""
    most = math.floor(length_m / (speed * diagonal)) + 1
    candidates = [
        StepCounts(straight + n, n)
        for n in range(most + 1)
        if (straight := round(length_m / speed - n * diagonal)) >= 0
    ]
    return min(
        candidates,
        key=lambda counts: abs(speed * (counts.straight + counts.diagonal * diagonal) - length_m),
    )
