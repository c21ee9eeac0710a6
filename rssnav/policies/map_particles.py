"""A particle filter whose likelihood is the radio map of each particle's place."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from rssnav.arguments import require
from rssnav.policies.map_belief import MISSED, MapBelief, MapSearch


class _ParticleBelief(MapBelief):
    """Particles on hypotheses, weighed by readings and drawn anew (Gordon et al. 1993)."""

    def sample(self, count: int, fresh: float, generator: np.random.Generator) -> None:
        """Begin with particles drawn evenly."""
        self._generator, self._fresh = generator, fresh
        self._at = generator.integers(self.probability.size, size=count)
        self._weight = np.full(count, 1.0 / count)
        self._gather()

    def _gather(self) -> None:
        self.probability = np.bincount(self._at, self._weight, minlength=self.probability.size)

    def update(self, cell: int, reading_dbm: float, *, moved: bool) -> None:
        """Weigh the particles; draw them anew where few of them carry the weight."""
        of_hypothesis = self.likelihood.log(reading_dbm, self.expected_dbm[cell])
        of_hypothesis[self.hypotheses.found[cell]] += MISSED
        log = np.log(np.maximum(self._weight, 1e-300)) + of_hypothesis[self._at]
        weight = np.exp(log - log.max())
        self._weight = weight / weight.sum()
        if moved and 1.0 / np.sum(self._weight**2) < 0.5 * self._weight.size:
            self._resample()
        self._gather()

    def _resample(self) -> None:
        """Systematic resampling, some particles at new places."""
        count = self._weight.size
        levels = (np.arange(count) + self._generator.random()) / count
        drawn = np.searchsorted(np.cumsum(self._weight), levels).clip(max=count - 1)
        self._at = self._at[drawn]
        new = self._generator.random(count) < self._fresh
        self._at[new] = self._generator.integers(self.probability.size, size=int(new.sum()))
        self._weight = np.full(count, 1.0 / count)


@dataclass(eq=False)
class MapParticleFilter(MapSearch):
    """Posterior sampling with particles in place of the whole belief.

    As `rssnav.searchers.ParticleFilter`, with maps in place of its distance law (Thrun, Burgard and
    Fox, Probabilistic Robotics, section 8.3).

    Parameters
    ----------
    hypotheses, likelihood, targets, steps_to_draw
        As of `MapSearch`.
    particles : int
        Number of particles.
    fresh_fraction : float
        Part of new particles at each resampling.

    Raises
    ------
    ValueError
        For a number out of range.
    """

    targets: Literal["thompson", "greedy"] = "thompson"
    particles: int = 500
    fresh_fraction: float = 0.1

    def __post_init__(self) -> None:
        super().__post_init__()
        require(self.particles >= 2, "particles", self.particles, "at least 2")
        fresh = self.fresh_fraction
        require(0.0 <= fresh < 1.0, "fresh_fraction", fresh, "a number in [0, 1)")
        self.belief: _ParticleBelief = _ParticleBelief(self.hypotheses, self.likelihood)

    @property
    def name(self) -> str:
        """Short name for tables and figures."""
        return "particle filter, maps"

    def begin(self, generator: np.random.Generator) -> None:
        """Forget the last flight."""
        super().begin(generator)
        self.belief.sample(self.particles, self.fresh_fraction, generator)
