"""What the three families of paths share: the trace's constants, sums and records."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from raytrace.kernels.compiling import jit
from raytrace.kernels.field import Radio
from raytrace.kernels.plan_view import Floats, Ints, PlanView


class Trace(NamedTuple):
    """Everything that stays the same through a trace.

    Attributes
    ----------
    plan, radio
        Plan view, and wavelength, materials and antennas.
    source
        (3,) the transmitter [m].
    source_z
        (2 max_order + 1,) images of its height in floor and ceiling [m].
    receivers
        (n, 2) plan-view positions [m].
    level
        (n,) which of the receiver heights each is at.
    image_z
        (n_levels, 2 max_order + 1) images of each height in floor and ceiling [m].
    image_bounces
        (2 max_order + 1,) how many reflections each image has.
    max_order
        Most reflections on a path.
    """

    plan: PlanView
    radio: Radio
    source: Floats
    source_z: Floats
    receivers: Floats
    level: Ints
    image_z: Floats
    image_bounces: Ints
    max_order: int


class Sums(NamedTuple):
    """What arrives at each receiver.

    Attributes
    ----------
    field
        (n,) complex sum of the paths' gains.
    power
        (n,) sum of their squared magnitudes.
    n_paths
        (n, max_order + 1) number of paths by reflections.
    """

    field: NDArray[np.complex128]
    power: Floats
    n_paths: Ints


class Record(NamedTuple):
    """Room for single paths, filled until it is full.

    Attributes
    ----------
    key
        (n, 4) int32 hit, leg to the edge, height image before and after it; -1 where the path
        has none.
    gain
        (n,) complex path gain.
    used
        (1,) number of paths written.
    """

    key: NDArray[np.int32]
    gain: NDArray[np.complex128]
    used: Ints


def new_sums(n_receivers: int, max_order: int) -> Sums:
    """Sums of no paths."""
    return Sums(
        np.zeros(n_receivers, np.complex128),
        np.zeros(n_receivers),
        np.zeros((n_receivers, max_order + 1), np.int64),
    )


def new_record(n_paths: int) -> Record:
    """Room for that many paths."""
    return Record(
        np.empty((n_paths, 4), np.int32), np.empty(n_paths, np.complex128), np.zeros(1, np.int64)
    )


@jit(inline=True)
def recorded(record: Record, hit: int, leg: int, images: tuple[int, int], gain: complex) -> None:
    """Write a path down if there is room."""
    k = record.used[0]
    if k < len(record.gain):
        record.key[k, 0], record.key[k, 1] = hit, leg
        record.key[k, 2], record.key[k, 3] = images
        record.gain[k] = gain
        record.used[0] = k + 1
