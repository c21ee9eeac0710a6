"""Single paths: where they go, what they meet, how strong they arrive."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from raytrace.constants import SPEED_OF_LIGHT
from raytrace.kernels.path_points import DIFFRACTION, NOTHING, REFLECTION

INTERACTION_NAMES = {NOTHING: "", REFLECTION: "R", DIFFRACTION: "D"}


@dataclass(frozen=True, eq=False)
class Paths:
    """Paths from a transmitter to receivers, n of them, strongest first at each receiver.

    Attributes
    ----------
    receiver
        (n,) int64 which receiver each path reaches.
    interactions
        (n, most) int8 what happens on the way: 1 reflection, 2 diffraction, 0 no more.
    vertices
        (n, most + 2, 3) [m] transmitter, points of interaction, receiver; the receiver is
        repeated to the end.
    length_m
        (n,) [m].
    gain
        (n,) complex path gain with both antennas: its squared magnitude is received over
        transmitted power, and the gains of a receiver's paths add up to its coherent field.
    """

    receiver: NDArray[np.int64]
    interactions: NDArray[np.int8]
    vertices: NDArray[np.float64]
    length_m: NDArray[np.float64]
    gain: NDArray[np.complex128]

    def __len__(self) -> int:
        """Number of paths."""
        return len(self.receiver)

    @property
    def delay_s(self) -> NDArray[np.float64]:
        """(n,) time of flight [s]."""
        return self.length_m / SPEED_OF_LIGHT

    @property
    def gain_db(self) -> NDArray[np.float64]:
        """(n,) path gain [dB], 20 log10 of its magnitude; -inf where an antenna has its null."""
        with np.errstate(divide="ignore"):
            return 20.0 * np.log10(np.abs(self.gain))

    @property
    def n_interactions(self) -> NDArray[np.int64]:
        """(n,) number of reflections and diffractions."""
        return np.count_nonzero(self.interactions, axis=1)

    @property
    def departure(self) -> NDArray[np.float64]:
        """(n, 2) direction at the transmitter: azimuth from +x, zenith angle [rad]."""
        return _angles(self.vertices[:, 1] - self.vertices[:, 0])

    @property
    def arrival(self) -> NDArray[np.float64]:
        """(n, 2) where the receiver sees the path come from: azimuth, zenith angle [rad]."""
        rows = np.arange(len(self))
        last = self.n_interactions
        return _angles(self.vertices[rows, last] - self.vertices[rows, last + 1])

    def sequence(self, path: int) -> str:
        """Interactions of one path in words, "RRD" for example; "LOS" for none."""
        return "".join(INTERACTION_NAMES[int(k)] for k in self.interactions[path]) or "LOS"

    def at(self, receiver: int) -> "Paths":
        """Return the paths of one receiver."""
        return self._rows(np.flatnonzero(self.receiver == receiver))

    def strongest_first(self) -> "Paths":
        """Return the same paths, receiver by receiver, strongest first."""
        return self._rows(np.lexsort([self.length_m, -np.abs(self.gain), self.receiver]))

    def _rows(self, rows: NDArray[np.int64]) -> "Paths":
        return Paths(
            self.receiver[rows],
            self.interactions[rows],
            self.vertices[rows],
            self.length_m[rows],
            self.gain[rows],
        )


def _angles(direction: NDArray[np.float64]) -> NDArray[np.float64]:
    azimuth = np.arctan2(direction[:, 1], direction[:, 0])
    zenith = np.arctan2(np.hypot(direction[:, 0], direction[:, 1]), direction[:, 2])
    return np.column_stack([azimuth, zenith])
