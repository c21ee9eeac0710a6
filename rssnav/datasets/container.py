"""All maps of a plan in one HDF5 file: the same bits for the same maps.

Layers have the dimensions preset, height, antenna, frequency, transmitter, y, x, each with a scale,
so that xarray opens the file with coordinates; a chunk is a map. No time stamps are stored.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from atomicfiles import atomic_write
from raytrace.results.checked_hdf5 import LARGEST, Checked, Hdf5ContentError, open_checked
from raytrace.results.hdf5 import hdf5_bytes
from raytrace.results.layers import LAYERS
from rssnav.datasets.errors import DatasetError
from rssnav.datasets.plan_maps import AXES, STORED, PlanMaps
from rssnav.datasets.strongest import PATH_ARRAYS, PATH_DIMENSIONS, PATH_LABELS, path_shapes

FORMAT = "rssnav data set plan"
GZIP_LEVEL = 4
_LARGEST32 = float(np.finfo(np.float32).max)
_POSITIVE = float(np.finfo(np.float64).tiny)

TEXTS = (
    "name", "split", "building", "source", "key", "plan_text", "plan_sha256", "configuration",
    "material_edition", "rssnav_version",
)  # fmt: skip
"""Attributes that are texts."""


@dataclass(frozen=True)
class About:
    """What a file says of its plan besides its maps.

    Attributes
    ----------
    name, split, building
        As of `rssnav.datasets.plans.PlanSource`.
    source
        Where the plan comes from, as JSON.
    key
        Hash of all that the maps depend on.
    plan_text, plan_sha256
        The plan.
    configuration
        What was traced, as JSON.
    material_edition, rssnav_version, tracer_version
        What made the maps.
    """

    name: str
    split: str
    building: str
    source: str
    key: str
    plan_text: str
    plan_sha256: str
    configuration: str
    material_edition: str
    rssnav_version: str
    tracer_version: int


def write_plan_file(maps: PlanMaps, about: About, path: Path) -> bytes:
    """Write a plan's maps, whole or not at all; return the content.

    Raises
    ------
    OSError
        Where it cannot be written.
    """
    content = hdf5_bytes(lambda file: _write(maps, about, file))
    with atomic_write(path) as temporary:
        temporary.write_bytes(content)
    return content


def _write(maps: PlanMaps, about: About, file: h5py.File) -> None:
    _write_scales(maps, file)
    height = AXES.index("height")
    names = (*AXES, "y", "x")
    for name, layer in maps.layers.items():
        _array(file, name, layer, (LAYERS[name].units, LAYERS[name].long_name), names)
    _write_path_scales(maps, file)
    for name, values in maps.paths.items():
        dimensions = PATH_DIMENSIONS.get(name, ("path",))
        _array(file, name, values, PATH_ARRAYS[name], (*names, *dimensions))
    inside = maps.inside.astype(np.int8)
    words = "1", "1 where the cell's centre is in the building"
    _array(file, "inside", inside, words, (AXES[height], "y", "x"))
    for k, axis in enumerate("xyz"):
        words = "m", f"{axis} of the transmitters"
        _array(file, f"transmitter_{axis}", maps.positions[:, k].copy(), words, ("transmitter",))
    file.attrs.update(
        format=FORMAT,
        format_version=1,
        cell_size_m=_cell_size_m(maps),
        transmitter_power_dbm=maps.power_dbm,
        tracer_version=about.tracer_version,
        **{name: getattr(about, name) for name in TEXTS},
    )


def _cell_size_m(maps: PlanMaps) -> float:
    axis = maps.x if len(maps.x) > 1 else maps.y
    return float(axis[1] - axis[0]) if len(axis) > 1 else 1.0


def _write_scales(maps: PlanMaps, file: h5py.File) -> None:
    """Write the scales of all dimensions but those of paths."""
    for name, values in (
        ("preset", maps.presets),
        ("antenna", maps.antennas),
        ("transmitter", maps.transmitters),
    ):
        scale = file.create_dataset(name, data=list(values), dtype=h5py.string_dtype())
        scale.attrs["long_name"] = f"name of the {name}"
        scale.make_scale(name)
    for name, values, units, long_name in (
        ("height", maps.heights_m, "m", "height of the receivers above the floor"),
        ("frequency", maps.frequencies_hz, "Hz", "carrier frequency"),
        ("y", maps.y, "m", "y of the cell centres"),
        ("x", maps.x, "m", "x of the cell centres"),
    ):
        scale = file.create_dataset(name, data=np.asarray(values, dtype=np.float64))
        scale.attrs.update(units=units, long_name=long_name)
        scale.make_scale(name)


def _write_path_scales(maps: PlanMaps, file: h5py.File) -> None:
    """Write the scales of the dimensions of paths, if there are any."""
    if not maps.paths:
        return
    n_paths, most = maps.paths["path_interactions"].shape[-2:]
    for name, count in (("path", n_paths), ("interaction", most)):
        scale = file.create_dataset(name, data=np.arange(count))
        scale.attrs.update(units="1", long_name=f"number of the {name}")
        scale.make_scale(name)
    for name, labels in PATH_LABELS.items():
        scale = file.create_dataset(name, data=list(labels), dtype=h5py.string_dtype())
        scale.make_scale(name)


def _array(
    file: h5py.File,
    name: str,
    values: NDArray[Any],
    words: tuple[str, str],
    dimensions: tuple[str, ...],
) -> None:
    """Write an array in chunks of a map, compressed and with checksums."""
    n_kinds = sum(dimension in AXES for dimension in dimensions)
    options: dict[str, Any] = {}
    if values.size and values.ndim > n_kinds:
        chunks = (*(1 for _ in range(n_kinds)), *values.shape[n_kinds:])
        options = {
            "chunks": chunks, "compression": "gzip", "compression_opts": GZIP_LEVEL,
            "shuffle": True, "fletcher32": True,
        }  # fmt: skip
    dataset = file.create_dataset(name, data=values, track_times=False, **options)
    dataset.attrs.update(units=words[0], long_name=words[1])
    for number, dimension in enumerate(dimensions):
        dataset.dims[number].attach_scale(file[dimension])
    file.flush()  # otherwise the place of its chunks depends on when Python drops the object


def read_plan_file(path: Path) -> tuple[PlanMaps, About]:
    """Read a plan's maps; nothing that the file says is believed before it is checked.

    Raises
    ------
    DatasetError
        Where it is missing, damaged, or something else.
    """
    try:
        with open_checked(path) as file:
            _check_format(file)
            return _read_maps(file), _read_about(file)
    except Hdf5ContentError as error:
        raise DatasetError(f"{error}; make the data set again to replace it", path) from error


def read_about(path: Path) -> About:
    """Read what a file says of its plan; see `read_plan_file`."""
    try:
        with open_checked(path) as file:
            _check_format(file)
            return _read_about(file)
    except Hdf5ContentError as error:
        raise DatasetError(f"{error}; make the data set again to replace it", path) from error


def _check_format(file: Checked) -> None:
    if "format" not in file.attribute_names or file.attribute("format") != FORMAT:
        raise Hdf5ContentError(f"expected an attribute format = {FORMAT!r}")
    if file.integer("format_version") != 1:
        raise Hdf5ContentError("attribute 'format_version': expected 1")


def _read_about(file: Checked) -> About:
    texts = {name: file.text(name) for name in TEXTS}
    return About(**texts, tracer_version=file.integer("tracer_version"))


def _read_maps(file: Checked) -> PlanMaps:
    names = {name: file.texts(name) for name in ("preset", "antenna", "transmitter")}
    for name, found in names.items():
        file.sizes[name] = len(found)
    heights, frequencies, y, x = (
        file.array(axis, np.float64, (axis,), low=low, high=LARGEST)
        for axis, low in (
            ("height", 0.0),
            ("frequency", _POSITIVE),
            ("y", -LARGEST),
            ("x", -LARGEST),
        )
    )
    shape = (*AXES, "y", "x")
    layers = {
        name: file.array(
            name, STORED.get(name, np.float32), shape, low=info.low, high=_in_float32(info.high)
        )
        for name, info in LAYERS.items()
        if name in file
    }
    positions = np.column_stack(
        [
            file.array(
                f"transmitter_{axis}", np.float64, ("transmitter",), low=-LARGEST, high=LARGEST
            )
            for axis in "xyz"
        ]
    )
    return PlanMaps(
        presets=names["preset"],
        heights_m=tuple(heights.tolist()),
        antennas=names["antenna"],
        frequencies_hz=tuple(frequencies.tolist()),
        transmitters=names["transmitter"],
        positions=positions,
        power_dbm=file.number("transmitter_power_dbm"),
        x=x,
        y=y,
        inside=file.array("inside", np.int8, ("height", "y", "x"), low=0, high=1) == 1,
        layers=layers,
        paths=_read_paths(file),
    )


def _in_float32(high: float) -> float:
    """Return a bound that numbers of single precision can be compared with."""
    return high if np.isinf(high) else min(high, _LARGEST32)


def _read_paths(file: Checked) -> dict[str, NDArray[Any]]:
    if "path_interactions" not in file:
        return {}
    lead = (*AXES, "y", "x")
    shape = (*lead, "path", "interaction")
    interactions = file.array("path_interactions", np.int8, shape, low=0, high=3)
    shapes = path_shapes(*interactions.shape[-2:])
    least = {"path_power_dbm": -np.inf}
    return {
        name: file.array(
            name, dtype, (*lead, *s), low=least.get(name, -_LARGEST32), high=_LARGEST32
        )
        for name, (s, dtype) in shapes.items()
    }
