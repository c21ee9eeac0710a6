"""Single paths: their points, interactions and gains."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from operator import index
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from raytrace.arrays import Complexes, Floats, Int8s, Ints
from raytrace.constants import SPEED_OF_LIGHT
from raytrace.extras import needs_extra
from raytrace.kernels.steps import (
    COSINE,
    DIFFRACTION,
    NOTHING,
    REFLECTION,
    TRANSMISSION,
    Steps,
    joined,
    rows_of,
)
from raytrace.memory import check_size
from raytrace.results.csv_file import write_csv

if TYPE_CHECKING:
    import pandas as pd

INTERACTION_NAMES = {NOTHING: "", REFLECTION: "R", DIFFRACTION: "D", TRANSMISSION: "T"}


@dataclass(frozen=True, eq=False, repr=False)
class Paths:
    """Paths from a transmitter to receivers, n of them, strongest first at each receiver.

    Attributes
    ----------
    receiver
        (n,) int64 which receiver each path reaches.
    interactions
        (n, most) int8 interactions in their order: 1 reflection, 2 diffraction, 3 transmission;
        0 after the last.
    vertices
        (n, most + 2, 3) [m] transmitter, points of interaction, receiver; the receiver is
        repeated to the end.
    length_m
        (n,) [m].
    gain
        (n,) complex path gain with both antennas: its squared magnitude is received over
        transmitted power, at most 1, and the gains of a receiver's paths add up to its coherent
        field, unless the polarisation of an antenna is unknown.
    weight
        (n,) what a path counts for in sums: 1, or less for a path that grazes a corner or an edge
        and so exists on one side of the receiver only (docs/conventions.md, "Grazing rays").
    steps
        What the gains depend on; None for paths that were not traced.
    pair_gains
        (n, k) gains between k pairs of polarisations, for an antenna of unknown polarisation: of
        each pair they add up to a coherent field, and the powers of these fields add up. None where
        both polarisations are known.
    """

    receiver: Ints
    interactions: Int8s
    vertices: Floats
    length_m: Floats
    gain: Complexes
    weight: Floats
    steps: Steps | None = None
    pair_gains: Complexes | None = None

    def __len__(self) -> int:
        """Number of paths."""
        return len(self.receiver)

    def __repr__(self) -> str:
        """Numbers of paths and receivers in one line."""
        n, most = len(np.unique(self.receiver)), self.interactions.shape[1]
        receivers = "1 receiver" if n == 1 else f"{n} receivers"
        return f"<Paths: {len(self)} to {receivers}, at most {most} interactions>"

    @property
    def delay_s(self) -> Floats:
        """(n,) time of flight [s]."""
        return self.length_m / SPEED_OF_LIGHT

    @property
    def gain_db(self) -> Floats:
        """(n,) path gain [dB], 20 log10 of its magnitude; -inf where an antenna has its null."""
        with np.errstate(divide="ignore"):
            return 20.0 * np.log10(np.abs(self.gain))

    @property
    def n_interactions(self) -> Ints:
        """(n,) number of reflections, diffractions and transmissions."""
        return np.count_nonzero(self.interactions, axis=1)

    @property
    def surface(self) -> Ints:
        """(n, most) slab of each reflection and transmission, a number in `Scene.slabs`, or -1."""
        return self._steps().slab.astype(np.int64)

    @property
    def incidence(self) -> Floats:
        """(n, most) angle of incidence of each reflection and transmission [rad], 0 for others."""
        steps = self._steps()
        cosine = np.where(steps.slab >= 0, steps.frame[:, :, COSINE], 1.0)
        return np.arccos(np.minimum(cosine, 1.0))

    def _steps(self) -> Steps:
        if self.steps is None:
            raise ValueError("these paths have no steps: expected paths that trace_paths found")
        return self.steps

    @property
    def departure(self) -> Floats:
        """(n, 2) direction at the transmitter: azimuth from +x, zenith angle [rad]."""
        return _angles(self.departure_direction)

    @property
    def arrival(self) -> Floats:
        """(n, 2) direction from the receiver to the incoming path: azimuth, zenith angle [rad]."""
        return _angles(self.arrival_direction)

    @property
    def departure_direction(self) -> Floats:
        """(n, 3) unit vector in which the path leaves the transmitter."""
        return _unit(self.vertices[:, 1] - self.vertices[:, 0])

    @property
    def arrival_direction(self) -> Floats:
        """(n, 3) unit vector from the receiver to where the path comes from."""
        rows = np.arange(len(self))
        last = self.n_interactions
        return _unit(self.vertices[rows, last] - self.vertices[rows, last + 1])

    def doppler_hz(
        self,
        frequency_hz: float,
        receiver_velocity: ArrayLike = (0.0, 0.0, 0.0),
        transmitter_velocity: ArrayLike = (0.0, 0.0, 0.0),
    ) -> Floats:
        """Doppler shifts (n,) [Hz] of moving ends in a building at rest.

        Each end shifts a path by its speed along the path at that end over the wavelength; positive
        where the path becomes shorter (Rappaport, *Wireless Communications*, section
        5.2.1).

        Parameters
        ----------
        frequency_hz
            Carrier frequency [Hz].
        receiver_velocity
            (3,) or one for each path (n, 3) [m/s].
        transmitter_velocity
            The same of the transmitter, (3,) or (n, 3) [m/s].
        """
        towards_m_s = (self.arrival_direction * np.asarray(receiver_velocity)).sum(axis=-1)
        towards_m_s += (self.departure_direction * np.asarray(transmitter_velocity)).sum(axis=-1)
        return towards_m_s * (frequency_hz / SPEED_OF_LIGHT)

    def sequence(self, path: int) -> str:
        """Interactions of one path as letters, such as "RRD"; "LOS" for none."""
        return "".join(INTERACTION_NAMES[int(k)] for k in self.interactions[path]) or "LOS"

    def to_dataframe(self) -> pd.DataFrame:
        """Return a tidy table, one row per path; pandas is needed (``pip install "rssnav[data]"``).

        Returns
        -------
        pandas.DataFrame
            The columns of `columns`.
        """
        with needs_extra("data"):
            import pandas as pd
        return pd.DataFrame(self.columns())

    def to_csv(self, path: str | Path) -> None:
        """Write the table of `columns`, whole or not at all: a row per path."""
        write_csv(Path(path), self.columns())

    def columns(self) -> dict[str, NDArray[Any] | list[str]]:
        """Return a table, one row per path.

        Returns
        -------
        dict
            Columns, each (n,): ``receiver``, ``sequence`` (as `sequence` writes it),
            ``n_reflections``, ``n_diffractions``, ``n_transmissions``, ``length_m``, ``delay_s``,
            ``weight``, ``gain_real``, ``gain_imag``, ``gain_db``, ``surfaces`` and
            ``incidence_deg`` (slabs and angles of incidence [deg] of the reflections and
            transmissions in their order, separated by blanks, "-" for a diffraction), and the
            azimuth and zenith angles [rad]
            ``departure_azimuth``, ``departure_zenith``, ``arrival_azimuth``, ``arrival_zenith``.
        """
        departure, arrival = self.departure, self.arrival
        return {
            "receiver": self.receiver,
            "sequence": [self.sequence(k) for k in range(len(self))],
            "n_reflections": np.count_nonzero(self.interactions == REFLECTION, axis=1),
            "n_diffractions": np.count_nonzero(self.interactions == DIFFRACTION, axis=1),
            "n_transmissions": np.count_nonzero(self.interactions == TRANSMISSION, axis=1),
            "length_m": self.length_m,
            "delay_s": self.delay_s,
            "weight": self.weight,
            "gain_real": self.gain.real,
            "gain_imag": self.gain.imag,
            "gain_db": self.gain_db,
            **self._columns_of_steps(),
            "departure_azimuth": departure[:, 0],
            "departure_zenith": departure[:, 1],
            "arrival_azimuth": arrival[:, 0],
            "arrival_zenith": arrival[:, 1],
        }

    def _columns_of_steps(self) -> dict[str, list[str]]:
        """Return the columns of the table that need steps; none without."""
        if self.steps is None:
            return {}
        degrees = np.degrees(self.incidence)
        texts: dict[str, list[str]] = {"surfaces": [], "incidence_deg": []}
        for k, n in enumerate(self.n_interactions):
            slabs = self.steps.slab[k, :n]
            texts["surfaces"].append(" ".join("-" if s < 0 else str(s) for s in slabs))
            angles = zip(slabs, degrees[k, :n], strict=True)
            texts["incidence_deg"].append(
                " ".join("-" if s < 0 else f"{angle:.6g}" for s, angle in angles)
            )
        return texts

    def impulse_response(
        self,
        bandwidth_hz: float,
        n_taps: int | None = None,
        *,
        start_s: float = 0.0,
        n_receivers: int | None = None,
    ) -> ImpulseResponse:
        """Sample each receiver's channel, band-limited to a bandwidth.

        The taps are ``sum of gain_i sinc(n - B (tau_i - start))``, 1 / B apart (docs/theory.md,
        eq. 39): the complex baseband channel around the carrier, whose phase is part of the gains.

        Parameters
        ----------
        bandwidth_hz
            B [Hz].
        n_taps
            How many; by default 16 after the latest path.
        start_s
            Delay of the first tap [s].
        n_receivers
            How many; by default up to the last one that a path reaches.

        Raises
        ------
        ValueError
            For an antenna of unknown polarisation, a bandwidth that is not from 1e-15 to 1e15 Hz, a
            start beyond 1e15 s, no tap, or fewer receivers than paths reach.
        MemoryLimitError
            For more taps than half of the free memory holds.
        """
        self.check_polarisation()
        if not 1e-15 <= bandwidth_hz <= 1e15:
            raise ValueError(f"bandwidth_hz = {bandwidth_hz}: expected 1e-15 to 1e15")
        if not abs(start_s) <= 1e15:
            raise ValueError(f"start_s = {start_s}: expected a number up to 1e15")
        late = float(self.delay_s.max(initial=start_s)) - start_s
        taps = int(np.ceil(late * bandwidth_hz)) + 17 if n_taps is None else index(n_taps)
        if taps < 1:
            raise ValueError(f"n_taps = {taps}: expected at least 1")
        reached = int(self.receiver.max(initial=-1)) + 1
        most = reached if n_receivers is None else index(n_receivers)
        if most < reached:
            raise ValueError(f"n_receivers = {most}: expected at least {reached}")
        check_size("taps", 16 * most * taps)
        channel = np.zeros((most, taps), dtype=np.complex128)
        shift = bandwidth_hz * (self.delay_s - start_s)
        for n in range(taps):
            np.add.at(channel[:, n], self.receiver, self.weight * self.gain * np.sinc(n - shift))
        return ImpulseResponse(channel, start_s + np.arange(taps) / bandwidth_hz)

    def check_polarisation(self) -> None:
        """Check that gains are those of fields, which add up; raise ValueError otherwise."""
        if self.pair_gains is not None:
            raise ValueError(
                "the polarisation of an antenna is unknown: only powers add up, not fields"
            )

    def at(self, receiver: int) -> Paths:
        """Return the paths of one receiver."""
        return self.rows(np.flatnonzero(self.receiver == receiver))

    def with_bounded_gain(self) -> Paths:
        """Return the same paths, with gains of at most 0 dB (docs/theory.md, section 10)."""
        scale = 1.0 / np.maximum(np.abs(self.gain), 1.0)
        pairs = None if self.pair_gains is None else self.pair_gains * scale[:, None]
        return replace(self, gain=self.gain * scale, pair_gains=pairs)

    def with_halves_joined(self) -> Paths:
        """Return the same paths, with those merged that two beams each found half of (grazing)."""
        half = np.flatnonzero(self.weight < 1.0)
        if not len(half):
            return self
        where = np.round(self.vertices[half].reshape(len(half), -1), 6)
        key = np.column_stack([self.receiver[half], self.interactions[half], where])
        _, first, group = np.unique(key, axis=0, return_index=True, return_inverse=True)
        gain = self.gain[half][first][group]
        alike = np.abs(self.gain[half] - gain) <= 1e-9 * np.abs(gain)
        weight = self.weight.copy()
        weight[half[first]] = np.bincount(group, self.weight[half] * alike, len(first))
        kept = np.ones(len(self), bool)
        kept[half] = ~alike
        kept[half[first]] = True
        return replace(self, weight=weight).rows(np.flatnonzero(kept))

    def strongest_first(self) -> Paths:
        """Return the same paths, receiver by receiver, strongest first."""
        return self.rows(np.lexsort([self.length_m, -np.abs(self.gain), self.receiver]))

    def strongest(self, count: int) -> Paths:
        """Return at most so many paths of each receiver, of paths that are strongest first."""
        first = np.searchsorted(self.receiver, self.receiver)
        return self.rows(np.flatnonzero(np.arange(len(self)) - first < count))

    def rows(self, rows: Ints) -> Paths:
        """Return the paths of the given row numbers (k,), in that order."""
        return Paths(
            self.receiver[rows],
            self.interactions[rows],
            self.vertices[rows],
            self.length_m[rows],
            self.gain[rows],
            self.weight[rows],
            None if self.steps is None else rows_of(self.steps, rows),
            None if self.pair_gains is None else self.pair_gains[rows],
        )

    def _of_width(self, most: int) -> Paths:
        """Return the same paths with columns for that many interactions."""
        more = most - self.interactions.shape[1]
        kinds = np.pad(self.interactions, ((0, 0), (0, more)))
        vertices = np.pad(self.vertices, ((0, 0), (0, more), (0, 0)), mode="edge")
        return replace(self, interactions=kinds, vertices=vertices)

    @classmethod
    def joined(cls, parts: Sequence[Paths]) -> Paths:
        """Return the paths of several lists, one after the other; at least one list."""
        most = max(paths.interactions.shape[1] for paths in parts)
        parts = [paths._of_width(most) for paths in parts]
        steps = [paths.steps for paths in parts if paths.steps is not None]
        pairs = [paths.pair_gains for paths in parts if paths.pair_gains is not None]
        return cls(
            np.concatenate([paths.receiver for paths in parts]),
            np.concatenate([paths.interactions for paths in parts]),
            np.concatenate([paths.vertices for paths in parts]),
            np.concatenate([paths.length_m for paths in parts]),
            np.concatenate([paths.gain for paths in parts]),
            np.concatenate([paths.weight for paths in parts]),
            joined(steps) if len(steps) == len(parts) else None,
            _joined_pairs(pairs, [len(paths) for paths in parts if paths.pair_gains is None]),
        )


@dataclass(frozen=True, eq=False)
class ImpulseResponse:
    """Sampled channels.

    Attributes
    ----------
    taps
        (n_receivers, n_taps) complex amplitudes, both antennas included.
    delay_s
        (n_taps,) [s].
    """

    taps: Complexes
    delay_s: Floats

    def __repr__(self) -> str:
        """Numbers of receivers and taps in one line."""
        n, taps = self.taps.shape
        receivers = "1 receiver" if n == 1 else f"{n} receivers"
        return f"<ImpulseResponse: {receivers}, {taps} taps from {self.delay_s[0] * 1e9:g} ns>"


def _joined_pairs(pairs: list[Complexes], others: list[int]) -> Complexes | None:
    """Join the gains of pairs; lists without any must be empty ones."""
    if not pairs:
        return None
    assert not any(others), "paths with and without pairs of polarisations are no one list"
    return np.concatenate(pairs)


def _unit(vectors: Floats) -> Floats:
    """Vectors (n, 3) of length 1; 0 stays 0."""
    lengths = np.linalg.norm(vectors, axis=1, keepdims=True)
    return vectors / np.where(lengths > 0.0, lengths, 1.0)


def _angles(direction: Floats) -> Floats:
    azimuth = np.arctan2(direction[:, 1], direction[:, 0])
    zenith = np.arctan2(np.hypot(direction[:, 0], direction[:, 1]), direction[:, 2])
    return np.column_stack([azimuth, zenith])
