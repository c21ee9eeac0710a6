"""How the world changes: a Markov chain over modes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rssnav.arguments import require

_TOLERANCE = 1e-9

MOST_MODES = 10_000
"""The transition matrix of so many modes takes 0.8 GB."""


@dataclass(frozen=True, eq=False)
class ModeProcess:
    """Probabilities of M modes at the start of an episode, and of changes every second.

    Attributes
    ----------
    initial : (M,) float64
        Probability of each mode when an episode begins.
    transition : (M, M) float64
        Probability that mode i is followed by mode j after one second.

    Raises
    ------
    ValueError
        Unless all are probabilities whose rows sum to one.
    """

    initial: NDArray[np.float64]
    transition: NDArray[np.float64]

    def __post_init__(self) -> None:
        n = self.initial.size
        for name, values, shape in (
            ("initial", self.initial, (n,)),
            ("transition", self.transition, (n, n)),
        ):
            if n == 0 or values.shape != shape:
                raise ValueError(f"{name}: shape {values.shape}, expected {shape} with modes > 0")
            proper = values.min() >= 0.0 and np.all(np.abs(values.sum(-1) - 1.0) < _TOLERANCE)
            if not proper:
                raise ValueError(f"{name}: expected probabilities that sum to 1, got {values!r}")

    @classmethod
    def steady(cls, n_modes: int = 1) -> ModeProcess:
        """Modes drawn for each episode with equal probability, which then do not change."""
        return cls.jumping(n_modes, 0.0)

    @classmethod
    def jumping(cls, n_modes: int, probability: float) -> ModeProcess:
        """Modes of equal probability, drawn anew every second with a probability.

        Parameters
        ----------
        n_modes : int
            Number of modes.
        probability : float
            That a mode is drawn, per second.

        Raises
        ------
        ValueError
            For a number out of range.
        """
        require(1 <= n_modes <= MOST_MODES, "n_modes", n_modes, f"1 to {MOST_MODES}")
        within = 0.0 <= probability <= 1.0
        require(within, "probability", probability, "a number in [0, 1]")
        even = np.full(n_modes, 1.0 / n_modes)
        return cls(even, (1.0 - probability) * np.eye(n_modes) + probability * even)

    @classmethod
    def switching(cls, n_switches: int, closed: float = 0.5, toggles: float = 0.0) -> ModeProcess:
        """Independent switches (doors): mode k has switch i closed if bit i of k is set.

        Parameters
        ----------
        n_switches : int
            Number of switches, of which the modes are all combinations.
        closed : float
            Probability that a switch is closed when an episode begins.
        toggles : float
            Probability that a switch changes, per second.

        Raises
        ------
        ValueError
            For a number out of range.
        """
        require(0 <= n_switches <= 10, "n_switches", n_switches, "0 to 10")
        for name, value in (("closed", closed), ("toggles", toggles)):
            require(0.0 <= value <= 1.0, name, value, "a number in [0, 1]")
        initial: NDArray[np.float64] = np.ones(1)
        transition: NDArray[np.float64] = np.ones((1, 1))
        one = np.array([[1.0 - toggles, toggles], [toggles, 1.0 - toggles]])
        for _ in range(n_switches):
            initial = np.kron(np.array([1.0 - closed, closed]), initial).astype(np.float64)
            transition = np.kron(one, transition).astype(np.float64)
        return cls(initial, transition)

    def times(self, other: ModeProcess) -> ModeProcess:
        """Both chains at once, independent of each other: mode ``k * other.n_modes + j``."""
        return ModeProcess(
            np.kron(self.initial, other.initial).astype(np.float64),
            np.kron(self.transition, other.transition).astype(np.float64),
        )

    @property
    def n_modes(self) -> int:
        """Number M of modes."""
        return self.initial.size

    @property
    def changes(self) -> bool:
        """Whether a mode can change during an episode."""
        return bool(np.any(np.diag(self.transition) < 1.0))
