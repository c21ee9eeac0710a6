"""Interrupted lines of pixels, joined along the building's directions.

A wall that a laser hardly sees, from afar or at a small angle, is a row of short dashes one pixel
wide. Dashes in a row belong together where most of the row is occupied.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Mask = NDArray[np.bool_]

GAPS_M = (0.2, 0.5)
"""Widths of gaps in a row that are closed [m]: narrower ones are noise, wider ones doors."""
_LEAST_ROW_M = 1.0
_LEAST_FILLED = 0.5
_ROW_PX = 3.0
_SAMPLED = 20_000


def bridged(occupied: Mask, pixel_m: float) -> Mask:
    """Close the gaps of interrupted lines.

    Parameters
    ----------
    occupied : (n_y, n_x) bool
    pixel_m : float
        Side of a pixel [m].

    Returns
    -------
    (n_y, n_x) bool
    """
    pixels = np.argwhere(occupied)[:, ::-1].astype(np.float64)
    joined = occupied.copy()
    if not len(pixels):
        return joined
    angle = _main_direction(pixels)
    for turned in (angle, angle + np.pi / 2):
        for offset_px in (0.0, _ROW_PX / 2):
            points = _between(pixels, turned, offset_px, pixel_m)
            columns, rows = np.rint(points).astype(np.int64).T
            joined[rows.clip(0, len(occupied) - 1), columns.clip(0, occupied.shape[1] - 1)] = True
    return joined


def _main_direction(pixels: NDArray[np.float64]) -> float:
    """Angle [rad] of the axes along which most pixels lie in common rows."""
    some = pixels[:: max(1, len(pixels) // _SAMPLED)]
    angles = np.radians(np.arange(0.0, 90.0, 1.0))

    def in_rows(angle: float) -> float:
        along = some @ np.array([np.cos(angle), np.sin(angle)])
        across = some @ np.array([-np.sin(angle), np.cos(angle)])
        rows = (np.rint(values - values.min()).astype(np.int64) for values in (along, across))
        return float(sum(np.sum(np.bincount(row) ** 2) for row in rows))

    return float(max(angles, key=in_rows))


def _between(
    pixels: NDArray[np.float64], angle: float, offset_px: float, pixel_m: float
) -> NDArray[np.float64]:
    """Points (n, 2) in the gaps of the mostly occupied rows of a direction [pixels]."""
    along, across = (
        np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]]) @ pixels.T
    )
    row = np.floor((across + offset_px) / _ROW_PX).astype(np.int64)
    order = np.lexsort((along, row))
    row, s = row[order], along[order]
    step = np.diff(s)
    apart = (np.diff(row) != 0) | (step * pixel_m > GAPS_M[1] + pixel_m)
    run = np.concatenate([[0], np.cumsum(apart)])
    first = np.flatnonzero(np.concatenate([[True], apart]))
    last = np.concatenate([first[1:], [len(s)]]) - 1
    length_px = s[last] - s[first] + 1.0
    new_px = np.concatenate([[1.0], np.where(apart, 1.0, np.minimum(step, 1.0))])
    n_occupied = np.bincount(run, new_px)
    is_line = (length_px * pixel_m >= _LEAST_ROW_M) & (n_occupied >= _LEAST_FILLED * length_px)
    gaps = np.flatnonzero(~apart & (step * pixel_m > GAPS_M[0]) & is_line[run[:-1]])
    parts = [
        np.linspace(pixels[order[k]], pixels[order[k + 1]], int(np.ceil(step[k])) + 1)[1:-1]
        for k in gaps.tolist()
    ]
    return np.concatenate([np.empty((0, 2)), *parts])
