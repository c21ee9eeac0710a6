"""Radio maps of several transmitters in one HDF5 file.

The format is that of one map (`raytrace.results.map_file`) with `format_version` 2: layers have the
dimension `transmitter` before `y` and `x`, whose scale holds the names. Datasets over it hold the
positions, powers and frequencies, and the index of the antenna within the group `antennas`.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from atomicfiles import atomic_write
from raytrace.radio.antennas import Antenna
from raytrace.radio.transmitter import Transmitter
from raytrace.results.antenna_file import (
    RECEIVE,
    TRANSMIT,
    antenna_attributes,
    as_stored,
    read_antenna,
    write_pattern,
)
from raytrace.results.checked_hdf5 import LARGEST, MAX_TEXTS, Checked, Hdf5ContentError
from raytrace.results.hdf5 import hdf5_bytes, write_array
from raytrace.results.map_file import (
    SEVERAL_VERSION,
    MapContents,
    check_layers,
    common_attributes,
    read_checked,
    read_common,
    read_grid,
    read_layers,
    write_layers,
)

NAMES = "transmitter"
ANTENNAS, ANTENNA = "antennas", "antenna"

_OVER_TRANSMITTERS = {
    "transmitter_x": ("m", "x of the transmitters"),
    "transmitter_y": ("m", "y of the transmitters"),
    "transmitter_z": ("m", "height of the transmitters above the floor"),
    "transmitter_power_dbm": ("dBm", "power fed to the antennas"),
    "frequency_hz": ("Hz", "carrier frequency"),
}


def coordinates_of(
    maps: Mapping[str, MapContents],
) -> dict[str, tuple[NDArray[np.float64], str, str]]:
    """Return values (n,), units and descriptions of what maps hold of their transmitters."""
    rows = np.array(
        [
            (*t.position, t.power_dbm, t.frequency_hz)
            for t in (radio_map.transmitter for radio_map in maps.values())
        ]
    )
    columns = zip(_OVER_TRANSMITTERS.items(), rows.T, strict=True)
    return {name: (values, *words) for (name, words), values in columns}


def attributes_of_several(radio_map: MapContents) -> dict[str, Any]:
    """Return what made maps of several transmitters, given one of them."""
    return {**common_attributes(radio_map), "format_version": SEVERAL_VERSION}


def write_transmitter_file(maps: Mapping[str, MapContents], path: Path) -> None:
    """Write maps that belong together; an interrupted write leaves the old file or none.

    Raises
    ------
    ValueError
        For more than `MAX_TEXTS` transmitters.
    """
    if len(maps) > MAX_TEXTS:
        raise ValueError(f"{len(maps)} transmitters: expected at most {MAX_TEXTS} in a file")
    content = hdf5_bytes(lambda file: _write(maps, file))
    with atomic_write(path) as temporary:
        temporary.write_bytes(content)


def _write(maps: Mapping[str, MapContents], file: h5py.File) -> None:
    first = next(iter(maps.values()))
    names = file.create_dataset(NAMES, data=list(maps), dtype=h5py.string_dtype())
    names.attrs["long_name"] = "name of the transmitter"
    names.make_scale(NAMES)
    layers = {
        name: np.stack([radio_map.layers[name] for radio_map in maps.values()])
        for name in first.layers
    }
    write_layers(file, first.grid, layers, NAMES)
    antennas = [as_stored(radio_map.transmitter.antenna) for radio_map in maps.values()]
    different = _different(antennas)
    numbers = np.array([different.index(antenna) for antenna in antennas])
    over = coordinates_of(maps) | {ANTENNA: (numbers, "1", "index within the group antennas")}
    for name, (values, units, long_name) in over.items():
        write_array(file, name, values, units, long_name).dims[0].attach_scale(file[NAMES])
    for number, antenna in enumerate(different):
        group = file.require_group(f"{ANTENNAS}/{number}")
        group.attrs.update(antenna_attributes(TRANSMIT, antenna))
        write_pattern(antenna, group, TRANSMIT)
    file.attrs.update(attributes_of_several(first))
    write_pattern(first.receive_antenna, file, RECEIVE)


def _different(antennas: list[Antenna]) -> list[Antenna]:
    """Antennas, each once."""
    found: list[Antenna] = []
    for antenna in antennas:
        if antenna not in found:
            found.append(antenna)
    return found


def read_transmitter_file(path: Path) -> dict[str, dict[str, Any]]:
    """Read maps of several transmitters: the fields of `RadioMap` by name, for each name.

    Raises
    ------
    MissingMapError, MapFileError
        As of `raytrace.results.map_file.read_map_file`.
    """
    return read_checked(path, SEVERAL_VERSION, _read)


def _read(file: Checked) -> dict[str, dict[str, Any]]:
    names = file.texts(NAMES)
    if not names or len(set(names)) < len(names) or not all(names):
        raise Hdf5ContentError(
            f"dataset {NAMES!r}: expected names, at least one and no two the same"
        )
    file.sizes["n_transmitters"] = len(names)
    grid, common = read_grid(file), read_common(file)
    layers = read_layers(file, ("n_transmitters", "n_y", "n_x"))
    transmitters = _transmitters(file)
    found: dict[str, dict[str, Any]] = {}
    for k, (name, transmitter) in enumerate(zip(names, transmitters, strict=True)):
        of_one = {layer: values[k] for layer, values in layers.items()}
        check_layers(of_one, grid, transmitter)
        found[name] = {"grid": grid, **common, "transmitter": transmitter, **of_one}
    return found


def _transmitters(file: Checked) -> list[Transmitter]:
    least = {"frequency_hz": float(np.finfo(np.float64).tiny)}
    columns = [
        file.array(
            name, np.float64, ("n_transmitters",), low=least.get(name, -LARGEST), high=LARGEST
        ).tolist()
        for name in _OVER_TRANSMITTERS
    ]
    antennas = _antennas(file)
    numbers = file.array(ANTENNA, np.int64, ("n_transmitters",), low=0, high=len(antennas) - 1)
    rows = zip(*columns, numbers.tolist(), strict=True)
    return [
        Transmitter((x, y, z), power_dbm, frequency_hz, antennas[number])
        for x, y, z, power_dbm, frequency_hz, number in rows
    ]


def _antennas(file: Checked) -> list[Antenna]:
    group = file.within(ANTENNAS)
    names = group.names
    if not names or len(names) > MAX_TEXTS or set(names) != set(map(str, range(len(names)))):
        raise Hdf5ContentError(
            f"group {ANTENNAS!r}: expected 1 to {MAX_TEXTS} antennas with the names 0, 1, ..."
        )
    return [read_antenna(Checked(group.within(str(k)).group), TRANSMIT) for k in range(len(names))]
