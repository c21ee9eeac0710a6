"""Drawings that are no plan of walls, recognised before the slow work."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import shapely
from numpy.typing import NDArray

from floorplans.errors import PlanError

MAX_CROSSINGS = 30_000
"""Most crossings of the lines of walls of a storey; walls mostly end on each other."""

_SAMPLE = 1000
"""So many lines are compared with all others."""


def check_crossings(segments: Mapping[str, NDArray[np.float64]]) -> None:
    """Reject lines that cross each other far more often than walls do.

    Parameters
    ----------
    segments : mapping of str to (n, 2, 2) float64
        Lines of walls by layer, or by another name for the message [m].

    Raises
    ------
    PlanError
        When there are more than about `MAX_CROSSINGS` crossings.
    """
    ends = np.concatenate([np.empty((0, 2, 2)), *segments.values()])
    lines = np.array(shapely.linestrings(ends), dtype=np.object_)
    layer = np.repeat(np.arange(len(segments)), [len(s) for s in segments.values()])
    sample = np.arange(0, len(lines), max(1, len(lines) // _SAMPLE))
    if len(sample) < 2:
        return
    first, _ = shapely.STRtree(lines).query(lines[sample], "crosses")
    crossings = len(first) * len(lines) / len(sample) / 2
    if crossings <= MAX_CROSSINGS:
        return
    most = list(segments)[int(np.bincount(layer[sample[first]]).argmax())]
    raise PlanError(
        f"the lines of walls cross each other about {_rounded(crossings)} times, far more often "
        f"than walls do, most often those of {most}: hatching, furniture or several drawings may "
        "lie there one over the other; leave it out, such as NAME=ignore, or save one storey",
        remedy="layers",
    )


def _rounded(number: float) -> str:
    """Write a number of three digits or more with two significant digits."""
    return f"{float(f'{number:.2g}'):,.0f}".replace(",", " ")
