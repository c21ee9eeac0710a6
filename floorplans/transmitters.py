"""The transmitters of a plan: where they are, and what they send with."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from floorplans.errors import Place, PlanError
from floorplans.values import COORDINATE, Range, check_count, check_number

POWER = Range(-200.0, 200.0, "dBm")
FREQUENCY = Range(1e6, 1e12, "Hz")
MAX_TRANSMITTERS = 1000

ANTENNAS = ("isotropic", "unpolarised", "dipole", "monopole", "patch", "sector")
"""Antennas with a name; any other is the path of a CSV file with a pattern."""

WITHOUT_DIRECTION = ("isotropic", "unpolarised", "monopole")
"""Antennas with a name that have no direction; a monopole stands upright."""

ALL = "all"
"""Word for all transmitters, which is no id."""


@dataclass(frozen=True)
class PlanTransmitter:
    """A transmitter of a plan; what is None is chosen when a map is traced.

    Attributes
    ----------
    id : str
        Its name; no other transmitter of the plan has it.
    position : (float, float, float)
        (x, y, z) [m].
    power_dbm : float or None
        Power fed to the antenna [dBm].
    frequency_hz : float or None
        Carrier frequency [Hz].
    antenna : str or None
        Of `ANTENNAS`, or the path of a CSV file with its pattern, relative to the plan's file.
    direction : (float, float, float) or None
        Of any length: the axis of a dipole, or where the front of a patch or sector, or the +x axis
        of a pattern, points to.
    """

    id: str
    position: tuple[float, float, float]
    power_dbm: float | None = None
    frequency_hz: float | None = None
    antenna: str | None = None
    direction: tuple[float, float, float] | None = None


def check_transmitters(transmitters: Sequence[PlanTransmitter]) -> None:
    """Check the numbers and names of a plan's transmitters; raise `PlanError` for a wrong one."""
    check_count(transmitters, MAX_TRANSMITTERS, ("transmitters",))
    seen: set[str] = set()
    for index, transmitter in enumerate(transmitters):
        place: Place = ("transmitters", index)
        _check_id(transmitter.id, seen, (*place, "id"))
        seen.add(transmitter.id)
        for axis, coordinate in enumerate(transmitter.position):
            check_number(coordinate, COORDINATE, (*place, "position", axis))
        if transmitter.power_dbm is not None:
            check_number(transmitter.power_dbm, POWER, (*place, "power_dbm"))
        if transmitter.frequency_hz is not None:
            check_number(transmitter.frequency_hz, FREQUENCY, (*place, "frequency_hz"))
        _check_antenna(transmitter, place)


def _check_id(name: str, seen: set[str], place: Place) -> None:
    if not (name and name.isprintable() and name == name.strip()) or "," in name or name == ALL:
        raise PlanError(
            f"expected one line of printable text without commas, and not {ALL!r}", place, name
        )
    if name in seen:
        raise PlanError("two transmitters have the same id", place, name)


def _check_antenna(transmitter: PlanTransmitter, place: Place) -> None:
    name, direction = transmitter.antenna, transmitter.direction
    if name is not None and name not in ANTENNAS and not name.lower().endswith(".csv"):
        raise PlanError(
            f"expected {', '.join(ANTENNAS)} or the path of a .csv file with a pattern",
            (*place, "antenna"),
            name,
        )
    if direction is None:
        return
    for axis, part in enumerate(direction):
        check_number(part, COORDINATE, (*place, "direction", axis))
    if not any(direction):
        raise PlanError("expected a direction, not all 0", (*place, "direction"), direction)
    if name is None or name in WITHOUT_DIRECTION:
        raise PlanError(
            "only a dipole, a patch, a sector and a pattern have a direction; give such an antenna",
            (*place, "direction"),
            direction,
        )
