"""A floor plan drawn with characters, for a terminal."""

import shutil
import sys

import numpy as np
from numpy.typing import NDArray

from floorplans import FloorPlan

DOTS_ACROSS, DOTS_DOWN = 2, 4
"""Dots of a braille character."""

DOT_BITS = np.array([[0x01, 0x08], [0x02, 0x10], [0x04, 0x20], [0x40, 0x80]])
BRAILLE = 0x2800
SKETCH_HEIGHT_M = 1.0
MAX_COLUMNS = 120


def sketch(plan: FloorPlan, columns: int | None = None) -> str:
    """Draw what is solid 1 m above the floor, with T, S and U at transmitters, source and start.

    Parameters
    ----------
    plan : FloorPlan
    columns : int, optional
        Width [characters]; that of the terminal, up to 120, by default.

    Returns
    -------
    str
        Lines of braille patterns, or of "#" where standard output cannot write them.
    """
    x_min, y_min, x_max, y_max = plan.bounds
    n_columns = columns or min(shutil.get_terminal_size().columns, MAX_COLUMNS)
    dots_per_m = (DOTS_ACROSS * n_columns - 1) / (x_max - x_min)
    n_rows = int((y_max - y_min) * dots_per_m) // DOTS_DOWN + 1
    dots = np.zeros((DOTS_DOWN * n_rows, DOTS_ACROSS * n_columns), dtype=np.bool_)

    def dot_of(points: NDArray[np.float64]) -> NDArray[np.int64]:
        """Row and column of the dots at points (n, 2) [m]."""
        row = (y_max - points[:, 1]) * dots_per_m
        column = (points[:, 0] - x_min) * dots_per_m
        return np.rint(np.column_stack([row, column])).astype(np.int64)

    for start, end in plan.solid_segments(min(SKETCH_HEIGHT_M, 0.5 * plan.height_m)):
        n_points = int(2.0 * dots_per_m * np.hypot(*(end - start))) + 2
        line = dot_of(np.linspace(start, end, n_points))
        inside = np.minimum(line, np.array(dots.shape) - 1)
        dots[inside[:, 0], inside[:, 1]] = True
    characters = _characters(dots)
    marks = _marks(plan)
    for mark, _, point in marks:
        row, column = dot_of(np.array([point]))[0]
        characters[row // DOTS_DOWN][column // DOTS_ACROSS] = mark
    legend = ", ".join(dict.fromkeys(f"{mark} {meaning}" for mark, meaning, _ in marks))
    return "\n".join(["".join(line).rstrip() for line in characters] + [legend])


def _marks(plan: FloorPlan) -> list[tuple[str, str, tuple[float, float]]]:
    """Letter, meaning and place (x, y) [m] of transmitters, source and start; the last on top."""
    marks = [("T", "transmitter", t.position[:2]) for t in plan.transmitters]
    if plan.source is not None:
        marks.append(("S", "source", plan.source[:2]))
    if plan.start is not None:
        marks.append(("U", "where the UAV starts", plan.start))
    return marks


def _characters(dots: NDArray[np.bool_]) -> list[list[str]]:
    """Gather dots (rows, columns) into lines of characters."""
    rows, columns = dots.shape
    blocks = dots.reshape(rows // DOTS_DOWN, DOTS_DOWN, columns // DOTS_ACROSS, DOTS_ACROSS)
    codes = np.einsum("iajb,ab->ij", blocks, DOT_BITS)
    braille = "utf" in (sys.stdout.encoding or "").lower()
    return [
        [" " if code == 0 else chr(BRAILLE + code) if braille else "#" for code in line]
        for line in codes.tolist()
    ]
