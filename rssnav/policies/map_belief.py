"""Search with a radio map for each place where the transmitter may be.

The belief is a Bayes filter over the hypotheses; the policies differ in how they act on it.
"""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.special import log_ndtr

from rssnav.arguments import require
from rssnav.discrete_states import AGENT_SENSITIVITY_DBM, heard
from rssnav.kernels.grid_search import expected_cost, steps_to_found
from rssnav.missions.policy import Seen
from rssnav.policies.hypotheses import NO_WAY, Hypotheses
from rssnav.policies.step_memory import StepMemory, any_step

MISSED = float(np.log(0.02))
"""Logarithm of the probability that a transmitter is not found where its map says."""

_FLOOR = 1e-12  # of a hypothesis: none is excluded for ever, since maps are not exact


@dataclass(frozen=True)
class Likelihood:
    """How readings differ from the maps of hypotheses.

    Parameters
    ----------
    sigma_db : float
        Standard deviation of fluctuation and errors of maps [dB].
    temper : float
        Part of an independent reading that a reading counts: errors are alike in near cells.
    sensitivity_dbm : float
        Of the receiver [dBm].

    Raises
    ------
    ValueError
        For a deviation that is not positive, or a temper that is not in (0, 1].
    """

    sigma_db: float = 4.0
    temper: float = 0.5
    sensitivity_dbm: float = AGENT_SENSITIVITY_DBM

    def __post_init__(self) -> None:
        require(self.sigma_db > 0.0, "sigma_db", self.sigma_db, "a positive number [dB]")
        require(0.0 < self.temper <= 1.0, "temper", self.temper, "a number in (0, 1]")

    def log(self, reading_dbm: float, expected_dbm: NDArray[np.float64]) -> NDArray[np.float64]:
        """Logarithm of the likelihood of a reading, up to a constant, after tempering.

        Parameters
        ----------
        reading_dbm : float
            The reading [dBm].
        expected_dbm : NDArray
            RSS under each hypothesis [dBm], of any shape.

        Returns
        -------
        NDArray
            Of the same shape.
        """
        misfit = (reading_dbm - expected_dbm) / self.sigma_db
        censored = reading_dbm <= self.sensitivity_dbm
        return self.temper * (log_ndtr(misfit) if censored else -0.5 * misfit**2)


class MapBelief:
    """Probability of each hypothesis, from readings and from the transmitter's not being found.

    Parameters
    ----------
    hypotheses : Hypotheses
        Places and maps, even a priori.
    likelihood : Likelihood
        How readings differ from them.

    Attributes
    ----------
    probability : (H,) float64
    expected_dbm : (S, H) float64
        Readings without fluctuation.
    """

    def __init__(self, hypotheses: Hypotheses, likelihood: Likelihood) -> None:
        self.hypotheses, self.likelihood = hypotheses, likelihood
        self.expected_dbm = heard(hypotheses.rss_dbm, likelihood.sensitivity_dbm)
        self.begin()

    def begin(self) -> None:
        """Forget the readings."""
        count = self.hypotheses.position.shape[0]
        self.probability = np.full(count, 1.0 / count)

    def update(self, cell: int, reading_dbm: float, *, moved: bool) -> None:
        """Let the transmitter move for a second, then weigh by a reading that did not find it."""
        prior = self.probability
        if moved and self.hypotheses.transition is not None:
            prior = prior @ self.hypotheses.transition
        log = np.log(np.maximum(prior, _FLOOR))
        log += self.likelihood.log(reading_dbm, self.expected_dbm[cell])
        log += MISSED * self.hypotheses.found[cell]
        weight = np.exp(log - log.max())
        self.probability = weight / weight.sum()


class _KnownHops:
    """Fewest steps to where each hypothesis would be found, by the doors as they were last seen.

    Hypotheses that have steps of their own, for the state of the doors, keep theirs.
    """

    def __init__(self, hypotheses: Hypotheses) -> None:
        self._hypotheses = hypotheses
        self._own = bool(hypotheses.layouts)
        size = hypotheses.layout.n_states
        self._queue, self._reached = np.empty(size, np.int32), np.empty(size, np.int32)
        self.begin()

    def begin(self) -> None:
        """Forget the doors of the last flight."""
        self.values = self._hypotheses.hops
        self._next = self._hypotheses.layout.next_state

    def see(self, cell: int, mask: NDArray[np.bool_]) -> None:
        """Note the possible actions in a cell; where a door has changed, find other ways."""
        beyond = self._hypotheses.layout.next_state[cell]
        seen = np.where(mask, beyond, -1)
        changed = np.flatnonzero(seen != self._next[cell])
        if self._own or not changed.size:
            return
        self._next = self._next.copy()
        self._next[cell, changed] = seen[changed]
        self._next[beyond[changed], (changed + 4) % 8] = np.where(mask[changed], cell, -1)
        self.values = np.full_like(self.values, NO_WAY)
        steps_to_found(self._next, self._hypotheses.found, self.values, self._queue, self._reached)


@dataclass(eq=False)
class _MapPolicy:
    """What the policies of this module share: belief, and steps to choose from."""

    hypotheses: Hypotheses
    _: KW_ONLY
    likelihood: Likelihood = field(default_factory=Likelihood)

    def __post_init__(self) -> None:
        self.belief = MapBelief(self.hypotheses, self.likelihood)
        self._hops = _KnownHops(self.hypotheses)

    def begin(self, generator: np.random.Generator) -> None:
        """Forget the last flight."""
        self._generator = generator
        self.belief.begin()
        self._hops.begin()
        self._flown = False

    def _weigh(self, observation: Seen, mask: NDArray[np.bool_]) -> None:
        cell = observation.cell
        require(cell >= 0, "cell", cell, "the UAV's own; fly with an Observation(..., cell=True)")
        self.belief.update(cell, observation.reading_dbm, moved=self._flown)
        self._hops.see(cell, mask)
        self._flown = True

    def _best(self, mask: NDArray[np.bool_], costs: NDArray[np.float64]) -> int:
        """Possible action of the least cost; of equal ones any."""
        actions = np.flatnonzero(mask)
        return int(self._generator.choice(actions[costs <= costs.min() + 1e-9]))


@dataclass(eq=False)
class MapSearch(_MapPolicy):
    """Fly the fewest steps to where one hypothesis would be found, then to another.

    Parameters
    ----------
    hypotheses : Hypotheses
        Places and maps.
    likelihood : Likelihood
        How readings differ from them.
    targets : {"thompson", "greedy"}
        The hypothesis is drawn by its probability (posterior sampling: Thompson 1933,
        doi:10.1093/biomet/25.3-4.285), or has the highest probability per step of the way.
    steps_to_draw : int
        Steps towards it until another is chosen.

    Raises
    ------
    ValueError
        For a number out of range, or another kind of targets.
    """

    targets: Literal["thompson", "greedy"] = "greedy"
    steps_to_draw: int = 3

    def __post_init__(self) -> None:
        super().__post_init__()
        known = ("thompson", "greedy")
        require(self.targets in known, "targets", self.targets, " or ".join(map(repr, known)))
        require(self.steps_to_draw >= 1, "steps_to_draw", self.steps_to_draw, "at least 1")
        self._steps = StepMemory(self.hypotheses.layout, plan_known=True)

    @property
    def name(self) -> str:
        """Short name for tables and figures."""
        return f"Bayesian search, maps, {self.targets}"

    def begin(self, generator: np.random.Generator) -> None:
        """Forget the last flight."""
        super().begin(generator)
        self._steps.begin()
        self._target, self._since = -1, 0

    def act(self, observation: Seen, mask: NDArray[np.bool_]) -> int:
        """Weigh by the reading, and fly a step to the target; see `rssnav.missions.Policy.act`."""
        self._weigh(observation, mask)
        here = self._steps.see(observation.cell, mask)
        if self._target in (-1, here) or self._since >= self.steps_to_draw:
            hypothesis = self._choose(self._hops.values[observation.cell])
            self._target, self._since = self._cell_of(hypothesis), 0
        self._since += 1
        action = int(self._steps.first[self._target])
        return action if action >= 0 else any_step(self._generator, mask)

    def _cell_of(self, hypothesis: int) -> int:
        """Grid cell where to look for it: the nearest that was not visited.

        Maps are not exact: if it was not found where the map says, it may be found beside.
        """
        cells, layout = self._steps.grid_cell, self.hypotheses.layout
        new = ~self._steps.visited[cells]
        if not new.any():
            self._steps.visited[:] = False
            return -1
        likely = new & self.hypotheses.found[:, hypothesis]
        if likely.any():
            cost = np.where(likely, self._steps.hops[cells], np.inf)
        else:
            cost = np.where(new, layout.distance_m(*self.hypotheses.position[hypothesis]), np.inf)
        return int(cells[np.argmin(cost)])

    def _choose(self, hops: NDArray[np.int32]) -> int:
        belief = self.belief.probability
        if self.targets == "thompson":
            return int(self._generator.choice(belief.size, p=belief))
        return int(np.argmax(belief / np.maximum(hops, 1)))


@dataclass(eq=False)
class Qmdp(_MapPolicy):
    """The step with the fewest expected steps to go, as if the place were known after it.

    QMDP (Littman, Cassandra and Kaelbling 1995, doi:10.1016/B978-1-55860-377-6.50052-9): the mean
    over the belief of the optimal costs of each hypothesis. It never flies to learn more.
    """

    name: str = "QMDP"

    def act(self, observation: Seen, mask: NDArray[np.bool_]) -> int:
        """Weigh by the reading, and fly the best step; see `rssnav.missions.Policy.act`."""
        self._weigh(observation, mask)
        there = self.hypotheses.layout.next_state[observation.cell, mask]
        left = self._hops.values[there].astype(np.float64)
        return self._best(mask, left @ self.belief.probability)


@dataclass(eq=False)
class Infotaxis(_MapPolicy):
    """The step after which the least is expected to be unknown.

    Infotaxis (Vergassola, Villermaux and Shraiman 2007, doi:10.1038/nature05464) minimises the
    expected entropy of the belief; space-aware infotaxis (Loisy and Eloy 2022,
    doi:10.1098/rspa.2022.0118) also the distance.

    Parameters
    ----------
    hypotheses : Hypotheses
        Places and maps.
    likelihood : Likelihood
        How readings differ from them.
    space_aware : bool
        Whether the distance counts.
    resolution_db : float
        Spacing of the readings over which the expectation is taken [dB].

    Raises
    ------
    ValueError
        For a number out of range.
    """

    space_aware: bool = True
    resolution_db: float = 2.0

    def __post_init__(self) -> None:
        super().__post_init__()
        require(self.resolution_db > 0.0, "resolution_db", self.resolution_db, "positive [dB]")

    @property
    def name(self) -> str:
        """Short name for tables and figures."""
        return "space-aware infotaxis" if self.space_aware else "infotaxis"

    def act(self, observation: Seen, mask: NDArray[np.bool_]) -> int:
        """Fly the step of the least expected cost; see `rssnav.missions.Policy.act`."""
        self._weigh(observation, mask)
        there = self.hypotheses.layout.next_state[observation.cell, mask]
        belief = self.belief.probability
        hops = self._hops.values[there].astype(np.float64)
        costs = np.array([self._expected(int(cell)) for cell in there])
        return self._best(mask, costs + _TIE * (hops @ belief))

    def _expected(self, cell: int) -> float:
        """Cost expected after the reading in a cell."""
        expected_dbm, sigma_db = self.belief.expected_dbm[cell], self._sigma_db
        likely = self.belief.probability > _UNLIKELY
        low, high = expected_dbm[likely].min(), expected_dbm[likely].max()
        levels_dbm = np.arange(low - 3 * sigma_db, high + 3 * sigma_db, self.resolution_db)
        return float(
            expected_cost(
                np.where(likely, self.belief.probability, 0.0),
                expected_dbm,
                self.hypotheses.found[cell],
                self._hops.values[cell],
                levels_dbm,
                sigma_db,
                self.space_aware,
            )
        )

    @property
    def _sigma_db(self) -> float:
        """Of a reading that counts as much as a tempered one [dB]."""
        return self.likelihood.sigma_db / self.likelihood.temper**0.5


_TIE = 1e-6  # bits a step: of steps that teach as much, the one that leads nearer
_UNLIKELY = 1e-4  # hypotheses below are left out of expectations
