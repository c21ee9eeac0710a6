"""Bayesian search by a distance law: no radio map, and a plan only for the ways."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from rssnav.arguments import require
from rssnav.discrete_states import AGENT_SENSITIVITY_DBM
from rssnav.kernels.grid_search import marginal, weigh_by_distance
from rssnav.missions.layout import Layout
from rssnav.missions.policy import Seen
from rssnav.policies.step_memory import StepMemory, any_step

_FROM_BESIDE = np.log(0.2)  # probability that a transmitter is not found from the next cell
_HALF_CELL = 0.5  # mean offset of a transmitter from a cell's centre [cells]


@dataclass(eq=False)
class DistanceSearch:
    """Belief over the transmitter's cell and the path-loss exponent, and flights to its targets.

    The reading at distance d is expected at p - 10 n log10(d / 1 m), with an even prior over the
    cells of the grid and over exponents n (a grid-based Bayes filter: Thrun, Burgard and Fox,
    Probabilistic Robotics, section 8.2). Errors of the law are alike in neighbouring cells, so a
    reading may count as a part of an independent one (tempering). A target is drawn from the belief
    (posterior sampling: Thompson 1933, doi:10.1093/biomet/25.3-4.285), or is the cell with
    the most probability around it per step of the way.

    Parameters
    ----------
    layout : Layout
        Building; of an unknown one only size, speed, and the UAV's own cells are used.
    plan_known : bool
        Whether the steps are known from the begin.
    remembers : bool
        Whether doors that were seen shut are remembered (`StepMemory`).
    targets : {"thompson", "greedy"}
        How a target is chosen.
    power_dbm : float
        Reading at 1 m, p [dBm].
    exponents : tuple of float
        Path-loss exponents n.
    sigma_db : float
        Standard deviation of readings about the law [dB].
    temper : float
        Part of an independent reading that a reading counts.
    steps_to_draw : int
        Steps towards a target until another is chosen.
    extra_steps : float
        Added to the steps of a way when probability per step is compared, so that near cells of
        little probability do not come first.
    sensitivity_dbm : float
        Of the receiver [dBm].

    Raises
    ------
    ValueError
        For a number out of range, or another kind of targets.
    """

    layout: Layout
    _: KW_ONLY
    plan_known: bool = False
    remembers: bool = True
    targets: Literal["thompson", "greedy"] = "greedy"
    power_dbm: float = -15.0
    exponents: tuple[float, ...] = (1.5, 2.0, 2.5, 3.0, 3.5, 4.0, 4.5, 5.5)
    sigma_db: float = 8.0
    temper: float = 1.0
    steps_to_draw: int = 8
    extra_steps: float = 5.0
    sensitivity_dbm: float = AGENT_SENSITIVITY_DBM
    _belief: NDArray[np.float64] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        known = ("thompson", "greedy")
        require(self.targets in known, "targets", self.targets, " or ".join(map(repr, known)))
        require(self.sigma_db > 0.0, "sigma_db", self.sigma_db, "a positive number [dB]")
        require(0.0 < self.temper <= 1.0, "temper", self.temper, "a number in (0, 1]")
        require(self.steps_to_draw >= 1, "steps_to_draw", self.steps_to_draw, "at least 1")
        require(len(self.exponents) > 0, "exponents", self.exponents, "at least one")
        self._steps = StepMemory(self.layout, plan_known=self.plan_known, remembers=self.remembers)
        cell_m = self.layout.step_length_m[0] / self.layout.speed
        self._drop_db = _drop_db(self._steps.shape, cell_m, np.array(self.exponents))
        count = self._steps.visited.size
        self._log_weight = np.zeros((count, len(self.exponents)))
        self._alive, self._belief = np.ones(count, dtype=np.bool_), np.empty(count)

    @property
    def name(self) -> str:
        """Short name for tables and figures."""
        plan = "plan known" if self.plan_known else "plan unknown"
        return f"Bayesian search, distance law, {plan}, {self.targets}"

    @property
    def belief(self) -> NDArray[np.float64]:
        """Probability of each grid cell, shape (n_y, n_x)."""
        return self._belief.reshape(self._steps.shape)

    def begin(self, generator: np.random.Generator) -> None:
        """Forget the last flight."""
        self._generator = generator
        self._steps.begin()
        self._log_weight[:], self._alive[:] = 0.0, True
        self._target, self._since = -1, 0

    def act(self, observation: Seen, mask: NDArray[np.bool_]) -> int:
        """Weigh by the reading, and fly on to the target; see `rssnav.missions.Policy.act`."""
        fresh = not self._steps.visited[self._steps.grid_cell[observation.cell]]
        here = self._steps.see(observation.cell, mask)
        if fresh:  # errors of the law do not change from visit to visit
            self._weigh(here, observation.reading_dbm)
        if self._since >= self.steps_to_draw or not self._is_open(self._target):
            self._target, self._since = self._choose(), 0
        self._since += 1
        action = int(self._steps.first[self._target]) if self._target >= 0 else -1
        return action if action >= 0 else any_step(self._generator, mask)

    def _weigh(self, here: int, reading_dbm: float) -> None:
        n_x = self._steps.shape[1]
        model = (self.power_dbm, self.sigma_db, self.temper, self.sensitivity_dbm)
        place = divmod(here, n_x)
        weigh_by_distance(self._log_weight, self._drop_db, place, n_x, model, reading_dbm)
        self._alive[here] = False
        self._log_weight[self._steps.beside(here)] += _FROM_BESIDE

    def _is_open(self, target: int) -> bool:
        return target >= 0 and bool(self._alive[target]) and self._steps.first[target] >= 0

    def _choose(self) -> int:
        """Grid cell to fly to; -1 where no cell is left."""
        hops = self._steps.hops
        if not np.any(self._alive & (hops > 0)):
            self._alive[:] = True  # all were visited, and a reading missed it: begin again
        self._alive &= hops > 0  # cells without a way to them are none that steps lead to
        if not marginal(self._log_weight, self._alive, self._belief):
            return -1
        if self.targets == "thompson":
            return int(np.searchsorted(np.cumsum(self._belief), self._generator.random()))
        around = np.where(self._alive, _sum_around(self.belief).reshape(-1), 0.0)
        return int(np.argmax(around / (np.maximum(hops, 1) + self.extra_steps)))


def _drop_db(
    shape: tuple[int, int], cell_m: float, exponents: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Path loss beyond that at 1 m, after so many cells along each axis (n_y, n_x, E) [dB]."""
    rows, columns = np.arange(shape[0])[:, None], np.arange(shape[1])
    distance_m = cell_m * np.sqrt(rows**2 + columns**2 + _HALF_CELL**2)
    return 10.0 * exponents * np.log10(np.maximum(distance_m, 1.0))[:, :, None]


def _sum_around(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Sum over each cell and the eight around it."""
    padded = np.pad(values, 1)
    columns = padded[:, :-2] + padded[:, 1:-1] + padded[:, 2:]
    return columns[:-2] + columns[1:-1] + columns[2:]
