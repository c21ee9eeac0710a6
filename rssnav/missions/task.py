"""What a step is worth and when an episode ends."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Literal, Protocol

import numpy as np
from numpy.typing import NDArray

from rssnav.arguments import is_finite, is_whole, require
from rssnav.missions.layout import WorldError
from rssnav.missions.mission import Mission

GOAL_DISTANCE_M = 2.0
_MOST = 2**31 - 1  # seconds, readings
_MISSES = 0.05


class EnergyModel(Protocol):
    """Energy of a second of flight."""

    @property
    def hover_j(self) -> float:
        """Energy of a second in a cell [J]."""
        ...

    def step_j(self, step_length_m: NDArray[np.float64]) -> NDArray[np.float64]:
        """Energy of each action (8) after each heading (8, the last row without one), (9, 8) [J].

        Parameters
        ----------
        step_length_m : (8,) float64
            Length of each action's step [m].
        """
        ...


@dataclass(frozen=True)
class ReadingAbove:
    """The transmitter is found by a reading above a level.

    Parameters
    ----------
    level_dbm : float
        Level [dBm]; -21 dBm is free space at 2 m.
    confirmations : int
        Readings whose mean must exceed it. After a first reading above the level the UAV hovers and
        takes the others, one a second; with 1 the first reading decides.
    error : float, optional
        Probability of a false alarm: in a cell whose RSS is not above the level, a visit ends by
        one with at most this probability. With it a sequential test decides (Wald 1945,
        doi:10.1214/aoms/1177731118), as soon as it can and after ``confirmations`` readings at the
        latest. Its alternative is an RSS higher than the level by the standard deviation of the
        fluctuation, which it misses with a probability of about 0.05 after a first reading above
        the level. The bound holds for any number of readings, also if they are correlated.

    Raises
    ------
    ValueError
        For a number out of range.
    """

    level_dbm: float = -21.0
    confirmations: int = 1
    error: float | None = None

    def __post_init__(self) -> None:
        require(is_finite(self.level_dbm), "level_dbm", self.level_dbm, "a finite level [dBm]")
        whole = is_whole(self.confirmations, 1, _MOST)
        require(whole, "confirmations", self.confirmations, f"a whole number from 1 to {_MOST}")
        if self.error is not None:
            require(0.0 < self.error < 1.0, "error", self.error, "a probability in (0, 1)")
            several = self.confirmations > 1
            require(several, "confirmations", self.confirmations, "at least 2 for a test by error")

    @property
    def log_bounds(self) -> tuple[float, float]:
        """Logarithms of the likelihood ratio at which the test accepts and rejects; 0 without."""
        return (0.0, 0.0) if self.error is None else (-math.log(self.error), math.log(_MISSES))

    def cells(self, mission: Mission) -> NDArray[np.bool_]:
        """Cells (M, S) where it is found by readings without fluctuation."""
        return mission.rss_dbm > self.level_dbm

    def __str__(self) -> str:
        return f"RSS > {self.level_dbm:g} dBm"


@dataclass(frozen=True)
class Within:
    """The transmitter is found in a cell nearer to it than a distance.

    Parameters
    ----------
    distance_m : float
        Horizontal distance [m].
    in_sight_dbm : float
        RSS that the cell must have besides, so that a wall between them can be excluded [dBm].

    Raises
    ------
    ValueError
        For a distance that is not positive and finite.
    """

    distance_m: float = GOAL_DISTANCE_M
    in_sight_dbm: float = -math.inf

    def __post_init__(self) -> None:
        positive = self.distance_m > 0.0 and is_finite(self.distance_m)
        require(positive, "distance_m", self.distance_m, "a positive number")

    def cells(self, mission: Mission) -> NDArray[np.bool_]:
        """Cells (M, S) where it is found."""
        near = mission.distance_m < self.distance_m
        if self.in_sight_dbm == -math.inf:
            return near
        return near & (mission.rss_dbm > self.in_sight_dbm)

    def __str__(self) -> str:
        return f"D < {self.distance_m:g} m"


@dataclass(frozen=True)
class Task:
    """Reward and end of an episode.

    Parameters
    ----------
    goal : ReadingAbove or Within
        When the transmitter is found.
    reward : {"rss", "closeness", "none"}
        Reward of a step: RSS_t - RSS_(t-1) [dB], 1 / D_t [1/m] with the horizontal distance D_t to
        the transmitter, or 0.
    goal_reward : float
        Reward for finding it.
    goal_reward_is : {"added", "instead"}
        Whether it is added to the last step's reward or replaces it.
    per_second : float
        Added for every second; negative for a cost of time.
    per_kj : float
        Added for every kilojoule of ``energy``; negative for a cost of energy.
    energy : EnergyModel, optional
        Energy of flying, hovering and turning.
    battery_kj : float
        Energy after which an episode is truncated [kJ].
    max_steps : int
        Seconds after which it is truncated.

    Raises
    ------
    ValueError
        For a parameter out of range, and for a cost of energy without a model of energy.
    """

    goal: ReadingAbove | Within = field(default_factory=ReadingAbove)
    reward: Literal["rss", "closeness", "none"] = "rss"
    goal_reward: float = 1000.0
    goal_reward_is: Literal["added", "instead"] = "added"
    per_second: float = 0.0
    per_kj: float = 0.0
    energy: EnergyModel | None = None
    battery_kj: float = math.inf
    max_steps: int = 20_000

    def __post_init__(self) -> None:
        for name, choices in (
            ("reward", ("rss", "closeness", "none")),
            ("goal_reward_is", ("added", "instead")),
        ):
            value = getattr(self, name)
            require(value in choices, name, value, " or ".join(map(repr, choices)))
        for name in ("goal_reward", "per_second", "per_kj"):
            value = getattr(self, name)
            require(is_finite(value), name, value, "a finite number")
        require(self.battery_kj > 0.0, "battery_kj", self.battery_kj, "a positive number")
        whole = is_whole(self.max_steps, 1, _MOST)
        require(whole, "max_steps", self.max_steps, f"an integer from 1 to {_MOST}")
        if self.energy is None and (self.per_kj != 0.0 or self.battery_kj < math.inf):
            raise ValueError(
                "energy: per_kj and battery_kj need a model of energy, such as MultirotorEnergy()"
            )

    def energy_j(self, mission: Mission) -> NDArray[np.float64]:
        """Energy of each action (8) after each heading (9), shape (9, 8) [J]; 0 without a model."""
        if self.energy is None:
            return np.zeros((9, 8))
        return self.energy.step_j(mission.layout.step_length_m)

    def check(self, mission: Mission) -> NDArray[np.bool_]:
        """Cells (M, S) of the goal.

        Raises
        ------
        WorldError
            When a mode has none, every start lies in one in some mode, or 1 / D is infinite.
        """
        cells = self.goal.cells(mission)
        speed = mission.layout.speed
        if self.reward == "closeness" and not np.all(mission.distance_m > 0.0):
            x, y = mission.source[np.argmin(mission.distance_m.min(axis=1))]
            raise WorldError(
                f"plan {mission.name!r}: the source ({x:g}, {y:g}) lies exactly at a cell "
                "centre, where the reward 1/D is infinite; move the source or the grid"
            )
        if not cells.any(axis=1).all():
            where = "" if mission.n_modes == 1 else f" in mode {np.argmin(cells.any(axis=1))}"
            raise WorldError(
                f"plan {mission.name!r}: no cell with {self.goal} can be reached at speed "
                f"{speed}{where}; another speed, start or threshold is needed"
            )
        if cells[:, mission.starts].all(axis=1).any():
            raise WorldError(
                f"plan {mission.name!r}: the start already has {self.goal}, so every episode would "
                "end before its first step; move the start or tighten the threshold"
            )
        return cells
