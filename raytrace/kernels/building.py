"""The extruded building, and the ends of the paths in it: the geometry of a trace."""

from typing import NamedTuple

import numpy as np

from raytrace.arrays import Floats, Ints
from raytrace.kernels.plan_view import PlanView


class Building(NamedTuple):
    """An extruded building.

    Attributes
    ----------
    plan
        The plan view.
    height
        Of the ceiling [m].
    floor, ceiling
        Their slabs.
    has_outdoors
        Whether some cells of the plan have no ceiling.
    """

    plan: PlanView
    height: float
    floor: int
    ceiling: int
    has_outdoors: bool


class Receivers(NamedTuple):
    """Where paths end.

    Attributes
    ----------
    xy
        (n, 2) plan-view positions [m].
    level
        (n,) which of the receiver heights each is at.
    image_z
        (n_levels, 2 max_reflections + 1) images of each height in floor and ceiling [m].
    """

    xy: Floats
    level: Ints
    image_z: Floats


class TraceGeometry(NamedTuple):
    """The geometry that stays the same through a trace.

    Attributes
    ----------
    building
        The building.
    transmitter
        (3,) position [m].
    transmitter_z
        (2 max_reflections + 1,) images of its height in floor and ceiling [m].
    receivers
        The receivers.
    image_bounces
        (2 max_reflections + 1,) number of reflections of each image.
    max_reflections, max_transmissions
        Maximum numbers of reflections and transmissions on a path.
    """

    building: Building
    transmitter: Floats
    transmitter_z: Floats
    receivers: Receivers
    image_bounces: Ints
    max_reflections: int
    max_transmissions: int


def image_heights(z: float, height: float, max_bounces: int) -> Floats:
    """Images of a height in floor and ceiling [m].

    Returns
    -------
    ndarray
        (2 max_bounces + 1,) unfolded heights: the height itself, then for 1, 2, ... reflections
        the image above and the image below (see `image_bounces`).
    """
    heights = [z]
    for m in range(1, max_bounces + 1):
        up = z if m % 2 == 0 else height - z
        heights += [m * height + up, -m * height + up]
    return np.array(heights, dtype=np.float64)


def image_bounces(max_bounces: int) -> Ints:
    """Numbers of reflections (2 max_bounces + 1,) of the images of a height: 0, 1, 1, 2, 2, ..."""
    return (np.arange(2 * max_bounces + 1, dtype=np.int64) + 1) // 2
