"""FloorPlan <-> GeoJSON that contains a complete plan.

The collection has the foreign member ``rssnav_plan`` with every key of the plan's TOML file that is
not geometry. The outline, each wall, opening and transmitter, the source and the start are
features; a feature's properties are the keys of its table in the TOML file. Coordinates are
longitude and latitude if the plan has an origin; otherwise they are metres, of the drawing that the
plan was turned from or its own, with ``"crs": null`` as in GeoJSON 2008 for coordinates without a
place on the Earth.
"""

from __future__ import annotations

import json
import tomllib
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from floorplans.errors import PlanError
from floorplans.frame import PlanFrame
from floorplans.georeference import GeoOrigin
from floorplans.loading import from_data
from floorplans.plan import FloorPlan
from floorplans.toml.writer import dumps
from floorplans.walls import Wall

MEMBER = "rssnav_plan"
"""Foreign member of the collection that identifies a GeoJSON file with a plan."""

GEOMETRY_KEYS = ("outline", "holes", "walls", "source", "start", "transmitters")

_MOVED_M = 1e-6
"""A feature farther than this from its exact points was moved by another program [m]."""

Json = dict[str, Any]
Points = NDArray[np.float64]


def plan_to_geojson(plan: FloorPlan) -> Json:
    """Return a plan as a FeatureCollection; `plan_from_geojson` restores an equal plan."""
    data = tomllib.loads(dumps(plan))
    rings = [data["outline"], *data.get("holes", [])]
    features = [_feature(plan, "Polygon", rings, {"kind": "outline"})]
    for index, (wall, table) in enumerate(zip(plan.walls, data["walls"], strict=True)):
        features += _wall_features(plan, wall, table, index)
    for kind in ("source", "start"):
        if kind in data:
            features.append(_feature(plan, "Point", data[kind], {"kind": kind}))
    for table in data.get("transmitters", []):
        facts = {key: value for key, value in table.items() if key != "position"}
        properties = {"kind": "transmitter", **facts}
        features.append(_feature(plan, "Point", table["position"], properties))
    facts = {key: value for key, value in data.items() if key not in GEOMETRY_KEYS}
    collection: Json = {"type": "FeatureCollection", MEMBER: facts, "features": features}
    return collection if plan.origin else {"crs": None, **collection}


def dumps_geojson(plan: FloorPlan) -> str:
    """Write a plan as GeoJSON text, one line per feature."""
    collection = plan_to_geojson(plan)
    features = collection.pop("features")
    head = json.dumps(collection, ensure_ascii=False).removesuffix("}")
    lines = ",\n".join(json.dumps(feature, ensure_ascii=False) for feature in features)
    return f'{head}, "features": [\n{lines}\n]}}\n'


def is_plan(collection: Mapping[str, Any]) -> bool:
    """Whether a GeoJSON object was written by `plan_to_geojson`."""
    return MEMBER in collection


def plan_from_geojson(collection: Mapping[str, Any], *, origin: str = "<geojson>") -> FloorPlan:
    """Read a plan that `plan_to_geojson` wrote, possibly edited since.

    Parameters
    ----------
    collection : mapping
        The FeatureCollection as `json` reads it.
    origin : str
        Name of the text in messages, such as its file's.

    Returns
    -------
    FloorPlan

    Raises
    ------
    PlanError
        When a part is missing or wrong.
    """
    try:
        data = _plan_data(collection)
    except (KeyError, TypeError, ValueError, IndexError, AttributeError) as error:
        raise PlanError(
            f"not a plan exported as GeoJSON, or made unreadable by editing ({error!r}); "
            f"remove its member {MEMBER!r} to read it as any other GeoJSON",
            origin=origin,
        ) from error
    return from_data(data, origin=origin)


def _wall_features(plan: FloorPlan, wall: Wall, table: Json, index: int) -> list[Json]:
    facts = {key: value for key, value in table.items() if key not in ("points", "openings")}
    properties = {"kind": "wall", "wall": index, **facts}
    features = [_feature(plan, "LineString", table["points"], properties)]
    for opening, row in zip(wall.openings, table.get("openings", []), strict=True):
        ends = [list(wall.point_at(s)) for s in (opening.offset_m, opening.end_m)]
        features.append(_feature(plan, "LineString", ends, {**row, "wall": index}))
    return features


def _feature(plan: FloorPlan, kind: str, points: Any, properties: Json) -> Json:
    """Create a feature; if its geometry is in other coordinates, a property keeps the plan's."""
    if plan.origin is not None or plan.frame is not None:
        properties = {**properties, "points_m": points}
        points = _mapped(points, _from_plan(plan))
    return {
        "type": "Feature",
        "properties": properties,
        "geometry": {"type": kind, "coordinates": points},
    }


def _from_plan(plan: FloorPlan) -> Callable[[Points], Points]:
    """Conversion from the plan's coordinates to those of the file."""
    if plan.origin is not None:
        return plan.origin.to_degrees
    assert plan.frame is not None
    return plan.frame.to_drawing


def _to_plan(data: Json) -> Callable[[Points], Points] | None:
    """Conversion from the file's coordinates to the plan's; None if they are the same."""
    if "origin" in data:
        return GeoOrigin(**data["origin"]).to_plan
    return PlanFrame(**data["frame"]).to_plan if "frame" in data else None


def _plan_data(collection: Mapping[str, Any]) -> Json:
    """Return the keys and values of the plan's TOML file."""
    data: Json = dict(collection[MEMBER])
    to_plan = _to_plan(data)
    walls: dict[int, Json] = {}
    for feature in collection["features"]:
        table = dict(feature["properties"])
        kind, points = table.pop("kind"), _points(feature, table.pop("points_m", None), to_plan)
        if kind == "outline":
            data["outline"], *holes = points
            data |= {"holes": holes} if holes else {}
        elif kind in ("source", "start"):
            data[kind] = points
        elif kind == "transmitter":
            data.setdefault("transmitters", []).append({**table, "position": points})
        elif kind in ("wall", "clutter"):
            index = table.pop("wall")
            walls[index] = {"kind": kind, **table, "points": points}
        else:
            wall = walls[table.pop("wall")]
            wall.setdefault("openings", []).append({"kind": kind, **table})
    return {**data, "walls": list(walls.values())}


def _points(
    feature: Mapping[str, Any], exact: Any, to_plan: Callable[[Points], Points] | None
) -> Any:
    """Coordinates of a feature [m]: the exact ones, unless its geometry was moved since."""
    coordinates = feature["geometry"]["coordinates"]
    if to_plan is None:
        return coordinates
    points = _mapped(coordinates, to_plan)
    if exact is not None and _nearly_equal(points, exact):
        return exact
    return points


def _mapped(points: Any, project: Callable[[Points], Points]) -> Any:
    """Project the first two numbers of each point of a nested list of points."""
    if not isinstance(points[0], list):
        x, y = project(np.array([points[:2]], dtype=np.float64))[0].tolist()
        return [x, y, *points[2:]]
    return [_mapped(part, project) for part in points]


def _nearly_equal(points: Any, exact: Any) -> bool:
    if isinstance(points, list):
        return len(points) == len(exact) and all(map(_nearly_equal, points, exact))
    return abs(points - exact) < _MOVED_M
