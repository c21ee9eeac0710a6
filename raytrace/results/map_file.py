"""Radio maps in HDF5: readable without this project, whole or not there at all.

`x` and `y` are dimension scales [m], so xarray opens a map with coordinates; every dataset has
`units` and `long_name`. What made the map stands in the file's attributes; the pattern of an
antenna given by a table stands in the group `transmit_antenna`.
"""

from dataclasses import asdict, fields
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from atomicfiles import atomic_write
from raytrace.errors import MapFileError
from raytrace.grid import Grid, TraceConfig
from raytrace.radio.antenna_patterns import PatternTable
from raytrace.radio.antennas import Antenna, HalfWaveDipole, Isotropic
from raytrace.radio.transmitter import Transmitter
from raytrace.results.hdf5 import hdf5_bytes
from raytrace.results.radio_map import LAYERS, RadioMap

FORMAT = "rssnav radio map"
FORMAT_VERSION = 1

_ANTENNA = "transmit_antenna"
_ANTENNAS: dict[str, type[HalfWaveDipole | Isotropic | PatternTable]] = {
    kind.__name__: kind for kind in (HalfWaveDipole, Isotropic, PatternTable)
}


def save_radio_map(radio_map: RadioMap, path: Path) -> None:
    """Write a map; a run that is killed leaves the old file or none."""
    content = hdf5_bytes(lambda file: _write(radio_map, file))
    with atomic_write(path) as temporary:
        temporary.write_bytes(content)


def _write(radio_map: RadioMap, file: h5py.File) -> None:
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


def attributes_of(radio_map: RadioMap) -> dict[str, Any]:
    """What made a map, as a file and a data set hold it; what is None is left out."""
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


def load_radio_map(path: Path) -> RadioMap:
    """Read a map.

    Raises
    ------
    FileNotFoundError
        Where there is no such file.
    MapFileError
        Where it is not a whole map of this version; the message names what is wrong.
    """
    if not path.exists():
        raise FileNotFoundError(f"{path}: no such map file; `rssnav map PLAN -o {path}` makes one")
    try:
        with h5py.File(path) as file:
            return _read(file, path)
    except OSError as error:
        raise MapFileError(
            f"{path}: not an HDF5 file, or a truncated one ({error}); "
            f"make it anew: `rssnav map PLAN -o {path}`"
        ) from error
    except (KeyError, TypeError, ValueError, RuntimeError) as error:
        if isinstance(error, MapFileError):
            raise
        raise MapFileError(f"{path}: the map is damaged ({error}); make it anew") from error


def _read(file: h5py.File, path: Path) -> RadioMap:
    attributes: dict[str, Any] = dict(file.attrs)
    if attributes.get("format") != FORMAT:
        raise MapFileError(
            f"{path}: an HDF5 file, but not a radio map (attribute format = "
            f"{attributes.get('format')!r}, expected {FORMAT!r})"
        )
    if attributes["format_version"] != FORMAT_VERSION:
        raise MapFileError(
            f"{path}: format_version = {attributes['format_version']}, this program reads "
            f"{FORMAT_VERSION}; make the map anew"
        )
    required = [name for name, layer in LAYERS.items() if layer.required]
    missing = [name for name in ("x", "y", *required) if name not in file]
    if missing:
        raise MapFileError(f"{path}: dataset {missing[0]!r} is missing; make the map anew")
    grid = Grid(
        _array(file, "x"),
        _array(file, "y"),
        float(attributes["receiver_height_m"]),
        float(attributes["cell_size_m"]),
    )
    layers = {name: _array(file, name) for name in LAYERS if name in file}
    for name, layer in layers.items():
        if layer.shape != grid.shape or np.isnan(layer).any():
            raise MapFileError(
                f"{path}: dataset {name!r} has shape {layer.shape}, expected {grid.shape} "
                "without NaN; make the map anew"
            )
    prefix = "made_with_"
    return RadioMap(
        **layers,
        grid=grid,
        transmitter=_transmitter(file, attributes),
        config=_config(attributes),
        plan_text=str(attributes["plan_text"]),
        plan_sha256=str(attributes["plan_sha256"]),
        provenance={
            k.removeprefix(prefix): _plain(v) for k, v in attributes.items() if k.startswith(prefix)
        },
    )


def _array(file: h5py.File, name: str) -> NDArray[Any]:
    dataset = file[name]
    if not isinstance(dataset, h5py.Dataset):
        raise TypeError(f"{name!r} is no dataset")
    return np.asarray(dataset[()])


def _config(attributes: dict[str, Any]) -> TraceConfig:
    """Limits of the trace; those that the file does not name have their defaults."""
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
