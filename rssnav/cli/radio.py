"""What the options of commands that trace mean: presets, transmitters, positions."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import typer
from shapely import Point

import floorplans
from floorplans import FloorPlan
from raytrace import Antenna, TraceConfig, Transmitter
from rssnav.cli.options import UNLIMITED
from rssnav.maps import HEIGHT_M
from rssnav.presets import PRESETS, Preset, default_preset, with_limits
from rssnav.transmitters import NoTransmitterError, Sending, antenna_of, choose_transmitters

Position = tuple[float, float, float]


@dataclass(frozen=True)
class Radio:
    """What is traced in a plan.

    Attributes
    ----------
    transmitters
        By name.
    config
        Limits of the trace.
    receive_antenna
        The receivers' antenna.
    """

    transmitters: dict[str, Transmitter]
    config: TraceConfig
    receive_antenna: Antenna


def radio_of(
    name: str, plan: FloorPlan, chosen: list[str] | None, options: dict[str, Any]
) -> Radio:
    """Return what the options of a command ask for.

    Parameters
    ----------
    name
        The plan as the command names it.
    plan
        The plan.
    chosen
        Values of --from.
    options
        Of the command, by parameter; those that are missing or None have the preset's value.
    """
    preset = PRESETS[options.get("preset") or default_preset(name)]
    power, frequency, antenna, receiving = (
        options.get(key) for key in ("power", "frequency", "antenna", "receive_antenna")
    )
    sending = Sending(
        power,
        None if frequency is None else frequency * 1e9,
        None if antenna is None else antenna_of(antenna),
        preset.antenna,
        Path() if name in floorplans.builtin_names() else Path(name).parent,
    )
    return Radio(
        _transmitters(plan, name, chosen or [], sending),
        config_of(preset, options),
        preset.antenna if receiving is None else antenna_of(receiving),
    )


def config_of(preset: Preset, options: dict[str, Any]) -> TraceConfig:
    """Return the limits of a preset with those options that are given."""
    found = {field: options.get(option) for field, option in _LIMITS.items()}
    given = {field: value for field, value in found.items() if value is not None}
    if "max_transmissions" in given:
        most = given["max_transmissions"]
        given["max_transmissions"] = None if most == UNLIMITED else int(most)
    return with_limits(preset.config, given)


_LIMITS = {
    "max_reflections": "reflections",
    "max_diffractions": "diffractions",
    "max_transmissions": "transmissions",
    "min_power_dbm": "min_power",
    "dynamic_range_db": "dynamic_range",
    "max_paths": "max_paths",
}
"""Options of the limits of a trace."""


def _transmitters(
    plan: FloorPlan, name: str, chosen: list[str], sending: Sending
) -> dict[str, Transmitter]:
    names: list[str | Position] = []
    for word in chosen:
        place = _numbers(word)
        names.append(word if place is None else place)
        if place is not None:
            check_inside(plan, name, place, "--from")
    try:
        return choose_transmitters(plan, names, sending)
    except NoTransmitterError as error:
        hint = "; use --from X,Y,Z" if not chosen else ""
        raise typer.BadParameter(f"{error}{hint}.", param_hint="--from") from error


def _numbers(text: str) -> Position | None:
    """Read "x,y" or "x,y,z" [m]; None for anything else."""
    try:
        numbers = [float(part) for part in text.split(",")]
    except ValueError:
        return None
    if len(numbers) == 2:
        numbers.append(HEIGHT_M)
    if len(numbers) != 3 or not all(map(math.isfinite, numbers)):
        return None
    x, y, z = numbers
    return x, y, z


def read_position(text: str) -> Position:
    """Read "x,y" or "x,y,z" [m]; anything else is wrong usage."""
    position = _numbers(text)
    if position is None:
        raise typer.BadParameter(f"{text!r} is not X,Y or X,Y,Z in metres, such as 10.5,1.5.")
    return position


def check_inside(
    plan: FloorPlan, name: str, at: Position, option: Literal["--from", "--to"]
) -> None:
    """Check that a position is within a plan; otherwise it is wrong usage."""
    x, y, z = at
    x_min, y_min, x_max, y_max = plan.bounds
    if not (plan.outline.contains(Point(x, y)) and 0.0 < z < plan.height_m):
        raise typer.BadParameter(
            f"({x:g}, {y:g}, {z:g}) is not inside {name}, which reaches from ({x_min:g}, "
            f"{y_min:g}) to ({x_max:g}, {y_max:g}) and is {plan.height_m:g} m high.",
            param_hint=option,
        )
