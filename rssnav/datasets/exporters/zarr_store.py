"""A data set as a Zarr v3 store: a group for each plan, below its split."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from raytrace.extras import needs_extra
from raytrace.results.layers import LAYERS
from rssnav.datasets.container import TEXTS
from rssnav.datasets.exporters.pieces import PlanPiece, new_folder, plan_pieces
from rssnav.datasets.plan_maps import AXES
from rssnav.datasets.strongest import PATH_ARRAYS, PATH_DIMENSIONS
from rssnav.progress import Progress


def export_zarr(folder: Path, out: Path, n_plans: int, progress: Progress) -> None:
    """Write a data set as a Zarr store; parameters as of `export_challenge`.

    Raises
    ------
    ImportError
        Without zarr; names the extra.
    """
    with needs_extra("zarr"):
        import zarr

    with new_folder(out) as new:
        root: Any = zarr.open_group(str(new), mode="w", zarr_format=3)
        for piece in plan_pieces(folder):
            name = f"{piece.about.split}/{piece.about.name}"
            _write_plan(root.create_group(name), piece)
            progress(piece.number + 1, n_plans)


def _write_plan(group: Any, piece: PlanPiece) -> None:
    maps = piece.maps
    group.attrs.update({name: getattr(piece.about, name) for name in TEXTS})
    group.attrs.update(
        {
            "transmitter_power_dbm": maps.power_dbm,
            "preset": list(maps.presets),
            "antenna": list(maps.antennas),
            "transmitter": list(maps.transmitters),
        }
    )
    for name, values, units in (
        ("height", np.array(maps.heights_m), "m"),
        ("frequency", np.array(maps.frequencies_hz), "Hz"),
        ("y", maps.y, "m"),
        ("x", maps.x, "m"),
    ):
        _array(group, name, values, (name,), units, values.shape)
    _array(
        group, "transmitter_position", maps.positions, ("transmitter", "axis"), "m",
        maps.positions.shape,
    )  # fmt: skip
    inside = maps.inside.astype(np.int8)
    _array(group, "inside", inside, ("height", "y", "x"), "1", inside.shape)
    single = (1,) * len(AXES)
    for name, layer in maps.layers.items():
        chunk = (*single, *layer.shape[len(AXES) :])
        _array(group, name, layer, (*AXES, "y", "x"), LAYERS[name].units, chunk)
    for name, values in maps.paths.items():
        chunk = (*single, *values.shape[len(AXES) :])
        dimensions = (*AXES, "y", "x", *PATH_DIMENSIONS.get(name, ("path",)))
        _array(group, name, values, dimensions, PATH_ARRAYS[name][0], chunk)


def _array(
    group: Any,
    name: str,
    values: NDArray[Any],
    dimensions: tuple[str, ...],
    units: str,
    chunk: tuple[int, ...],
) -> None:
    """Write an array in chunks of a map."""
    array = group.create_array(
        name, shape=values.shape, dtype=values.dtype, chunks=chunk, dimension_names=dimensions
    )
    array[...] = values
    array.attrs["units"] = units
