"""A radio map: what a receiver in each cell of a grid receives, and how it was made."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from raytrace.arrays import Floats, Ints
from raytrace.config import TraceConfig
from raytrace.extras import needs_extra
from raytrace.grid import Grid
from raytrace.radio.antennas import Antenna, HalfWaveDipole
from raytrace.radio.transmitter import Transmitter
from raytrace.results.csv_file import write_csv
from raytrace.results.layers import EMPTY, LAYERS, label_of
from raytrace.results.map_file import attributes_of, read_map_file, write_map_file
from raytrace.results.map_plot import plot_layer

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes


@dataclass(frozen=True, eq=False, repr=False)
class RadioMap:
    """Received signal strength over a grid, and further layers.

    No power exceeds the transmit power (docs/conventions.md, "Near the transmitter"). A layer that
    was not computed is None. `docs/theory.md`, section 13, defines the layers.

    Attributes
    ----------
    rss_dbm
        (n_y, n_x) sum of the paths' powers [dBm]; -inf where no path arrives.
    rss_coherent_dbm
        (n_y, n_x) power of the sum of the paths' fields [dBm]; -inf where no path arrives.
    path_count
        (n_y, n_x) number of paths, int64; 0 exactly where `rss_dbm` is -inf.
    grid, transmitter, config
        What the map was made with.
    plan_text, plan_sha256
        The floor plan's whole text and its hash; empty for a scene without a plan.
    provenance
        Material edition, software versions, wall time and the like.
    strongest_path_dbm
        (n_y, n_x) power of the strongest path [dBm]; -inf where no path arrives.
    mean_delay_s, delay_spread_s
        (n_y, n_x) mean delay and RMS delay spread [s]; 0 where no path arrives.
    angular_spread
        (n_y, n_x) spread of the azimuths of arrival after Fleury, 0 to 1.
    k_factor_db
        (n_y, n_x) strongest path over the sum of all others [dB]; inf for a single path, -inf
        where no path arrives.
    left_out_db
        (n_y, n_x) bound on the power of paths that a limit left out, over the RSS [dB]; -inf where
        nothing was left out, inf where it is not known (`compute_radio_maps`).
    receive_antenna
        The receivers' antenna.
    """

    rss_dbm: Floats
    rss_coherent_dbm: Floats
    path_count: Ints
    grid: Grid
    transmitter: Transmitter
    config: TraceConfig
    plan_text: str = ""
    plan_sha256: str = ""
    provenance: dict[str, Any] = field(default_factory=dict[str, Any])
    strongest_path_dbm: Floats | None = None
    mean_delay_s: Floats | None = None
    delay_spread_s: Floats | None = None
    angular_spread: Floats | None = None
    k_factor_db: Floats | None = None
    left_out_db: Floats | None = None
    receive_antenna: Antenna = field(default_factory=HalfWaveDipole)

    @property
    def layers(self) -> dict[str, NDArray[Any]]:
        """The computed layers by name, in the order of `LAYERS`."""
        found = {name: getattr(self, name) for name in LAYERS}
        return {name: layer for name, layer in found.items() if layer is not None}

    def __repr__(self) -> str:
        """Size, range and transmitter in one line."""
        covered = self.rss_dbm[self.path_count > 0]
        levels = f"{covered.min():.1f} to {covered.max():.1f} dBm" if covered.size else "no path"
        n_y, n_x = self.grid.shape
        place = ", ".join(f"{c:g}" for c in self.transmitter.position)
        return (
            f"<RadioMap {n_x} x {n_y} cells of {self.grid.cell_size_m:g} m, {levels}, from "
            f"({place}) at {self.transmitter.frequency_hz / 1e9:g} GHz>"
        )

    def with_plan(self, text: str, sha256: str) -> RadioMap:
        """Return the same map that stores its plan: TOML text, and sha256 in hexadecimal."""
        return replace(self, plan_text=text, plan_sha256=sha256)

    def covering(self, cells: NDArray[np.bool_]) -> RadioMap:
        """Return the same map with no path in any but some cells (n_y, n_x)."""
        if cells.all():
            return self
        emptied = {name: np.where(cells, layer, EMPTY[name]) for name, layer in self.layers.items()}
        return replace(self, **emptied)

    def to_xarray(self) -> xr.Dataset:
        """Return the map as a data set; xarray is needed (``pip install "rssnav[data]"``).

        Returns
        -------
        xarray.Dataset
            One variable (y, x) per layer, with `units` and `long_name`; coordinates `x` and `y` of
            the cell centres [m] and `z` of the receivers; what made the map as attributes.
        """
        with needs_extra("data"):
            import xarray as xr

        centre = "{} of the cell centres"
        coords = {
            "y": ("y", self.grid.y, {"units": "m", "long_name": centre.format("y")}),
            "x": ("x", self.grid.x, {"units": "m", "long_name": centre.format("x")}),
            "z": ((), self.grid.height_m, {"units": "m", "long_name": "height of the receivers"}),
        }
        layers = {
            name: (
                ("y", "x"),
                layer,
                {"units": LAYERS[name].units, "long_name": LAYERS[name].long_name},
            )
            for name, layer in self.layers.items()
        }
        return xr.Dataset(layers, coords, attributes_of(self))

    def plot(
        self, layer: str = "rss_dbm", *, ax: Axes | None = None, walls: Floats | None = None
    ) -> Axes:
        """Draw a layer in colour, with a star at the transmitter.

        `rssnav.pictures.draw_radio_map` draws a map with everything in its plan.

        Parameters
        ----------
        layer
            One of `layers`.
        ax
            Where to draw; a new figure by default.
        walls
            (n, 2, 2) ends of lines to draw [m], such as `Scene.walls`.

        Returns
        -------
        matplotlib.axes.Axes

        Raises
        ------
        ValueError
            For a layer that the map does not have.
        """
        if layer not in self.layers:
            raise ValueError(f"layer = {layer!r}: expected one of {', '.join(self.layers)}")
        values = np.where(self.path_count > 0, self.layers[layer], np.nan)
        label = label_of(layer)
        axes = plot_layer(self.grid, values, label, ax=ax, walls=walls)
        x, y, _ = self.transmitter.position
        axes.plot(x, y, "*", color="white", markeredgecolor="black", markersize=14.0)
        return axes

    def to_csv(self, path: str | Path) -> None:
        """Write a table, whole or not at all: a row per cell, x running fastest.

        Columns are ``x``, ``y``, ``z`` of the cell's centre [m] and the layers by name; numbers are
        written in full, ``-inf`` where no path arrives.
        """
        x, y = np.meshgrid(self.grid.x, self.grid.y)
        columns = {"x": x, "y": y, "z": np.full_like(x, self.grid.height_m), **self.layers}
        write_csv(Path(path), {name: values.ravel() for name, values in columns.items()})

    def save(self, path: str | Path) -> None:
        """Write to HDF5, whole or not at all (see `raytrace.results.map_file`)."""
        write_map_file(self, Path(path))

    @classmethod
    def load(cls, path: str | Path) -> RadioMap:
        """Read from HDF5; `raytrace.results.map_file.read_map_file` lists the errors."""
        return cls(**read_map_file(Path(path)))
