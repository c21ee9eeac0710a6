"""Radio maps of several transmitters over one grid, and what follows from them together."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from raytrace.arrays import Floats, Ints
from raytrace.extras import needs_extra
from raytrace.results.layers import LAYERS
from raytrace.results.radio_map import RadioMap
from raytrace.results.transmitter_file import (
    attributes_of_several,
    coordinates_of,
    read_transmitter_file,
    write_transmitter_file,
)

if TYPE_CHECKING:
    import xarray as xr

NOISE_DBM = -94.0
"""Thermal noise at 290 K in 20 MHz, with a noise figure of 7 dB [dBm]."""


@dataclass(frozen=True, eq=False)
class TransmitterMaps(Mapping[str, RadioMap]):
    """Radio maps of several transmitters, by name, in their order.

    Attributes
    ----------
    maps
        At least one, with the same grid, limits, layers, receive antenna and plan.

    Raises
    ------
    ValueError
        For no map, and for maps that were not traced together.
    """

    maps: dict[str, RadioMap]

    def __post_init__(self) -> None:
        """Check that the maps belong together; raise ValueError where they do not."""
        if not self.maps:
            raise ValueError("no maps: expected at least one")
        first_name, first = next(iter(self.maps.items()))
        for name, other in self.maps.items():
            for what, same in (
                ("grids", other.grid.same_as(first.grid)),
                ("limits of the trace", other.config == first.config),
                ("layers", list(other.layers) == list(first.layers)),
                ("receive antennas", other.receive_antenna == first.receive_antenna),
                ("plans", other.plan_sha256 == first.plan_sha256),
            ):
                if not same:
                    raise ValueError(
                        f"maps of {first_name!r} and {name!r} have different {what}: expected "
                        "maps that were traced together"
                    )

    def __repr__(self) -> str:
        """Names and cells in one line."""
        n_y, n_x = self.first.rss_dbm.shape
        return f"<TransmitterMaps of {', '.join(self.names)}: {n_x} x {n_y} cells>"

    def __getitem__(self, name: str) -> RadioMap:
        """Return the map of a transmitter."""
        return self.maps[name]

    def __iter__(self) -> Iterator[str]:
        """Iterate over the names."""
        return iter(self.maps)

    def __len__(self) -> int:
        """Count the transmitters."""
        return len(self.maps)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the transmitters."""
        return tuple(self.maps)

    @property
    def first(self) -> RadioMap:
        """The first map, for what all have in common."""
        return next(iter(self.maps.values()))

    @cached_property
    def rss_dbm(self) -> Floats:
        """(n, n_y, n_x) received power from each transmitter [dBm]; -inf without a path."""
        return np.stack([radio_map.rss_dbm for radio_map in self.maps.values()])

    @cached_property
    def best_server(self) -> Ints:
        """(n_y, n_x) index of the strongest transmitter, the first of equal ones; -1 for none."""
        return np.where(np.isneginf(self.best_server_dbm), -1, self.rss_dbm.argmax(axis=0))

    @cached_property
    def best_server_dbm(self) -> Floats:
        """(n_y, n_x) received power from the strongest transmitter [dBm]."""
        return self.rss_dbm.max(axis=0)

    @cached_property
    def total_dbm(self) -> Floats:
        """(n_y, n_x) sum of the powers from all transmitters [dBm]."""
        return _dbm(_milliwatts(self.rss_dbm).sum(axis=0))

    @cached_property
    def best_server_map(self) -> RadioMap:
        """In each cell the layers of the strongest transmitter; `transmitter` is the first one."""
        at = np.maximum(self.best_server, 0)[None]
        layers = {
            name: np.take_along_axis(np.stack([m.layers[name] for m in self.values()]), at, axis=0)
            for name in self.first.layers
        }
        fields: dict[str, Any] = {name: layer[0] for name, layer in layers.items()}
        return replace(self.first, **fields)

    def sinr_db(self, noise_dbm: float = NOISE_DBM, server: str | None = None) -> Floats:
        """Signal over interference and noise.

        Parameters
        ----------
        noise_dbm
            Power of the noise [dBm].
        server
            The transmitter of the signal; in each cell the strongest by default.

        Returns
        -------
        (n_y, n_x) float64
            [dB]; -inf where the server has no path. All other transmitters at the server's
            frequency interfere.

        Raises
        ------
        ValueError
            For noise that is not finite.
        KeyError
            For an unknown server.
        """
        if not np.isfinite(noise_dbm):
            raise ValueError(f"noise_dbm = {noise_dbm}: expected a finite number [dBm]")
        power = _milliwatts(self.rss_dbm)
        at = self.rss_dbm.argmax(axis=0)
        if server is not None:
            at = np.full_like(at, self._number(server))
        frequency = np.array([m.transmitter.frequency_hz for m in self.maps.values()])
        number = np.arange(len(self))[:, None, None]
        interferes = (frequency[:, None, None] == frequency[at]) & (number != at)
        signal = np.take_along_axis(power, at[None], axis=0)[0]
        rest = np.where(interferes, power, 0.0).sum(axis=0) + 10.0 ** (noise_dbm / 10.0)
        return _dbm(signal / rest)

    def _number(self, name: str) -> int:
        if name not in self.maps:
            raise KeyError(f"no transmitter {name!r}: there are {', '.join(self.maps)}")
        return self.names.index(name)

    def to_xarray(self) -> xr.Dataset:
        """Return the maps as a data set; xarray is needed (``pip install "rssnav[data]"``).

        Returns
        -------
        xarray.Dataset
            As of `RadioMap.to_xarray`, with the dimension `transmitter` before (y, x), and
            positions, powers and frequencies as coordinates of it.
        """
        with needs_extra("data"):
            import xarray as xr

        first = self.first.to_xarray()
        layers = {
            name: (
                ("transmitter", "y", "x"),
                np.stack([m.layers[name] for m in self.maps.values()]),
                {"units": LAYERS[name].units, "long_name": LAYERS[name].long_name},
            )
            for name in self.first.layers
        }
        further = {
            name: ("transmitter", values, {"units": units, "long_name": long_name})
            for name, (values, units, long_name) in coordinates_of(self.maps).items()
        }
        coords = {**first.coords, "transmitter": list(self.names), **further}
        return xr.Dataset(layers, coords, attributes_of_several(self.first))

    def save(self, path: str | Path) -> None:
        """Write to HDF5, whole or not at all (see `raytrace.results.transmitter_file`)."""
        write_transmitter_file(self.maps, Path(path))

    @classmethod
    def load(cls, path: str | Path) -> TransmitterMaps:
        """Read from HDF5; `raytrace.results.map_file.read_map_file` lists the errors."""
        found = read_transmitter_file(Path(path))
        return cls({name: RadioMap(**fields) for name, fields in found.items()})


def _milliwatts(dbm: Floats) -> Floats:
    return 10.0 ** (dbm / 10.0)


def _dbm(milliwatts: Floats) -> Floats:
    """Return a power or a ratio in decibels; -inf for 0."""
    found = np.full(milliwatts.shape, -np.inf)
    some = milliwatts > 0.0
    found[some] = 10.0 * np.log10(milliwatts[some])
    return found
