"""How an RSS reading becomes a discrete state, and how readings fluctuate.

The paper uses one discrete state per RSS value (its threshold Th = 0) in a static world, and
describes two other rules, for readings that change from visit to visit and for few states. All
three are here: :class:`ExactStates`, :class:`ToleranceStates`, :class:`IntervalStates`.

A receiver hears nothing below its sensitivity. Cells without a path and weaker readings are
"no signal", which is a discrete state of its own under every rule, and counts as a reading of the
sensitivity in rewards.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rssnav.arguments import require

AGENT_SENSITIVITY_DBM = -150.0
"""Readings that are not above this level are "no signal" [dBm]: the thermal noise of 250 Hz, which
is less than the weakest cell of the paper's scenarios has."""

MIN_THRESHOLD_DB = 1e-3
MAX_INTERVALS = 1_000_000


@dataclass(frozen=True)
class ExactStates:
    """One discrete state per distinct RSS value (Th = 0), shared by cells of equal RSS."""

    def discrete_states(self, rss_dbm: NDArray[np.float64]) -> NDArray[np.int32]:
        """Discrete state of each cell, shape (S,), numbered as the values first appear."""
        _, first, inverse = np.unique(rss_dbm, return_index=True, return_inverse=True)
        rank = np.empty(first.size, dtype=np.int32)
        rank[np.argsort(first)] = np.arange(first.size, dtype=np.int32)
        return rank[inverse]


@dataclass(frozen=True)
class ToleranceStates:
    """A reading within (s - Th, s + Th) of a known state s is that state; others create one.

    A state stores the reading that created it. A reading within reach of two states belongs to the
    nearer one; at equal distance, to the older one. Known states are thus at least Th apart.

    Parameters
    ----------
    threshold_db : float
        Th [dB], at least 0.001; Th = 0 is :class:`ExactStates`.

    Raises
    ------
    ValueError
        For a threshold below 0.001 dB, or an infinite one.
    """

    threshold_db: float

    def __post_init__(self) -> None:
        holds = MIN_THRESHOLD_DB <= self.threshold_db < math.inf
        expected = f"at least {MIN_THRESHOLD_DB} dB; for Th = 0 use ExactStates()"
        require(holds, "threshold_db", self.threshold_db, expected)


@dataclass(frozen=True)
class IntervalStates:
    """A fixed set of RSS intervals: state k for edges[k-1] <= RSS < edges[k].

    Readings below the first edge are state 0, readings from the last edge on state len(edges).

    Parameters
    ----------
    edges_dbm : tuple of float
        Where one interval ends and the next begins, strictly ascending [dBm].

    Raises
    ------
    ValueError
        Where there is no edge, or they are not finite and strictly ascending.
    """

    edges_dbm: tuple[float, ...]

    def __post_init__(self) -> None:
        edges = np.array(self.edges_dbm, dtype=np.float64)
        if edges.size == 0 or not np.all(np.isfinite(edges)):
            raise ValueError(
                f"edges_dbm: {self.edges_dbm!r} must hold at least one edge, all of them finite"
            )
        if np.any(np.diff(edges) <= 0.0):
            k = int(np.argmax(np.diff(edges) <= 0.0))
            raise ValueError(
                f"edges_dbm: the intervals overlap, edge {k + 1} ({edges[k + 1]:g} dBm) is not "
                f"above edge {k} ({edges[k]:g} dBm); give the edges in strictly ascending order"
            )

    @classmethod
    def uniform(cls, low_dbm: float, high_dbm: float, width_db: float) -> IntervalStates:
        """Intervals of equal width, from ``low_dbm`` up to ``high_dbm`` or just above.

        Parameters
        ----------
        low_dbm, high_dbm : float
            First edge, and what the last one reaches [dBm].
        width_db : float
            Of each interval [dB].

        Raises
        ------
        ValueError
            For a width that is not positive, ends that do not rise, and too many intervals.
        """
        if not (width_db > 0.0 and low_dbm < high_dbm <= low_dbm + MAX_INTERVALS * width_db):
            raise ValueError(
                f"intervals of {width_db!r} dB from {low_dbm!r} to {high_dbm!r} dBm: expected "
                f"a positive width, rising ends and at most {MAX_INTERVALS} of them"
            )
        count = math.ceil((high_dbm - low_dbm) / width_db) + 1
        return cls(tuple(low_dbm + width_db * k for k in range(count)))


StateRule = ExactStates | ToleranceStates | IntervalStates


@dataclass(frozen=True)
class Fluctuation:
    """Gaussian fluctuation of the readings in dB, correlated from one reading to the next.

    Parameters
    ----------
    sigma_db : float
        Standard deviation [dB]; with 0 the readings equal the map's values.
    correlation : float
        Correlation of successive readings' fluctuations, in [0, 1).

    Raises
    ------
    ValueError
        For a number out of range.
    """

    sigma_db: float = 0.0
    correlation: float = 0.0

    def __post_init__(self) -> None:
        finite = 0.0 <= self.sigma_db < math.inf
        require(finite, "sigma_db", self.sigma_db, "a finite number of at least 0 dB")
        within = 0.0 <= self.correlation < 1.0
        require(within, "correlation", self.correlation, "a number in [0, 1)")


def heard(rss_dbm: NDArray[np.float64], sensitivity_dbm: float) -> NDArray[np.float64]:
    """Readings without fluctuation [dBm]; "no signal" is the sensitivity."""
    return np.maximum(rss_dbm, sensitivity_dbm)


def check_sensitivity(sensitivity_dbm: float, terminal_dbm: float) -> None:
    """Raise ValueError unless a receiver of this sensitivity hears the level of the goal."""
    hears = -math.inf < sensitivity_dbm < terminal_dbm
    expected = f"a level below the goal's, {terminal_dbm:g} dBm"
    require(hears, "sensitivity_dbm", sensitivity_dbm, expected)
