"""Walls that nearly meet are joined.

Drawings are off by rounding, and sometimes by a little more. A wall end that stops within `NEAR_M`
short of another wall, or pokes through it by no more, is moved along its own wall onto the other
one, so no wall bends; for more than `COINCIDENT_M`, `SceneWarning` names both walls.
"""

import warnings
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
import shapely

from raytrace.arrays import Floats
from raytrace.errors import SceneWarning
from raytrace.geometry.sheets import COINCIDENT_M, Panel

TOUCHING_M = 1e-8
"""A wall end this near another wall meets it [m]: a rounding error."""

NEAR_M = 1e-3
"""A wall end this near another wall is moved onto it [m]."""

STEEP = 0.05
"""Walls that meet at a smaller sine count as parallel."""

MOST_LISTED = 5
"""Moved ends that a warning lists."""


class _Move(NamedTuple):
    """One end of a panel (0 start, 1 end), where it goes [m], and to which other panel."""

    panel: int
    side: int
    to: Floats
    other: int


def join_near_walls(panels: Sequence[Panel]) -> list[Panel]:
    """Move wall ends that nearly meet another wall onto it, with a warning."""
    joined = list(panels)
    moves = list(_moves(panels))
    for panel, side, to, _ in moves:
        joined[panel] = joined[panel]._replace(**{("start", "end")[side]: to})
    reported = [move for move in moves if _moved_by(panels, move) > COINCIDENT_M]
    if reported:
        warnings.warn(_sentence(panels, reported), SceneWarning, stacklevel=2)
    return joined


def _moves(panels: Sequence[Panel]) -> Iterator[_Move]:
    lines = [shapely.LineString([p.start, p.end]) for p in panels]
    tree = shapely.STRtree(lines)
    for k, panel in enumerate(panels):
        for side, end in enumerate((panel.start, panel.end)):
            tip = shapely.Point(end)
            near = [int(m) for m in tree.query(tip, "dwithin", NEAR_M) if m != k]
            if near and min(tip.distance(lines[m]) for m in near) > TOUCHING_M:
                places = [(_meeting(panel, end, panels[m]), m) for m in near]
                good = [(to, m) for to, m in places if to is not None]
                if good:
                    yield _Move(k, side, *min(good, key=lambda g: _length(g[0] - end)))


def _meeting(panel: Panel, end: Floats, other: Panel) -> Floats | None:
    """Where a panel's line meets another wall near its end; None where they do not."""
    if panel.plane == other.plane:
        return min((other.start, other.end), key=lambda p: _length(p - end))
    along, across = panel.end - panel.start, other.end - other.start
    turn = along[0] * across[1] - along[1] * across[0]
    sine = abs(turn) / (_length(along) * _length(across))
    if sine < STEEP:
        return None
    gap = other.start - panel.start
    to = panel.start + along * ((gap[0] * across[1] - gap[1] * across[0]) / turn)
    return to if _length(to - end) < 2.0 * NEAR_M / sine else None


def _length(vector: Floats) -> float:
    return float(np.hypot(vector[0], vector[1]))


def _sentence(panels: Sequence[Panel], moves: Sequence[_Move]) -> str:
    listed = "; ".join(_in_words(panels, move) for move in moves[:MOST_LISTED])
    more = f"; and {len(moves) - MOST_LISTED} more" if len(moves) > MOST_LISTED else ""
    what = "1 wall end" if len(moves) == 1 else f"{len(moves)} wall ends"
    return f"{what} within {NEAR_M * 1e3:g} mm of another wall moved onto it: {listed}{more}"


def _in_words(panels: Sequence[Panel], move: _Move) -> str:
    panel, other = panels[move.panel], panels[move.other]
    by_mm = 1e3 * _moved_by(panels, move)
    return (
        f"the wall {_ends(panel)} by {by_mm:.3g} mm at ({move.to[0]:g}, {move.to[1]:g}), "
        f"onto the wall {_ends(other)}"
    )


def _moved_by(panels: Sequence[Panel], move: _Move) -> float:
    panel = panels[move.panel]
    return _length(move.to - (panel.start, panel.end)[move.side])


def _ends(panel: Panel) -> str:
    (x1, y1), (x2, y2) = panel.start, panel.end
    return f"from ({x1:g}, {y1:g}) to ({x2:g}, {y2:g})"
