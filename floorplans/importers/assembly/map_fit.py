"""How well a plan fits the robot's map it was made from."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from floorplans.errors import PlanError
from floorplans.importers.assembly.building import Building
from floorplans.importers.known_pixels import KnownPixels
from floorplans.walls import centre_lines

MUCH = 0.05
"""Fraction of the free pixels outside the outline from which on the user is warned."""
HOPELESS = 0.5
"""Fraction of the free pixels, or of the occupied ones, from which on a map makes no plan."""
_MANY_CLOSURES = 0.1
"""Fraction of the outline without a wall in the map from which on the user is warned."""
_OFF_PX = 2.5
_PILLAR_M2 = 2.25
"""Largest area that walls enclose around an obstacle [m²]."""


@dataclass(frozen=True)
class Fit:
    """Sentences about the fit."""

    notes: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()


def fit_of(known: KnownPixels | None, building: Building) -> Fit:
    """Compare a building with the pixels of its map.

    Parameters
    ----------
    known : KnownPixels or None
        None gives no sentences.
    building : Building
        In the plan's coordinates.

    Raises
    ------
    PlanError
        When most of what the map shows is not in the building.
    """
    if known is None:
        return Fit()
    shift = np.array([building.origin.x, building.origin.y])
    away_m = _away_m(known.occupied - shift, building)
    in_no_wall = float((away_m > _OFF_PX * known.pixel_m).mean())
    outside = _outside(known.free - shift, building)
    _check(in_no_wall, outside, known)
    note = (
        f"of all occupied pixels, {100 * (1 - in_no_wall):.1f} % lie in a wall of the plan or "
        f"within {_OFF_PX * known.pixel_m:.3g} m of one, 90 % within "
        f"{np.percentile(away_m, 90):.2f} m"
    )
    return Fit((note,), tuple(_warnings(in_no_wall, outside, known, building)))


def _check(in_no_wall: float, outside: float, known: KnownPixels) -> None:
    """Reject a plan that has little in common with the map."""
    if outside > HOPELESS:
        raise PlanError(
            f"{100 * outside:.0f} % of the map's free pixels ({outside * known.area_m2:.3g} m² of "
            f"{known.area_m2:.3g} m²) lie outside every region that its walls and its border "
            "enclose; map the building to its walls, or draw the missing walls into the picture"
        )
    if in_no_wall > HOPELESS:
        raise PlanError(
            f"{100 * in_no_wall:.0f} % of the map's occupied pixels form no walls: noise, or "
            "another scale; clean the picture, or give the side of a pixel"
        )


def _warnings(
    in_no_wall: float, outside: float, known: KnownPixels, building: Building
) -> Iterator[str]:
    if outside > MUCH:
        yield (
            f"{100 * outside:.0f} % of the map's free pixels ({outside * known.area_m2:.3g} m² of "
            f"{known.area_m2:.3g} m²) lie outside the outline"
        )
    if in_no_wall > MUCH:
        yield f"{100 * in_no_wall:.0f} % of the map's occupied pixels are in no wall of the plan"
    edge_m = building.outline.length
    n_closed = sum(change.kind == "closed" for change in building.changes)
    if building.closed_m > _MANY_CLOSURES * edge_m:
        yield (
            f"the map shows no wall on {100 * building.closed_m / edge_m:.0f} % of the "
            f"outline ({building.closed_m:.3g} m of {edge_m:.3g} m, {n_closed} sections): "
            "doors that stood open, glass, or a map that is not finished"
        )


def _away_m(points: NDArray[np.float64], building: Building) -> NDArray[np.float64]:
    """Distance of points from the body of the nearest wall or pillar [m]."""
    half_m = np.array([wall.thickness_m / 2 for wall in building.walls])
    lines = centre_lines(building.walls)
    faces = np.array(shapely.get_parts(shapely.polygonize(shapely.get_parts(shapely.node(
        shapely.multilinestrings(list(lines)))))))  # fmt: skip
    pillars = faces[shapely.area(faces) <= _PILLAR_M2]
    bodies = np.concatenate([shapely.buffer(lines, half_m, cap_style="square"), pillars])
    nearest, away_m = shapely.STRtree(bodies).query_nearest(
        shapely.points(points), return_distance=True, all_matches=False
    )
    by_point = np.empty(len(points))
    by_point[nearest[0]] = away_m
    return by_point


def _outside(points: NDArray[np.float64], building: Building) -> float:
    """Fraction of points outside the outline; 0 without points."""
    if not len(points):
        return 0.0
    shapely.prepare(building.outline)
    return 1.0 - float(shapely.contains_xy(building.outline, points).mean())
