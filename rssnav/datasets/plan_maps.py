"""All maps of a plan: their axes, their layers, and the strongest paths if those are kept."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from itertools import product
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from raytrace.arrays import Bools, Floats


class MapIndex(NamedTuple):
    """Which map of a plan it is: an index along each of its dimensions.

    Attributes
    ----------
    preset, height, antenna, frequency, transmitter
        Indices, in the order of the dimensions of a plan's file.
    """

    preset: int
    height: int
    antenna: int
    frequency: int
    transmitter: int


AXES = MapIndex._fields
"""Dimensions of all layers, before y and x."""

STORED = {"path_count": np.int32}
"""Types in which layers are stored; float32 for all others."""


@dataclass(frozen=True, eq=False)
class PlanMaps:
    """The maps of a plan, of shape (P, H, A, F, T, n_y, n_x) over presets, heights, antennas, ...

    Attributes
    ----------
    presets, antennas, transmitters
        Names along their axes.
    heights_m, frequencies_hz
        Values along theirs [m], [Hz].
    positions
        (T, 3) of the transmitters [m].
    power_dbm
        Transmit power [dBm].
    x, y
        (n_x,), (n_y,) cell centres [m].
    inside
        (H, n_y, n_x) cells whose centre is in the building, and in no column.
    layers
        (P, H, A, F, T, n_y, n_x) each, by name; float32, `path_count` int32.
    paths
        Arrays of the strongest paths by name, (P, H, A, F, T, n_y, n_x, n, ...); empty if not kept.
    seconds
        Wall time of each map, in their order [s]; of no file.
    """

    presets: tuple[str, ...]
    heights_m: tuple[float, ...]
    antennas: tuple[str, ...]
    frequencies_hz: tuple[float, ...]
    transmitters: tuple[str, ...]
    positions: Floats
    power_dbm: float
    x: Floats
    y: Floats
    inside: Bools
    layers: dict[str, NDArray[Any]]
    paths: dict[str, NDArray[Any]] = field(default_factory=dict[str, NDArray[Any]])
    seconds: tuple[float, ...] = ()

    @property
    def shape(self) -> tuple[int, ...]:
        """(P, H, A, F, T)."""
        return tuple(
            len(axis)
            for axis in (
                self.presets,
                self.heights_m,
                self.antennas,
                self.frequencies_hz,
                self.transmitters,
            )
        )

    def __len__(self) -> int:
        """Number of maps."""
        return int(np.prod(self.shape))

    def indices(self) -> Iterator[MapIndex]:
        """Yield the index of each map, the transmitter running fastest."""
        return (MapIndex(*index) for index in product(*map(range, self.shape)))

    def map_sha256(self, index: MapIndex) -> str:
        """Return the hash of a map's values: layers and paths in the order of their names."""
        found = hashlib.sha256()
        for name, values in sorted({**self.layers, **self.paths}.items()):
            found.update(name.encode())
            found.update(np.ascontiguousarray(values[index]).tobytes())
        return found.hexdigest()


def empty_layers(
    names: tuple[str, ...], shape: tuple[int, ...], values: Mapping[str, float]
) -> dict[str, NDArray[Any]]:
    """Return layers of a shape by name, filled with their value where no path arrives."""
    return {
        name: np.full(shape, values.get(name, 0), dtype=STORED.get(name, np.float32))
        for name in names
    }
