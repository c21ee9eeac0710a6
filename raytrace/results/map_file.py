"""Radio maps in HDF5: readable without this project, and never half-written.

`x` and `y` are dimension scales [m], so xarray opens a map with coordinates; every dataset has
`units` and `long_name`. The file's attributes store what made the map; the group
`transmit_antenna` stores the pattern of an antenna given by a table.
"""

from collections.abc import Mapping
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any, Protocol

import h5py
import numpy as np
from numpy.typing import NDArray

from atomicfiles import atomic_write
from raytrace.config import TraceConfig
from raytrace.errors import MapFileError, MissingMapError
from raytrace.grid import Grid
from raytrace.radio.antenna_patterns import PatternTable
from raytrace.radio.antennas import Antenna, HalfWaveDipole, Isotropic
from raytrace.radio.transmitter import Transmitter
from raytrace.results.hdf5 import hdf5_bytes
from raytrace.results.layers import LAYERS

FORMAT = "rssnav radio map"
FORMAT_VERSION = 1

_HDF5_SIGNATURE = b"\x89HDF\r\n\x1a\n"
_MARKS = (FORMAT.encode(), b"rss_coherent_dbm")
_ANTENNA = "transmit_antenna"
_ANTENNAS: dict[str, type[HalfWaveDipole | Isotropic | PatternTable]] = {
    kind.__name__: kind for kind in (HalfWaveDipole, Isotropic, PatternTable)
}


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
    for axis in ("y", "x"):
        scale = file.create_dataset(axis, data=getattr(radio_map.grid, axis))
        scale.attrs.update(units="m", long_name=f"{axis} of the cell centres")
        scale.make_scale(axis)
    for name, layer in radio_map.layers.items():
        data = file.create_dataset(name, data=layer, compression="gzip")
        data.attrs.update(units=LAYERS[name].units, long_name=LAYERS[name].long_name)
        data.dims[0].attach_scale(file["y"])
        data.dims[1].attach_scale(file["x"])
    file.attrs.update(attributes_of(radio_map))
    _save_pattern(radio_map.transmitter.antenna, file)


def _save_pattern(antenna: Antenna, file: h5py.File) -> None:
    """Write the arrays of an antenna that has any."""
    for name, value in vars(antenna).items():
        if isinstance(value, np.ndarray):
            file.create_dataset(f"{_ANTENNA}/{name}", data=value)


def attributes_of(radio_map: MapContents) -> dict[str, Any]:
    """Return what made a map, as a file and a data set store it, without what is None."""
    transmitter, grid = radio_map.transmitter, radio_map.grid
    antenna = {k: v for k, v in vars(transmitter.antenna).items() if not isinstance(v, np.ndarray)}
    attributes = {
        "format": FORMAT,
        "format_version": FORMAT_VERSION,
        "plan_text": radio_map.plan_text,
        "plan_sha256": radio_map.plan_sha256,
        "receiver_height_m": grid.height_m,
        "cell_size_m": grid.cell_size_m,
        "transmitter_position_m": np.array(transmitter.position),
        "transmitter_power_dbm": transmitter.power_dbm,
        "frequency_hz": transmitter.frequency_hz,
        _ANTENNA: type(transmitter.antenna).__name__,
        **{f"{_ANTENNA}_{k}": v for k, v in antenna.items()},
        **asdict(radio_map.config),
        **{f"made_with_{k}": v for k, v in radio_map.provenance.items()},
    }
    return {key: value for key, value in attributes.items() if value is not None}


def read_map_file(path: Path) -> dict[str, Any]:
    """Read a map: the fields of `RadioMap` by name.

    Raises
    ------
    MissingMapError
        Where there is no such file.
    MapFileError
        Where it is not a whole map of this version; the message names what is wrong.
    """
    if not path.exists():
        raise MissingMapError(path)
    try:
        with h5py.File(path) as file:
            return _read(file, path)
    except OSError as error:
        raise _damaged(path, f"not an HDF5 file, or a truncated one ({error})") from error
    except (KeyError, TypeError, ValueError, RuntimeError) as error:
        if isinstance(error, MapFileError):
            raise
        raise _damaged(path, f"the map is damaged ({error})") from error


def is_radio_map(path: Path) -> bool:
    """Return whether an unreadable file is what is left of a radio map, of any version.

    A file that HDF5 cannot open is one if it begins like HDF5 and holds the name of the format or
    of a dataset that only radio maps have. An empty file counts as one: nothing in it is lost.
    """
    if not path.is_file():
        return False
    try:
        with h5py.File(path) as file:
            return file.attrs.get("format") == FORMAT
    except (OSError, RuntimeError, KeyError):
        content = path.read_bytes()
    if not content:
        return True
    return content.startswith(_HDF5_SIGNATURE) and any(mark in content for mark in _MARKS)


def _damaged(path: Path, problem: str) -> MapFileError:
    return MapFileError(f"{path}: {problem}; compute the map again", path, remedy="make_map")


def _read(file: h5py.File, path: Path) -> dict[str, Any]:
    attributes: dict[str, Any] = dict(file.attrs)
    _check_format(attributes, path)
    required = [name for name, layer in LAYERS.items() if layer.required]
    missing = [name for name in ("x", "y", *required) if name not in file]
    if missing:
        raise _damaged(path, f"dataset {missing[0]!r} is missing")
    grid = Grid(
        _array(file, "x"),
        _array(file, "y"),
        float(attributes["receiver_height_m"]),
        float(attributes["cell_size_m"]),
    )
    prefix = "made_with_"
    return {
        **_layers(file, grid, path),
        "grid": grid,
        "transmitter": _transmitter(file, attributes),
        "config": _config(attributes),
        "plan_text": str(attributes["plan_text"]),
        "plan_sha256": str(attributes["plan_sha256"]),
        "provenance": {
            k.removeprefix(prefix): _plain(v) for k, v in attributes.items() if k.startswith(prefix)
        },
    }


def _check_format(attributes: dict[str, Any], path: Path) -> None:
    if attributes.get("format") != FORMAT:
        raise MapFileError(
            f"{path}: an HDF5 file, but not a radio map (attribute format = "
            f"{attributes.get('format')!r}, expected {FORMAT!r})",
            path,
        )
    if attributes["format_version"] != FORMAT_VERSION:
        raise _damaged(
            path,
            f"format_version = {attributes['format_version']}, expected {FORMAT_VERSION}",
        )


def _layers(file: h5py.File, grid: Grid, path: Path) -> dict[str, NDArray[Any]]:
    """Read the layers that the file has; refuse any of another shape, or with NaN."""
    layers = {name: _array(file, name) for name in LAYERS if name in file}
    for name, layer in layers.items():
        if layer.shape != grid.shape or np.isnan(layer).any():
            raise _damaged(
                path,
                f"dataset {name!r} has shape {layer.shape}, expected {grid.shape} without NaN",
            )
    return layers


def _array(file: h5py.File, name: str) -> NDArray[Any]:
    dataset = file[name]
    if not isinstance(dataset, h5py.Dataset):
        raise TypeError(f"{name!r} is no dataset")
    return np.asarray(dataset[()])


def _config(attributes: dict[str, Any]) -> TraceConfig:
    """Limits of the trace; those missing in the file have their defaults."""
    known = {f.name for f in fields(TraceConfig)} & set(attributes)
    return TraceConfig(**{name: _plain(attributes[name]) for name in known})


def _transmitter(file: h5py.File, attributes: dict[str, Any]) -> Transmitter:
    prefix = f"{_ANTENNA}_"
    parameters: dict[str, Any] = {
        k.removeprefix(prefix): _plain(v) for k, v in attributes.items() if k.startswith(prefix)
    }
    pattern = file.get(_ANTENNA)
    if isinstance(pattern, h5py.Group):
        parameters |= {str(name): _array(file, f"{_ANTENNA}/{name}") for name in pattern}
    x, y, z = attributes["transmitter_position_m"]
    return Transmitter(
        (float(x), float(y), float(z)),
        float(attributes["transmitter_power_dbm"]),
        float(attributes["frequency_hz"]),
        _ANTENNAS[str(attributes[_ANTENNA])](**parameters),
    )


def _plain(value: Any) -> Any:
    if isinstance(value, np.ndarray):
        return tuple(value.tolist())
    return value.item() if isinstance(value, np.generic) else value
