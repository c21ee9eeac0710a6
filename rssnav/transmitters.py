"""Transmitters of plans -> transmitters of the tracer: what a plan leaves open is filled in."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from floorplans import FloorPlan, PlanTransmitter
from floorplans.transmitters import ALL
from raytrace import Antenna, HalfWaveDipole, Isotropic, PatternTable, Transmitter
from raytrace.antennas import Monopole, Patch, Rotated, Sector

POWER_DBM = 25.0
FREQUENCY_HZ = 2.4e9
SOURCE = "source"
"""Name of a plan's source among its transmitters."""

Position = tuple[float, float, float]

_NAMED: dict[str, Callable[[], Antenna]] = {
    "isotropic": Isotropic,
    "unpolarised": lambda: Isotropic(polarisation="mean"),
    "monopole": Monopole,
    "patch": Patch,
    "sector": Sector,
}


class NoTransmitterError(ValueError):
    """No such transmitter in a plan, or none at all; the message lists those it has."""


@dataclass(frozen=True)
class Sending:
    """What transmitters send with.

    Attributes
    ----------
    power_dbm, frequency_hz, antenna
        Of all transmitters; where None, what the plan says of each, or else the defaults.
    default_antenna
        Where neither `antenna` nor the plan names one.
    folder
        What the paths of pattern files in the plan are relative to.
    """

    power_dbm: float | None = None
    frequency_hz: float | None = None
    antenna: Antenna | None = None
    default_antenna: Antenna = field(default_factory=HalfWaveDipole)
    folder: Path = Path()

    def transmitter(self, of_plan: PlanTransmitter) -> Transmitter:
        """Return a transmitter as the tracer takes it.

        Raises
        ------
        AntennaError
            Where the file of its pattern is wrong.
        """
        power_dbm = _first(self.power_dbm, of_plan.power_dbm, POWER_DBM)
        frequency_hz = _first(self.frequency_hz, of_plan.frequency_hz, FREQUENCY_HZ)
        antenna = self.antenna or self.default_antenna
        if self.antenna is None and of_plan.antenna is not None:
            antenna = antenna_of(of_plan.antenna, of_plan.direction, self.folder)
        return Transmitter(of_plan.position, power_dbm, frequency_hz, antenna)


def _first(*numbers: float | None) -> float:
    """First number that is not None."""
    return next(number for number in numbers if number is not None)


def antenna_of(name: str, direction: Position | None = None, folder: Path = Path()) -> Antenna:
    """Return the antenna of a name in a plan or a command.

    Parameters
    ----------
    name : str
        One of `floorplans.transmitters.ANTENNAS`, or the path of a CSV file with a pattern.
    direction : (float, float, float), optional
        The axis of a dipole, vertical by default, or where the front of a patch or sector, or the
        +x axis of a pattern, points to; +x by default.
    folder : Path, optional
        What the path is relative to.

    Raises
    ------
    AntennaError
        Where the file is wrong.
    """
    if name == "dipole":
        return HalfWaveDipole() if direction is None else HalfWaveDipole(axis=direction)
    antenna = _NAMED[name]() if name in _NAMED else PatternTable.from_csv(folder / name)
    return antenna if direction is None else Rotated.towards(antenna, direction)


def choose_transmitters(
    plan: FloorPlan, names: Sequence[str | Position] = (), sending: Sending | None = None
) -> dict[str, Transmitter]:
    """Return transmitters of a plan, or at places in it, by name.

    Parameters
    ----------
    plan : FloorPlan
    names : sequence of str or (float, float, float), optional
        Ids, "source", "all" transmitters, or positions [m]. By default the source; in a plan
        without one all transmitters.
    sending : Sending, optional
        What they send with.

    Raises
    ------
    NoTransmitterError
        Where the plan has none of that name, or none at all.
    AntennaError
        Where the file of a pattern is wrong.
    """
    found = [one for name in names or [_default(plan)] for one in _named(plan, name)]
    sending = sending or Sending()
    return {of_plan.id: sending.transmitter(of_plan) for of_plan in found}


def _default(plan: FloorPlan) -> str:
    if plan.source is not None:
        return SOURCE
    if plan.transmitters:
        return ALL
    raise NoTransmitterError(
        f"plan {plan.name!r} has neither a source nor transmitters: give a position, or "
        "[[transmitters]] in the plan"
    )


def _named(plan: FloorPlan, name: str | Position) -> list[PlanTransmitter]:
    if not isinstance(name, str):
        return [PlanTransmitter(",".join(f"{c:g}" for c in name), name)]
    known = {transmitter.id: transmitter for transmitter in plan.transmitters}
    if plan.source is not None:
        known.setdefault(SOURCE, PlanTransmitter(SOURCE, plan.source))
    if name == ALL and plan.transmitters:
        return list(plan.transmitters)
    if name not in known:
        names = f"it has {', '.join(known)}" if known else "it has none"
        raise NoTransmitterError(f"plan {plan.name!r} has no transmitter {name!r}: {names}")
    return [known[name]]
