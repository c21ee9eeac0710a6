"""Many maps on one picture."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from atomicfiles import atomic_write
from rssnav.datasets.container import read_plan_file
from rssnav.datasets.errors import DatasetError
from rssnav.datasets.folder import MANIFEST
from rssnav.datasets.manifest import read_manifest

COLUMNS = 5
INCHES = 2.2
SPAN_DB = 80.0


def draw_sheet(
    folder: Path, path: Path, *, count: int, layer: str = "rss_dbm", split: str | None = None
) -> int:
    """Draw maps that are spread evenly over a data set; return how many.

    Parameters
    ----------
    folder
        Of the data set.
    path
        The picture.
    count
        Most maps.
    layer
        What is drawn.
    split
        Of these maps only.

    Raises
    ------
    DatasetError
        Where there are none, or they do not have the layer.
    """
    rows: list[dict[str, Any]] = read_manifest(folder / MANIFEST).to_pylist()
    rows = [row for row in rows if split in (None, row["split"])]
    if not rows:
        raise DatasetError("no maps to draw: the split is empty", folder)
    chosen = [rows[int(k)] for k in np.unique(np.linspace(0, len(rows) - 1, count).astype(int))]
    n_rows = -(-len(chosen) // COLUMNS)
    figure = Figure(figsize=(INCHES * COLUMNS, INCHES * n_rows), layout="constrained")
    axes = np.atleast_1d(figure.subplots(n_rows, COLUMNS, squeeze=False)).ravel()
    for panel in axes:
        panel.axis("off")
    for panel, row in zip(axes, chosen, strict=False):
        _draw(panel, folder, row, layer)
    with atomic_write(path) as temporary:
        figure.savefig(temporary, dpi=150)
    return len(chosen)


def _draw(panel: Any, folder: Path, row: dict[str, Any], layer: str) -> None:
    maps, _ = read_plan_file(folder / row["file"])
    if layer not in maps.layers:
        known = ", ".join(maps.layers)
        raise DatasetError(f"no layer {layer!r}: expected one of {known}", folder / row["file"])
    index = tuple(int(row[f"index_{axis}"]) for axis in
                  ("preset", "height", "antenna", "frequency", "transmitter"))  # fmt: skip
    values = maps.layers[layer][index]
    shown = np.where(np.isfinite(values) & maps.inside[index[1]], values, np.nan)
    most = float(np.nanmax(shown)) if np.isfinite(shown).any() else 0.0
    low = most - SPAN_DB if layer.endswith("_dbm") else None
    half = 0.5 * (maps.x[1] - maps.x[0] if len(maps.x) > 1 else 1.0)
    extent = (maps.x[0] - half, maps.x[-1] + half, maps.y[0] - half, maps.y[-1] + half)
    panel.imshow(shown, origin="lower", extent=extent, vmin=low, vmax=most, cmap="viridis")
    panel.plot(row["transmitter_x"], row["transmitter_y"], "r*", markersize=6)
    title = f"{row['plan']} {row['transmitter']} {row['frequency_hz'] / 1e9:g} GHz"
    panel.set_title(title, fontsize=6)
