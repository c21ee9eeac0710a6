"""Gaussian-process search: Bayesian optimisation of the RSS over the cells."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass

import numpy as np
from numpy.typing import NDArray

from rssnav.arguments import require
from rssnav.missions.layout import Layout
from rssnav.missions.policy import Seen
from rssnav.policies.step_memory import StepMemory, any_step


@dataclass(eq=False)
class GaussianProcessSearch:
    """Fly to the cell with the highest upper confidence bound of the RSS, less the way there.

    GP-UCB (Srinivas et al. 2010, arXiv:0912.3995) with the cost of the way, as for robots by
    Marchant and Ramos (2012, doi:10.1109/IROS.2012.6385653). The kernel is squared exponential,
    the prior mean that of the readings. The first reading of each cell counts; where all cells have
    been visited, the search begins again.

    Parameters
    ----------
    layout : Layout
        Building, of which only size, speed and the UAV's own cells are used.
    length_m : float
        Correlation length [m].
    amplitude_db, sigma_db : float
        Standard deviation of the RSS about its mean, and of readings about the RSS [dB].
    bound : float
        Standard deviations of the upper bound above the mean.
    db_per_step : float
        What a step of the way costs [dB].
    steps_to_choose : int
        Steps towards a cell until another is chosen.

    Raises
    ------
    ValueError
        For a number out of range.
    """

    layout: Layout
    _: KW_ONLY
    length_m: float = 4.0
    amplitude_db: float = 15.0
    sigma_db: float = 4.0
    bound: float = 0.5
    db_per_step: float = 0.3
    steps_to_choose: int = 3
    name: str = "Gaussian-process search"

    def __post_init__(self) -> None:
        for name in ("length_m", "amplitude_db", "sigma_db"):
            value = getattr(self, name)
            require(value > 0.0, name, value, "a positive number")
        least = self.steps_to_choose >= 1
        require(least, "steps_to_choose", self.steps_to_choose, "at least 1")
        self._steps = StepMemory(self.layout, plan_known=False)
        cell_m = self.layout.step_length_m[0] / self.layout.speed
        rows, columns = np.divmod(np.arange(self._steps.visited.size), self.layout.shape[1])
        position = cell_m * np.column_stack((columns, rows))
        squared = np.sum((position[:, None] - position) ** 2, axis=-1) / self.length_m**2
        self._covariance = self.amplitude_db**2 * np.exp(-0.5 * squared)

    def begin(self, generator: np.random.Generator) -> None:
        """Forget the last flight."""
        self._generator = generator
        self._forget()

    def _forget(self) -> None:
        """Begin without readings.

        With the covariance of n readings K + sigma^2 I = L L^T, row by row: the first n rows of
        ``_whitened`` are L^-1 times the covariance of the readings and all cells (C), then L^-1
        times the readings and L^-1 times ones.
        """
        self._steps.begin()
        self._count, self._sum_dbm = 0, 0.0
        self._whitened = np.empty((64, self._covariance.shape[0] + 2))
        self._explained = np.zeros(self._covariance.shape[0])
        self._target, self._since = -1, 0

    def act(self, observation: Seen, mask: NDArray[np.bool_]) -> int:
        """Take the reading, and fly a step to the best cell; see `rssnav.missions.Policy.act`."""
        steps = self._steps
        fresh = not steps.visited[steps.grid_cell[observation.cell]]
        here = steps.see(observation.cell, mask)
        if fresh:
            self._add(here, observation.reading_dbm)
        reached = self._target < 0 or steps.hops[self._target] <= 0
        if reached or self._since >= self.steps_to_choose:
            self._target, self._since = self._choose(), 0
        self._since += 1
        if self._target < 0:
            self._forget()
            return any_step(self._generator, mask)
        return int(steps.first[self._target])

    def _add(self, here: int, reading_dbm: float) -> None:
        """Add a row to the Cholesky factor, in a time that grows with the readings so far."""
        n = self._count
        if n == self._whitened.shape[0]:
            self._whitened = np.concatenate((self._whitened, np.empty_like(self._whitened)))
        row = np.append(self._covariance[here], (reading_dbm, 1.0))
        along = self._whitened[:n, here]
        row -= along @ self._whitened[:n]
        pivot = self.amplitude_db**2 + self.sigma_db**2 - along @ along
        row /= np.sqrt(max(pivot, self.sigma_db**2))
        self._whitened[n] = row
        self._explained += row[:-2] ** 2
        self._count, self._sum_dbm = n + 1, self._sum_dbm + reading_dbm

    def _choose(self) -> int:
        """Grid cell to fly to; -1 where all have been visited."""
        steps = self._steps
        cells = np.flatnonzero(~steps.visited & (steps.hops > 0))
        if cells.size == 0:
            return -1
        mean, deviation = self.predict(cells)
        return int(
            cells[np.argmax(mean + self.bound * deviation - self.db_per_step * steps.hops[cells])]
        )

    def predict(self, cells: NDArray[np.int64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Mean and standard deviation of the RSS in grid cells [dBm], both (k,)."""
        known = self._whitened[: self._count]
        mean = self._sum_dbm / self._count
        predicted = mean + (known[:, -2] - mean * known[:, -1]) @ known[:, :-2]
        variance = self.amplitude_db**2 - self._explained[cells]
        return predicted[cells], np.sqrt(np.maximum(variance, 0.0))
