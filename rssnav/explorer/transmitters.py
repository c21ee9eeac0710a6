"""The transmitters of a session's plan, as its maps take them."""

from dataclasses import replace

from floorplans import FloorPlan, PlanTransmitter
from floorplans.transmitters import ANTENNAS


def without_pattern_files(plan: FloorPlan) -> FloorPlan:
    """Return a plan whose transmitters name no file: an uploaded plan may not read the server's."""
    return replace(plan, transmitters=tuple(map(without_file, plan.transmitters)))


def without_file(transmitter: PlanTransmitter) -> PlanTransmitter:
    """Return a transmitter that names no file, with the default antenna if it named one."""
    if transmitter.antenna is None or transmitter.antenna in ANTENNAS:
        return transmitter
    return replace(transmitter, antenna=None, direction=None)
