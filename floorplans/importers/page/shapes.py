"""Plan and drawing as paths of an SVG picture, x to the right and y up [m]."""

from __future__ import annotations

import base64
from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry.base import BaseGeometry

from floorplans.importers.original import DrawnPicture, Original
from floorplans.repair.geometry import Change
from floorplans.unchecked import UncheckedPlan
from floorplans.walls import Point

_OPENING_COLOURS = {"door": "#b35c00", "window": "#0077cc", "passage": "#2a8a2a"}
_MOST_POINTS = 300_000
_MARGIN = 0.06
_MOST_TIMES = 20.0
"""Times the plan's size up to which the drawing is shown: beyond lie stray points."""


@dataclass(frozen=True)
class View:
    """The part of the plane that is shown, (x, y) of the lower left corner and size [m]."""

    x: float
    y: float
    width: float
    height: float

    @property
    def longer(self) -> float:
        """The longer side [m]."""
        return max(self.width, self.height)


@dataclass(frozen=True)
class Path:
    """Lines of one kind: name, what became of it, SVG path, colour, and width [m]."""

    name: str
    text: str
    d: str
    colour: str = ""
    width: float = 0.0
    is_used: bool = True


@dataclass(frozen=True)
class Picture:
    """A picture of pixels, and the SVG transformation that puts it in its place."""

    url: str
    columns: int
    rows: int
    matrix: str


@dataclass(frozen=True)
class Mark:
    """Something to look at: an SVG path in a colour, and its text."""

    kind: str
    d: str
    text: str


def plan_view(plan: UncheckedPlan) -> View:
    """Return the plan with a margin."""
    return _with_margin(np.array(plan.bounds))


def whole_view(plan: UncheckedPlan, original: Original | None) -> View:
    """Return the plan and all that is drawn, but nothing very far away, with a margin."""
    own = np.array(plan.bounds)
    reach = _MOST_TIMES * max(own[2] - own[0], own[3] - own[1]) * np.array([-1, -1, 1, 1])
    limits = own + reach
    drawn = [shapely.total_bounds(layer.geometry) for layer in original.layers] if original else []
    if original is not None and original.picture is not None:
        drawn.append(_bounds_of(original.picture))
    shown = [own, *(np.clip(box, limits[[0, 1, 0, 1]], limits[[2, 3, 2, 3]]) for box in drawn)]
    boxes = np.array([box for box in shown if np.isfinite(box).all()])
    return _with_margin(np.concatenate([boxes[:, :2].min(axis=0), boxes[:, 2:].max(axis=0)]))


def _bounds_of(picture: DrawnPicture) -> NDArray[np.float64]:
    """Bounds of a picture (x_min, y_min, x_max, y_max) [m]."""
    columns, rows = picture.size
    corners = np.array([(0, 0, 1), (columns, 0, 1), (columns, rows, 1), (0, rows, 1)])
    points = corners @ np.array(picture.to_m).T
    return np.concatenate([points.min(axis=0), points.max(axis=0)])


def _with_margin(box: NDArray[np.float64]) -> View:
    x_min, y_min, x_max, y_max = box.tolist()
    margin = _MARGIN * max(x_max - x_min, y_max - y_min)
    return View(
        x_min - margin, y_min - margin, x_max - x_min + 2 * margin, y_max - y_min + 2 * margin
    )


def picture_of(original: Original | None) -> Picture | None:
    """Return the picture of a robot's map as a data URL."""
    if original is None or original.picture is None:
        return None
    shown = original.picture
    (a, b, c), (d, e, f) = shown.to_m
    url = "data:image/png;base64," + base64.b64encode(shown.png).decode()
    columns = " ".join(f"{number:.9g}" for number in (a, d, b, e, c, f))
    return Picture(url, *shown.size, f"matrix({columns})")


def drawn_paths(original: Original | None) -> list[Path]:
    """Layers of a drawing that have lines, those left out first."""
    layers = [] if original is None else original.layers
    paths: list[Path] = []
    n_points = 0
    for layer in sorted(layers, key=lambda layer: (layer.is_used, layer.name)):
        n_points += int(shapely.get_num_coordinates(layer.geometry))
        if n_points > _MOST_POINTS and not layer.is_used:
            continue
        d = "".join(_commands(_lines(layer.geometry)))
        if d:
            paths.append(Path(layer.name, layer.became, d, is_used=layer.is_used))
    return paths


def wall_paths(plan: UncheckedPlan) -> list[Path]:
    """Centre lines of walls by material and thickness."""
    by_kind: defaultdict[tuple[str, float], list[NDArray[np.float64]]] = defaultdict(list)
    for wall in plan.walls:
        by_kind[wall.material, wall.thickness_m].append(np.array([wall.start, wall.end]))
    return [
        Path(material, "", "".join(_commands(lines)), plan.colour_of(material), thickness_m)
        for (material, thickness_m), lines in by_kind.items()
    ]


def opening_paths(plan: UncheckedPlan) -> list[Path]:
    """Openings by kind, each as the section of its wall's centre line."""
    by_kind: defaultdict[str, list[NDArray[np.float64]]] = defaultdict(list)
    for wall in plan.walls:
        for opening in wall.openings:
            ends = [wall.point_at(opening.offset_m), wall.point_at(opening.end_m)]
            by_kind[opening.kind].append(np.array(ends))
    return [
        Path(kind, f"{len(lines)}", "".join(_commands(lines)), _OPENING_COLOURS[kind])
        for kind, lines in by_kind.items()
    ]


def marks_of(
    plan: UncheckedPlan,
    changes: Sequence[Change],
    gaps: Iterable[tuple[Point, Point]],
    view: View,
) -> list[Mark]:
    """Gaps, closed gaps, and what was dropped near the plan."""
    r = 0.008 * view.longer
    marks = [Mark("gap", _between(a, b), "open") for a, b in gaps]
    for change in changes:
        if change.kind == "closed" and change.to is not None:
            marks.append(Mark("closed", _between(change.at, change.to), str(change)))
        elif change.kind == "dropped":
            x, y = change.at
            d = f"M{x - r:.3f} {y - r:.3f}l{2 * r:.3f} {2 * r:.3f}m{-2 * r:.3f} 0l{2 * r:.3f} "
            marks.append(Mark("dropped", f"{d}{-2 * r:.3f}", str(change)))
    return marks


def _between(a: Point, b: Point) -> str:
    return f"M{a[0]:.3f} {a[1]:.3f}L{b[0]:.3f} {b[1]:.3f}"


def _lines(geometry: BaseGeometry) -> Iterator[NDArray[np.float64]]:
    """Points (n, 2) of every line and ring of a geometry, also in collections."""
    for part in shapely.get_parts(geometry):
        if shapely.get_type_id(part) >= 4:
            yield from _lines(part)
        elif part.geom_type == "Polygon":
            yield from map(shapely.get_coordinates, shapely.get_rings(part))
        elif part.geom_type == "Point":
            yield np.repeat(shapely.get_coordinates(part), 2, axis=0)
        else:
            yield shapely.get_coordinates(part)


def _commands(lines: Iterable[NDArray[np.float64]]) -> Iterator[str]:
    """SVG path commands to the millimetre."""
    for points in lines:
        if len(points):
            yield "M" + "L".join(f"{x:.3f} {y:.3f}" for x, y in points.tolist())
