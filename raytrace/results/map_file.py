"""Radio maps in HDF5: readable without this project, and never half-written.

`x` and `y` are dimension scales [m], so xarray opens a map with coordinates; every dataset has
`units` and `long_name`. The file's attributes store what made the map; the groups
`transmit_antenna` and `receive_antenna` store the pattern of an antenna given by a table, or of one
that this project does not know (see `raytrace.results.antenna_file`). Nothing that a file says is
believed before it is checked.
"""

from collections.abc import Callable, Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any, Protocol, TypeVar

import h5py
import numpy as np
from numpy.typing import NDArray

from atomicfiles import atomic_write
from raytrace.config import TraceConfig
from raytrace.errors import MapFileError, MissingMapError
from raytrace.grid import Grid
from raytrace.radio.antennas import Antenna
from raytrace.radio.transmitter import Transmitter
from raytrace.results.antenna_file import (
    RECEIVE,
    TRANSMIT,
    antenna_attributes,
    read_antenna,
    read_receive_antenna,
    write_pattern,
)
from raytrace.results.checked_hdf5 import LARGEST, Checked, Hdf5ContentError, Shape, open_checked
from raytrace.results.hdf5 import hdf5_bytes, write_array
from raytrace.results.hdf5_content import HDF5_SIGNATURE
from raytrace.results.layer_checks import contradictions
from raytrace.results.layers import LAYERS

FORMAT = "rssnav radio map"
FORMAT_VERSION, SEVERAL_VERSION = 1, 2
_CONTENTS = {FORMAT_VERSION: "the map of one transmitter", SEVERAL_VERSION: "maps of transmitters"}
"""Versions of files, and what they hold."""

Contents = TypeVar("Contents")

_UNLIMITED = -1
"""`max_transmissions` where power alone limits the transmissions."""

_MARKS = (FORMAT.encode(), b"rss_coherent_dbm")
_MADE_WITH = "made_with_"
_SPACING_TOLERANCE = 1e-6  # of a cell
_POSITIVE = float(np.finfo(np.float64).tiny)


class MapContents(Protocol):
    """What a file stores of a `RadioMap`; its attributes have the same names and meaning."""

    @property
    def layers(self) -> Mapping[str, NDArray[Any]]:
        """(n_y, n_x) each, by name."""
        ...

    @property
    def grid(self) -> Grid:
        """Receivers."""
        ...

    @property
    def transmitter(self) -> Transmitter:
        """Position, power, frequency, antenna."""
        ...

    @property
    def receive_antenna(self) -> Antenna:
        """The receivers' antenna."""
        ...

    @property
    def config(self) -> TraceConfig:
        """Limits of the trace."""
        ...

    @property
    def plan_text(self) -> str:
        """The floor plan's TOML text."""
        ...

    @property
    def plan_sha256(self) -> str:
        """Its hash."""
        ...

    @property
    def provenance(self) -> Mapping[str, Any]:
        """Versions, wall time and the like."""
        ...


def write_map_file(radio_map: MapContents, path: Path) -> None:
    """Write a map; an interrupted write leaves the old file or none."""
    content = hdf5_bytes(lambda file: _write(radio_map, file))
    with atomic_write(path) as temporary:
        temporary.write_bytes(content)


def _write(radio_map: MapContents, file: h5py.File) -> None:
    write_layers(file, radio_map.grid, radio_map.layers)
    file.attrs.update(attributes_of(radio_map))
    write_pattern(radio_map.transmitter.antenna, file, TRANSMIT)
    write_pattern(radio_map.receive_antenna, file, RECEIVE)


def write_layers(
    file: h5py.File, grid: Grid, layers: Mapping[str, NDArray[Any]], further: str | None = None
) -> None:
    """Write the axes of a grid, and layers over them.

    Parameters
    ----------
    file
        Written to.
    grid
        The cells.
    layers
        (n_y, n_x) each, by name; with one more dimension before these if `further` is given.
    further
        Name of a scale that the file has for that dimension.
    """
    for axis in ("y", "x"):
        centres = getattr(grid, axis)
        write_array(file, axis, centres, "m", f"{axis} of the cell centres").make_scale(axis)
    for name, layer in layers.items():
        data = write_array(file, name, layer, LAYERS[name].units, LAYERS[name].long_name)
        for dimension, axis in enumerate(("y", "x") if further is None else (further, "y", "x")):
            data.dims[dimension].attach_scale(file[axis])


def attributes_of(radio_map: MapContents) -> dict[str, Any]:
    """Return what made a map, as a file and a data set store it, without what is None."""
    transmitter = radio_map.transmitter
    return {
        **common_attributes(radio_map),
        "format_version": FORMAT_VERSION,
        "transmitter_position_m": np.array(transmitter.position),
        "transmitter_power_dbm": transmitter.power_dbm,
        "frequency_hz": transmitter.frequency_hz,
        **antenna_attributes(TRANSMIT, transmitter.antenna),
    }


def common_attributes(radio_map: MapContents) -> dict[str, Any]:
    """Return what made a map, without its transmitter and what is None."""
    attributes = {
        "format": FORMAT,
        "plan_text": radio_map.plan_text,
        "plan_sha256": radio_map.plan_sha256,
        "receiver_height_m": radio_map.grid.height_m,
        "cell_size_m": radio_map.grid.cell_size_m,
        **antenna_attributes(RECEIVE, radio_map.receive_antenna),
        **_limits(radio_map.config),
        **{f"{_MADE_WITH}{k}": v for k, v in radio_map.provenance.items()},
    }
    return {key: value for key, value in attributes.items() if value is not None}


def _limits(config: TraceConfig) -> dict[str, Any]:
    """Limits of the trace; `_UNLIMITED` for no number of transmissions."""
    limits = asdict(config)
    return limits | ({"max_transmissions": _UNLIMITED} if config.max_transmissions is None else {})


def read_map_file(path: Path) -> dict[str, Any]:
    """Read a map: the fields of `RadioMap` by name.

    Raises
    ------
    MissingMapError
        Where there is no such file.
    MapFileError
        Where it is not a whole map of this version; the message names what is wrong.
    """
    return read_checked(path, FORMAT_VERSION, _read)


def read_checked(path: Path, version: int, read: Callable[[Checked], Contents]) -> Contents:
    """Read a file of maps of a version; see `read_map_file` for errors."""
    if not path.exists():
        raise MissingMapError(path)
    try:
        with open_checked(path) as file:
            error = _format_error(file, path, version)
            if error is None:
                return read(file)
    except Hdf5ContentError as problem:
        raise _damaged(path, str(problem)) from problem
    raise error


def is_radio_map(path: Path) -> bool:
    """Return whether a file is a radio map, or what is left of one, of any version.

    A file that cannot be read is one if it begins like HDF5 and holds the name of the format or of
    a dataset that only radio maps have. An empty file counts as one: nothing in it is lost.
    """
    if not path.is_file():
        return False
    try:
        with open_checked(path) as file:
            return file.text("format") == FORMAT
    except Hdf5ContentError:
        content = path.read_bytes()
    if not content:
        return True
    return content.startswith(HDF5_SIGNATURE) and any(mark in content for mark in _MARKS)


def _damaged(path: Path, problem: str) -> MapFileError:
    return MapFileError(f"{path}: {problem}; compute the map again", path, remedy="make_map")


def _format_error(file: Checked, path: Path, wanted: int) -> MapFileError | None:
    found = file.attribute("format") if "format" in file.attribute_names else None
    if not isinstance(found, str) or found != FORMAT:
        return MapFileError(
            f"{path}: an HDF5 file, but not a radio map (attribute format = {found!r}, expected "
            f"{FORMAT!r})",
            path,
        )
    version = file.attribute("format_version")
    if not isinstance(version, int) or version not in _CONTENTS:
        return _damaged(path, f"format_version = {version!r}, expected {wanted}")
    if version != wanted:
        return MapFileError(
            f"{path}: holds {_CONTENTS[version]}, expected {_CONTENTS[wanted]}", path
        )
    return None


def _read(file: Checked) -> dict[str, Any]:
    grid, transmitter = read_grid(file), _transmitter(file)
    layers = read_layers(file, ("n_y", "n_x"))
    check_layers(layers, grid, transmitter)
    return {
        "grid": grid,
        **layers,
        "transmitter": transmitter,
        **read_common(file),
    }


def read_common(file: Checked) -> dict[str, Any]:
    """Read what `common_attributes` wrote but the grid: fields of `RadioMap` by name."""
    return {
        "receive_antenna": read_receive_antenna(file),
        "config": _config(file),
        "plan_text": file.text("plan_text"),
        "plan_sha256": file.text("plan_sha256"),
        "provenance": _provenance(file),
    }


def read_grid(file: Checked) -> Grid:
    """Read the cells; their centres must be in steps of their size."""
    x, y = (
        file.array(axis, np.float64, (f"n_{axis}",), low=-LARGEST, high=LARGEST)
        for axis in ("x", "y")
    )
    cell_size_m = file.number("cell_size_m", low=_POSITIVE)
    for name, axis in (("x", x), ("y", y)):
        rounding = 4.0 * np.spacing(np.abs(axis).max(initial=0.0))
        off = np.abs(np.diff(axis) - cell_size_m)
        if axis.size == 0 or (off > _SPACING_TOLERANCE * cell_size_m + rounding).any():
            raise Hdf5ContentError(
                f"dataset {name!r}: expected centres of cells that rise in steps of cell_size_m = "
                f"{cell_size_m:g}"
            )
    return Grid(x, y, file.number("receiver_height_m"), cell_size_m)


def read_layers(file: Checked, shape: Shape) -> dict[str, NDArray[Any]]:
    """Read the layers that a file has."""
    return {
        name: file.array(name, layer.dtype, shape, low=layer.low, high=layer.high)
        for name, layer in LAYERS.items()
        if layer.required or name in file
    }


def check_layers(layers: Mapping[str, NDArray[Any]], grid: Grid, transmitter: Transmitter) -> None:
    """Raise `Hdf5ContentError` for layers of a transmitter that contradict each other."""
    straight_m = _distances(grid, transmitter.position)
    for problem in contradictions(layers, straight_m, transmitter.power_dbm):
        raise Hdf5ContentError(problem)


def _distances(grid: Grid, position: tuple[float, float, float]) -> NDArray[np.float64]:
    """Distances (n_y, n_x) of the receivers from the transmitter [m]."""
    x, y, z = position
    with np.errstate(over="ignore"):
        return np.hypot(np.hypot(grid.x - x, (grid.y - y)[:, None]), grid.height_m - z)


def _config(file: Checked) -> TraceConfig:
    """Limits of the trace; those missing in the file have their defaults."""
    read: dict[str, Callable[[str], Any]] = {
        "max_reflections": file.integer,
        "max_diffractions": file.integer,
        "max_transmissions": lambda name: _transmissions(file.integer(name, low=_UNLIMITED)),
        "min_power_dbm": lambda name: file.number(name, low=-np.inf),
        "max_paths": file.integer,
        "dynamic_range_db": lambda name: file.number(name, low=_POSITIVE, high=np.inf),
    }
    names = file.attribute_names
    return TraceConfig(**{name: read[name](name) for name in read if name in names})


def _transmissions(number: int) -> int | None:
    return None if number == _UNLIMITED else number


def _transmitter(file: Checked) -> Transmitter:
    x, y, z = file.numbers("transmitter_position_m", 3)
    return Transmitter(
        (x, y, z),
        file.number("transmitter_power_dbm"),
        file.number("frequency_hz", low=_POSITIVE),
        read_antenna(file, TRANSMIT),
    )


def _provenance(file: Checked) -> dict[str, Any]:
    found = {
        name.removeprefix(_MADE_WITH): _plain(file.attribute(name))
        for name in file.attribute_names
        if name.startswith(_MADE_WITH)
    }
    if "wall_time_s" in found:
        found["wall_time_s"] = file.number(f"{_MADE_WITH}wall_time_s", low=0.0)
    return found


def _plain(value: Any) -> Any:
    return tuple(value.tolist()) if isinstance(value, np.ndarray) else value
