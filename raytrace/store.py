"""Radio maps in HDF5: readable without this project, whole or not there at all.

`x` and `y` are dimension scales [m], so xarray opens a map with coordinates; every dataset has
`units` and `long_name`. What made the map stands in the file's attributes.
"""

import os
from collections.abc import Generator
from contextlib import contextmanager
from dataclasses import asdict
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from raytrace.antennas import HalfWaveDipole, Isotropic
from raytrace.errors import MapFileError
from raytrace.grid import Grid, TraceConfig
from raytrace.radio_map import RadioMap
from raytrace.transmitter import Transmitter

FORMAT = "rssnav radio map"
FORMAT_VERSION = 1

_DATASETS = {
    "rss_dbm": ("dBm", "received signal strength, sum of the paths' powers"),
    "rss_coherent_dbm": ("dBm", "received signal strength, power of the sum of the paths' fields"),
    "path_count": ("1", "number of paths"),
}
_ANTENNAS = {"HalfWaveDipole": HalfWaveDipole, "Isotropic": Isotropic}


@contextmanager
def whole_file(path: Path) -> Generator[Path]:
    """Give a temporary file beside `path` that takes its place if all goes well."""
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = path.with_name(f".{path.name}.{os.getpid()}.tmp")
    try:
        yield temporary
        with temporary.open("rb+") as written:
            os.fsync(written.fileno())
        temporary.replace(path)
    finally:
        temporary.unlink(missing_ok=True)


def save_radio_map(radio_map: RadioMap, path: Path) -> None:
    """Write a map; a run that is killed leaves the old file or none."""
    with whole_file(path) as temporary, h5py.File(temporary, "w") as file:
        for axis in ("y", "x"):
            scale = file.create_dataset(axis, data=getattr(radio_map.grid, axis))
            scale.attrs.update(units="m", long_name=f"{axis} of the cell centres")
            scale.make_scale(axis)
        for name, (units, long_name) in _DATASETS.items():
            data = file.create_dataset(name, data=getattr(radio_map, name), compression="gzip")
            data.attrs.update(units=units, long_name=long_name)
            data.dims[0].attach_scale(file["y"])
            data.dims[1].attach_scale(file["x"])
        file.attrs.update(_attributes(radio_map))


def _attributes(radio_map: RadioMap) -> dict[str, Any]:
    transmitter, grid = radio_map.transmitter, radio_map.grid
    return {
        "format": FORMAT,
        "format_version": FORMAT_VERSION,
        "plan_text": radio_map.plan_text,
        "plan_sha256": radio_map.plan_sha256,
        "receiver_height_m": grid.height_m,
        "cell_size_m": grid.cell_size_m,
        "transmitter_position_m": np.array(transmitter.position),
        "transmitter_power_dbm": transmitter.power_dbm,
        "frequency_hz": transmitter.frequency_hz,
        "transmit_antenna": type(transmitter.antenna).__name__,
        **{f"transmit_antenna_{k}": v for k, v in vars(transmitter.antenna).items()},
        **asdict(radio_map.config),
        **{f"made_with_{k}": v for k, v in radio_map.provenance.items()},
    }


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
    missing = [name for name in ("x", "y", *_DATASETS) if name not in file]
    if missing:
        raise MapFileError(f"{path}: dataset {missing[0]!r} is missing; make the map anew")
    grid = Grid(
        _array(file, "x"),
        _array(file, "y"),
        float(attributes["receiver_height_m"]),
        float(attributes["cell_size_m"]),
    )
    layers = {name: _array(file, name) for name in _DATASETS}
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
        transmitter=_transmitter(attributes),
        config=TraceConfig(int(attributes["max_reflections"]), int(attributes["max_diffractions"])),
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


def _transmitter(attributes: dict[str, Any]) -> Transmitter:
    prefix = "transmit_antenna_"
    parameters = {
        k.removeprefix(prefix): float(v) for k, v in attributes.items() if k.startswith(prefix)
    }
    x, y, z = attributes["transmitter_position_m"]
    return Transmitter(
        (float(x), float(y), float(z)),
        float(attributes["transmitter_power_dbm"]),
        float(attributes["frequency_hz"]),
        _ANTENNAS[str(attributes["transmit_antenna"])](**parameters),
    )


def _plain(value: Any) -> Any:
    return value.item() if isinstance(value, np.generic) else value
