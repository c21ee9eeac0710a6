"""The layout of the First Indoor Pathloss Radio Map Prediction Challenge (ICASSP 2025).

Images are named ``B1_Ant1_f1_S0.png`` by building, antenna, frequency and transmitter. Those in
``Inputs/Task_1_ICASSP`` hold in red the reflection loss of walls at normal incidence [dB], in green
their transmission loss [dB], both 0 where there is no wall, and in blue the distance from the
transmitter [m]. Those in ``Outputs/Task_1_ICASSP`` hold the path loss [dB]. All are rounded and at
most 255. A pixel is a cell, row 0 at the smallest y. ``Positions`` has the pixels of transmitters.
"""

from __future__ import annotations

import csv
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
import shapely
from PIL import Image

import floorplans
from floorplans import FloorPlan
from floorplans.walls import panels
from raytrace.arrays import Floats
from rssnav.datasets.errors import DatasetError
from rssnav.datasets.exporters.pieces import PlanPiece, index_of, new_folder, plan_pieces
from rssnav.datasets.plan_maps import MapIndex
from rssnav.progress import Progress
from rssnav.scenes import slab_of

TASK = "Task_1_ICASSP"
LARGEST = 255
"""Largest value of a pixel; a path loss of this or more, or no path."""

Pixels = list[tuple[int, float, float]]
"""Sample, and the transmitter's column and row."""


def export_challenge(folder: Path, out: Path, n_plans: int, progress: Progress) -> None:
    """Write a data set in the layout of the challenge.

    Parameters
    ----------
    folder, out
        The data set, and the folder to be made.
    n_plans, progress
        For progress.

    Raises
    ------
    DatasetError
        Where RSS is not kept, or there are several presets, heights or cell sizes.
    """
    with new_folder(out) as new:
        for part in (f"Inputs/{TASK}", f"Outputs/{TASK}", "Positions", "Building_Details"):
            (new / part).mkdir(parents=True)
        for piece in plan_pieces(folder):
            _check(piece, folder)
            _write_plan(piece, new)
            progress(piece.number + 1, n_plans)


def _check(piece: PlanPiece, folder: Path) -> None:
    if "rss_dbm" not in piece.maps.layers:
        raise DatasetError("rss_dbm is not kept: expected it among the layers of the spec", folder)
    if len(piece.maps.presets) > 1 or len(piece.maps.heights_m) > 1:
        raise DatasetError(
            "several presets or heights: the layout names buildings, antennas, frequencies and "
            "samples only",
            folder,
        )


def _write_plan(piece: PlanPiece, out: Path) -> None:
    maps = piece.maps
    plan = floorplans.loads(piece.about.plan_text)
    losses = {
        number: wall_losses(plan, maps.x, maps.y, maps.heights_m[0], frequency_hz)
        for number, frequency_hz in enumerate(maps.frequencies_hz)
    }
    positions: dict[str, Pixels] = {}
    for row in piece.rows:
        index = index_of(row)
        series = f"B{piece.number + 1}_Ant{index.antenna + 1}_f{index.frequency + 1}"
        name = f"{series}_S{index.transmitter}.png"
        x, y, _ = maps.positions[index.transmitter]
        distance = np.hypot(maps.x - x, (maps.y - y)[:, None])
        layers = (*losses[index.frequency], distance)
        _save(np.stack(layers, axis=-1), out / "Inputs" / TASK / name)
        _save(_path_loss(piece, index), out / "Outputs" / TASK / name)
        pixel = (x - maps.x[0]) / _cell_m(maps.x), (y - maps.y[0]) / _cell_m(maps.y)
        positions.setdefault(series, []).append((index.transmitter, *pixel))
    for series, pixels in positions.items():
        rows = [(k, round(column), round(line), 0) for k, column, line in pixels]
        _write_csv(out / "Positions" / f"Positions_{series}.csv", ("", "X", "Y", "Azimuth"), rows)
    _write_csv(
        out / "Building_Details" / f"B{piece.number + 1}_Details.csv",
        ("W", "H", "plan", "split", "cell_size_m"),
        [(len(maps.x), len(maps.y), piece.about.name, piece.about.split, _cell_m(maps.x))],
    )


def _cell_m(axis: Floats) -> float:
    return float(axis[1] - axis[0]) if len(axis) > 1 else 1.0


def _path_loss(piece: PlanPiece, index: MapIndex) -> Floats:
    rss = piece.maps.layers["rss_dbm"][index].astype(np.float64)
    return np.where(np.isfinite(rss), piece.maps.power_dbm - rss, LARGEST)


def wall_losses(
    plan: FloorPlan, x: Floats, y: Floats, height_m: float, frequency_hz: float
) -> tuple[Floats, Floats]:
    """Return the reflection and the transmission loss of walls [dB], as images (n_y, n_x).

    A wall covers the cells that its centre line passes through at a height [m].
    """
    reflection, transmission = np.zeros((len(y), len(x))), np.zeros((len(y), len(x)))
    half_x, half_y = _cell_m(x) / 2, _cell_m(y) / 2
    xx, yy = np.meshgrid(x, y)
    cells = shapely.box(xx - half_x, yy - half_y, xx + half_x, yy + half_y).ravel()
    tree = shapely.STRtree(cells)
    for line, material, thickness_m in _sheets_at(plan, height_m):
        found = slab_of(plan, material, thickness_m)
        r, t = _losses_db(found.material.coefficients(thickness_m, frequency_hz, np.ones(1)))
        covered = tree.query(line, predicate="intersects")
        reflection.ravel()[covered] = np.maximum(reflection.ravel()[covered], r)
        transmission.ravel()[covered] = np.maximum(transmission.ravel()[covered], t)
    return reflection, transmission


def _losses_db(coefficients: object) -> tuple[float, float]:
    """Losses of a slab at normal incidence [dB]."""
    found = (abs(getattr(coefficients, name)[0]) for name in ("r_te", "t_te"))
    r, t = (min(-20.0 * np.log10(max(value, 1e-30)), float(LARGEST)) for value in found)
    return float(r), float(t)


def _sheets_at(plan: FloorPlan, height_m: float) -> Iterator[tuple[shapely.LineString, str, float]]:
    """Yield the solid pieces of walls at a height, their materials and thicknesses [m]."""
    for wall in plan.walls:
        for panel in panels(wall):
            if panel.z_min <= height_m < panel.z_max:
                ends = [wall.point_at(panel.s_min), wall.point_at(panel.s_max)]
                yield shapely.LineString(ends), panel.material, panel.thickness_m


def _save(values: Floats, path: Path) -> None:
    Image.fromarray(np.clip(np.rint(values), 0, LARGEST).astype(np.uint8)).save(path)


def _write_csv(path: Path, heading: tuple[str, ...], rows: Sequence[tuple[object, ...]]) -> None:
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(heading)
        writer.writerows(rows)
