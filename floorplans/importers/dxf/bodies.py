"""Bodies of walls: closed outlines and fills thin enough for a wall; wider fills are floors."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import LinearRing, LineString, Polygon
from shapely.geometry.base import BaseGeometry

from floorplans.importers.centrelines.areas import MAX_HEAVY_M, MAX_THICKNESS_M
from floorplans.importers.centrelines.parallel_lines import MIN_THICKNESS_M
from floorplans.importers.dxf.curves import Curve
from floorplans.importers.dxf.drawing import Content
from floorplans.importers.dxf.layers import Layers

_OUTLINED = 0.8
"""Fraction of the fills from which on a drawing shows the outlines of what it fills."""
_BARE = 0.1
"""Fraction of a fill within outlines of walls, up to which it has no outline."""
_THIN_M = 0.6
"""A fill as thin may be a wall whose outline is open [m]."""


def corners_of(curve: Curve) -> NDArray[np.float64]:
    """Corners of a chain, of a closed one with the first again at its end, (n, 2)."""
    return np.array([*curve.points, *curve.points[: curve.closed]])


def thin_bodies(chains: Sequence[Curve]) -> tuple[list[Polygon], NDArray[np.float64]]:
    """Closed chains thin enough to be walls, and the segments of the others, (n, 2, 2)."""
    area: list[Polygon] = []
    segments: list[NDArray[np.float64]] = []
    for chain in chains:
        points = corners_of(chain)
        body = _body(chain, points)
        if body is not None and (_is_heavy(body) if chain.filled else _is_thin(body)):
            area += [part for part in shapely.get_parts(body) if isinstance(part, Polygon)]
        elif not chain.filled:
            segments.append(np.stack([points[:-1], points[1:]], axis=1))
    return area, np.concatenate(segments) if segments else np.empty((0, 2, 2))


def without_floors(content: Content, layers: Layers) -> tuple[Content, tuple[str, ...]]:
    """Leave out fills on the layers of walls that are floors.

    They are wider than heavy masonry, or no outline of a wall encloses them in a drawing that shows
    the outlines of what it fills.

    Parameters
    ----------
    content : Content
        In metres.
    layers : Layers

    Returns
    -------
    Content
    tuple of str
        A sentence for each layer that has some.
    """
    names = layers.of("wall")
    fills = [
        (name, curve, body)
        for name in names
        for curve in content.curves[name]
        if curve.filled and (body := _body(curve, corners_of(curve))) is not None and body.area > 0
    ]
    is_bare = _without_outline([body for _, _, body in fills], _outlines(content, names))
    floors: dict[str, list[tuple[Curve, BaseGeometry]]] = {}
    for (name, curve, body), bare in zip(fills, is_bare, strict=True):
        if bare or not _is_heavy(body):
            floors.setdefault(name, []).append((curve, body))
    if not floors:
        return content, ()
    kept, left_out = content.curves.copy(), content.left_out.copy()
    for name, found in floors.items():
        out = {id(curve) for curve, _ in found}
        kept[name] = [curve for curve in kept[name] if id(curve) not in out]
        left_out[name] = [*left_out[name], *(curve for curve, _ in found)]
    notes = [_floor_note(name, [body for _, body in found]) for name, found in floors.items()]
    return replace(content, curves=kept, left_out=left_out), tuple(notes)


def _outlines(content: Content, names: Sequence[str]) -> BaseGeometry:
    """Area within the closed outlines of walls, without fills."""
    chains = [curve for name in names for curve in content.curves[name] if not curve.filled]
    return shapely.union_all(thin_bodies(chains)[0])


def _without_outline(fills: Sequence[BaseGeometry], outlines: BaseGeometry) -> list[bool]:
    """Which wide fills lie in no outline of a wall, in a drawing where nearly all others do."""
    covered = np.array([fill.intersection(outlines).area / fill.area for fill in fills])
    if not np.mean(covered > 1 - _BARE if len(covered) else 0.0) > _OUTLINED:
        return [False] * len(fills)
    return [
        bool(share < _BARE) and not fill.buffer(-_THIN_M / 2).is_empty
        for fill, share in zip(fills, covered, strict=True)
    ]


def _floor_note(layer: str, floors: Sequence[BaseGeometry]) -> str:
    largest = max(floors, key=lambda body: body.area)
    x, y = largest.representative_point().coords[0]
    return (
        f"layer {layer}: {len(floors)} filled area{'s' * (len(floors) > 1)} left out, wider than "
        f"{MAX_HEAVY_M:g} m or outside the outlines of walls, and so taken for floors; the largest "
        f"has {largest.area:.3g} m² around ({x:.2f}, {y:.2f}) of the drawing, in metres"
    )


def _body(chain: Curve, points: NDArray[np.float64]) -> BaseGeometry | None:
    """Area that a chain encloses, or covers as a wide line; None if it does neither."""
    if chain.width >= MIN_THICKNESS_M:
        wide = LineString(points) if not chain.closed else LinearRing(chain.points)
        return wide.buffer(chain.width / 2, cap_style="flat", join_style="mitre")
    if not chain.closed or len(points) <= 3:
        return None
    whole = shapely.make_valid(Polygon(points))
    if not chain.holes or _is_thin(whole):
        return whole  # holes in a wall are shafts and niches, which a plan cannot show
    return shapely.make_valid(Polygon(points, chain.holes))


def _is_thin(body: BaseGeometry) -> bool:
    """Whether an area is thin enough for a wall, and no room or floor."""
    return body.area > 0 and body.buffer(-MAX_THICKNESS_M / 2).is_empty


def _is_heavy(fill: BaseGeometry) -> bool:
    """Whether a filled area may be masonry, as most of it is no wider than a heavy wall."""
    half = MAX_HEAVY_M / 2
    wide = fill.buffer(-half, join_style="mitre").buffer(half, join_style="mitre")
    return fill.area > 0 and wide.intersection(fill).area < fill.area / 2
