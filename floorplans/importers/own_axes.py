"""A building that stands at an angle in its drawing is turned to its own axes.

Cells of a map and steps of a flight follow the axes of a plan, so they should follow the walls. The
plan keeps its place and rotation in the drawing (`floorplans.frame`), and exports undo them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TypeVar

import numpy as np
import shapely
from numpy.typing import NDArray

from floorplans.frame import PlanFrame, rotation
from floorplans.georeference import GeoOrigin
from floorplans.importers.draft import Draft, Origin, RawWall
from floorplans.importers.imported import ImportRecord
from floorplans.importers.original import Affine
from floorplans.repair.geometry import tidy_point
from floorplans.walls import Point

LEAST_DEG = 0.5
"""Walls within this of the drawing's axes are not turned [degrees]."""

_WINDOW_DEG = 2.0
_MAJORITY = 0.5
_DECIMALS = 6

Made = TypeVar("Made", bound=ImportRecord)


def oblique_deg(walls: Sequence[RawWall]) -> float:
    """Angle from the drawing's axes to those of most walls.

    Most walls by length, to within 2 degrees, must lie along two perpendicular directions; the
    angle is their median.

    Returns
    -------
    float
        In (-45, 45], counter-clockwise [degrees]; 0 for walls along the axes, and for those
        without such directions.
    """
    along = np.array([np.subtract(wall.end, wall.start) for wall in walls]).reshape(-1, 2)
    length_m = np.hypot(along[:, 0], along[:, 1])
    angle = np.degrees(np.arctan2(along[:, 1], along[:, 0])) % 90.0
    order = np.argsort(angle, kind="stable")
    angle, length_m = np.concatenate([angle[order], angle[order] + 90.0]), length_m[order]
    reached_m = np.concatenate([[0.0], np.cumsum(np.concatenate([length_m, length_m]))])
    begin = np.arange(len(length_m))
    end = np.searchsorted(angle, angle[begin] + _WINDOW_DEG, side="right")
    within_m = reached_m[end] - reached_m[begin]
    if not len(within_m) or within_m.max() <= _MAJORITY * length_m.sum():
        return 0.0
    best = int(within_m.argmax())
    middle_m = reached_m[best] + within_m[best] / 2
    found = float(angle[int(np.searchsorted(reached_m, middle_m)) - 1])
    turn = round((found + 45.0) % 90.0 - 45.0, _DECIMALS)
    return turn if abs(turn) >= LEAST_DEG else 0.0


def turned(draft: Draft, angle_deg: float) -> Draft:
    """Return a draft in axes that are turned counter-clockwise by an angle about its (0, 0)."""
    frame = PlanFrame(0.0, 0.0, angle_deg)

    def to(point: Point) -> Point:
        return tidy_point(*frame.to_plan(np.array([point]))[0])

    return replace(
        draft,
        walls=tuple(replace(w, start=to(w.start), end=to(w.end)) for w in draft.walls),
        openings=tuple(
            replace(
                opening,
                centre=to(opening.centre),
                direction=None if opening.direction is None else to(opening.direction),
            )
            for opening in draft.openings
        ),
        outline=None if draft.outline is None else shapely.transform(draft.outline, frame.to_plan),
        marks=draft.marks.moved(to),
        closed=tuple(shapely.transform(line, frame.to_plan) for line in draft.closed),
        known=None if draft.known is None else draft.known.moved(frame.to_plan),
        original=None if draft.original is None else draft.original.transformed(_affine(frame)),
    )


def _affine(frame: PlanFrame) -> Affine:
    """From the drawing to the plan, both with the same (0, 0)."""
    (a, b), (c, d) = rotation(-frame.rotation_deg).tolist()
    return ((a, b, 0.0), (c, d, 0.0))


def frame_in(imported: ImportRecord, draft: Draft, angle_deg: float) -> PlanFrame:
    """Position and rotation of a plan, made from a turned draft, in the draft as it was read."""
    if draft.origin is not None:
        return PlanFrame(0.0, 0.0, angle_deg)
    own = np.array([(imported.origin.x, imported.origin.y)])
    x, y = PlanFrame(0.0, 0.0, angle_deg).to_drawing(own)[0].tolist()
    return PlanFrame(x, y, angle_deg)


def placed(imported: Made, draft: Draft, angle_deg: float) -> Made:
    """Add to a plan its place in the drawing and on the Earth.

    Parameters
    ----------
    imported : Imported or DraftPlan
        Made from the turned draft.
    draft : Draft
        As it was read.
    angle_deg : float
        By which it was turned.
    """
    frame = frame_in(imported, draft, angle_deg)
    corner = np.array([frame.x_m, frame.y_m])
    plan = imported.plan
    if draft.georeference is not None:
        plan = replace(plan, origin=_moved(draft.georeference, corner, angle_deg))
    if not angle_deg:
        return replace(imported, plan=plan)
    x, y = (round(float(c), _DECIMALS + 3) for c in corner)
    origin = imported.origin if draft.origin else Origin(x, y, imported.origin.frame)
    note = (
        f"the walls stand at {angle_deg:g} degrees to the drawing's axes: the plan has axes along "
        "its walls, and exports are rotated back"
    )
    return replace(
        imported,
        plan=replace(plan, frame=PlanFrame(x, y, angle_deg)),
        origin=origin,
        notes=(*imported.notes, note),
    )


def _moved(georeference: GeoOrigin, corner: NDArray[np.float64], angle_deg: float) -> GeoOrigin:
    """Place on the Earth of other axes, whose (0, 0) is at a corner of the draft [m]."""
    longitude, latitude = georeference.longitude_deg, georeference.latitude_deg
    if corner.any():
        longitude, latitude = georeference.to_degrees(corner[None])[0].tolist()
    rotation_deg = georeference.rotation_deg + angle_deg
    if abs(rotation_deg) > 180.0:
        rotation_deg -= float(np.copysign(360.0, rotation_deg))
    return GeoOrigin(longitude, latitude, rotation_deg)
