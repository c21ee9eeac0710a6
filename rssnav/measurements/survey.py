"""A survey: RSS measured at places in a building, from transmitters at known places."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from raytrace import Antenna
from raytrace.arrays import Bools, Floats, Ints

Position = tuple[float, float, float]


class SurveyError(ValueError):
    """A survey that cannot be used; the message names the file, the row and the column.

    Parameters
    ----------
    problem : str
        What is wrong and what would be right.
    path : Path, optional
        The file.
    row : int, optional
        Row of the file, 1 for its heading, as spreadsheets count.
    column : str, optional
        Name of the column.
    value : str, optional
        What stands there.
    """

    def __init__(
        self,
        problem: str,
        path: Path | None = None,
        row: int | None = None,
        column: str | None = None,
        value: str | None = None,
    ) -> None:
        where = [] if row is None else [f"row {row}"]
        if column is not None:
            where.append(f"column {column}" + ("" if value is None else f" = {value[:60]!r}"))
        place = ", ".join(where)
        super().__init__(": ".join(part for part in (str(path or ""), place, problem) if part))
        self.path = path
        self.row = row
        self.column = column


@dataclass(frozen=True)
class SurveyTransmitter:
    """A transmitter that a survey refers to.

    Attributes
    ----------
    name
        As in the column ``tx``.
    position
        (x, y, z) [m].
    power_dbm
        Power fed to its antenna [dBm]; only differences between transmitters matter, since at least
        one offset is fitted.
    frequency_hz
        Carrier frequency [Hz]; None where the survey or the caller states it.
    antenna
        Its antenna; None where the caller states it.
    """

    name: str
    position: Position
    power_dbm: float = 0.0
    frequency_hz: float | None = None
    antenna: Antenna | None = None


@dataclass(frozen=True, eq=False)
class Survey:
    """Readings of RSS, n of them.

    Attributes
    ----------
    transmitters
        Those that are read at least once.
    transmitter
        (n,) int64 index into `transmitters`.
    points
        (n, 3) places of the receiver [m].
    rss_dbm
        (n,) measured RSS [dBm]; of a censored reading, the receiver's sensitivity.
    is_censored
        (n,) bool whether the reading says only that RSS was below `rss_dbm`.
    device
        (n,) int64 index into `devices`.
    devices
        Names of the receivers; one of them, "", where the survey names none.
    n_samples
        (n,) number of samples that a reading is the mean of; None where the survey does not say.
    std_db
        (n,) standard deviation of these samples [dB]; None where the survey does not say.
    frequency_hz
        Carrier frequency of all readings [Hz]; None where nothing states it.
    path
        The file it was read from, for messages.
    """

    transmitters: tuple[SurveyTransmitter, ...]
    transmitter: Ints
    points: Floats
    rss_dbm: Floats
    is_censored: Bools
    device: Ints
    devices: tuple[str, ...] = ("",)
    n_samples: Floats | None = None
    std_db: Floats | None = None
    frequency_hz: float | None = None
    path: Path | None = None

    def __len__(self) -> int:
        """Number of readings."""
        return len(self.rss_dbm)

    @property
    def positions(self) -> Floats:
        """(n, 3) places of the readings' transmitters [m]."""
        return np.array([t.position for t in self.transmitters])[self.transmitter]

    @property
    def distance_m(self) -> Floats:
        """(n,) straight distance from the transmitter [m]."""
        return np.linalg.norm(self.points - self.positions, axis=1)

    @property
    def power_dbm(self) -> Floats:
        """(n,) transmit power [dBm]."""
        return np.array([t.power_dbm for t in self.transmitters])[self.transmitter]

    @property
    def n_places(self) -> int:
        """Number of different places."""
        return len(np.unique(self.points, axis=0))

    def rows(self, rows: Ints | Bools) -> Survey:
        """Return the survey of some of the readings, with all transmitters and devices."""
        return replace(
            self,
            transmitter=self.transmitter[rows],
            points=self.points[rows],
            rss_dbm=self.rss_dbm[rows],
            is_censored=self.is_censored[rows],
            device=self.device[rows],
            n_samples=None if self.n_samples is None else self.n_samples[rows],
            std_db=None if self.std_db is None else self.std_db[rows],
        )


def numbers_of(names: Sequence[str]) -> tuple[tuple[str, ...], Ints]:
    """Return the different names in the order of their first use, and each one's number (n,)."""
    different = tuple(dict.fromkeys(names))
    number = {name: k for k, name in enumerate(different)}
    return different, np.array([number[name] for name in names], dtype=np.int64)
