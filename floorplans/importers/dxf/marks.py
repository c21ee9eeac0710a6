"""Source, start and transmitters of a drawing that was exported from a plan."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import isfinite
from typing import TYPE_CHECKING

from floorplans.importers.draft import LayerUse
from floorplans.importers.marks import Marks, Position

if TYPE_CHECKING:
    from ezdxf.document import Drawing as Document

SOURCE, TRANSMITTER, START = "SOURCE", "TRANSMITTER", "START"
"""Layers of the points that an export writes."""


def marks_of(document: Document, unit_m: float) -> Marks:
    """Read the points on the layers of an export.

    Parameters
    ----------
    document : ezdxf.document.Drawing
    unit_m : float
        Of its coordinates [m].

    Returns
    -------
    Marks
        None in a drawing without all of the layers, which others made; of several sources or
        starts the first.
    """
    names = (SOURCE, TRANSMITTER, START)
    if not {layer.dxf.name for layer in document.layers} >= set(names):
        return Marks()
    places: dict[str, list[Position]] = {name: [] for name in names}
    for point in document.modelspace().query("POINT"):
        x, y, z = (float(value) * unit_m for value in point.dxf.location)
        if point.dxf.layer in places and isfinite(x + y + z):
            places[point.dxf.layer].append((x, y, z))
    source, start = (next(iter(places[name]), None) for name in (SOURCE, START))
    return Marks(source, None if start is None else start[:2], tuple(places[TRANSMITTER]))


def with_marks(uses: Sequence[LayerUse], marks: Marks) -> tuple[LayerUse, ...]:
    """Say what became of the layers of places."""
    became = {SOURCE: marks.source, START: marks.start, TRANSMITTER: marks.transmitters}
    return tuple(
        replace(use, became=f"{use.name.lower()} of the plan") if became.get(use.name) else use
        for use in uses
    )
