"""Several transmitters: which of them share paths, and how far the work for all of them is."""

import math
from collections.abc import Mapping, Sequence

import numpy as np

from raytrace.config import TraceConfig
from raytrace.errors import SceneError
from raytrace.radio.antennas import Antenna
from raytrace.radio.materials import Slab
from raytrace.radio.transmitter import Transmitter
from raytrace.solver.accumulate import Progress

PARTS = 1000
"""Parts that the work for a transmitter is divided into."""


def sharing_paths(transmitters: Mapping[str, Transmitter], config: TraceConfig) -> list[list[str]]:
    """Divide transmitters into those that beams can be grown once for; return their names.

    The first of each has the lowest frequency.
    """
    if config.is_limited and math.isinf(config.dynamic_range_db):
        return [[name] for name in transmitters]
    groups: dict[object, list[str]] = {}
    for name, each in transmitters.items():
        key: object = each.position
        if config.is_limited:
            key = each.position, each.power_dbm, _identity(each.antenna)
        groups.setdefault(key, []).append(name)
    return [sorted(group, key=lambda n: transmitters[n].frequency_hz) for group in groups.values()]


def _identity(antenna: Antenna) -> object:
    """Return what is equal for the same antenna; one of a user's own class may have no hash."""
    try:
        hash(antenna)
    except TypeError:
        return id(antenna)
    return antenna


def check_frequencies(slabs: Sequence[Slab], transmitters: Mapping[str, Transmitter]) -> None:
    """Check that all materials are known at all frequencies, before the first is traced.

    Raises
    ------
    SceneError
        Where one is not; the message names the transmitter.
    """
    for name, transmitter in transmitters.items():
        try:
            for slab in slabs:
                frequency_hz = transmitter.frequency_hz
                slab.material.coefficients(slab.thickness_m, frequency_hz, np.ones(1))
        except SceneError as error:
            raise SceneError(f"transmitter {name!r}: {error}") from error


def part_of(progress: Progress | None, number: int, count: int, several: int) -> Progress | None:
    """Progress of one or several of equal pieces of work, as progress of all."""
    if progress is None:
        return None
    return lambda done, total: progress(
        number * PARTS + several * PARTS * done // total, count * PARTS
    )
