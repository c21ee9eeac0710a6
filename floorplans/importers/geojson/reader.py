"""GeoJSON and IMDF -> Draft.

Walls drawn as areas become centre lines with the measured thickness; walls drawn as lines are kept;
if no wall is drawn as an area, walls are also placed around and between the rooms.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence, Set
from contextlib import suppress
from pathlib import Path

from shapely.geometry import GeometryCollection
from shapely.geometry.base import BaseGeometry

from floorplans.errors import PlanError
from floorplans.geojson_plan import is_plan, plan_from_geojson
from floorplans.georeference import GeoOrigin
from floorplans.importers.draft import Draft, ImportOptions, LayerUse, Origin
from floorplans.importers.geojson.features import FeatureClass, Kind, classify, levels_of
from floorplans.importers.geojson.files import Collection, read_collection
from floorplans.importers.geojson.frame import geometry_of, to_metres
from floorplans.importers.geojson.levels import on_level
from floorplans.importers.geojson.walls import Placed, openings_of, walls_of
from floorplans.importers.layer_names import is_horizontal_opening, unmatched
from floorplans.importers.original import DrawnLayer, Original
from floorplans.importers.progress import Report, Step, no_report
from floorplans.plan import FloorPlan

TOLERANCE_M = 0.05

_USE = {True: "used", False: "left out"}
_USED: tuple[Kind, ...] = ("wall", "door", "window", "passage", "room", "outline")


def read_geojson(
    path: Path, options: ImportOptions, report: Report = no_report
) -> Draft | FloorPlan:
    """Read a GeoJSON file, or an IMDF venue in a folder or archive.

    Parameters
    ----------
    path : Path
    options : ImportOptions
        `level`, `unit`, `tolerance_m` and `layers` are used.
    report : callable
        Called with finished steps.

    Returns
    -------
    Draft or FloorPlan
        The plan itself, from a file that `floorplans.exporters` wrote.

    Raises
    ------
    PlanError
        When the file cannot be read, or describes no building.
    """
    collection = read_collection(path)
    report(Step.FILE_LOADED)
    if is_plan(collection.document):
        return plan_from_geojson(collection.document, origin=str(path))
    classes = [classify(feature, options) for feature in collection.features]
    placed, left_out, origin = _placed(collection, classes, options)
    tolerance_m = options.tolerance_m or TOLERANCE_M
    walls = walls_of(placed, tolerance_m)
    if not walls:
        raise PlanError(_nothing_found(classes), remedy="layers")
    return Draft(
        name=path.stem,
        walls=tuple(walls),
        openings=tuple(openings_of(placed, tolerance_m)),
        origin=None if origin is None else _named(origin),
        georeference=origin,
        layers=tuple(_uses(placed, classes)),
        notes=tuple(unmatched(options.layers, {what.label for what in classes})),
        original=_original(placed, left_out),
    )


def _placed(
    collection: Collection, classes: Sequence[FeatureClass], options: ImportOptions
) -> tuple[list[Placed], list[Placed], GeoOrigin | None]:
    """Return the used features of one level and those left out, in metres, and where (0, 0) is."""
    used = [i for i, what in enumerate(classes) if what.kind in _USED]
    if not used:
        raise PlanError(_nothing_found(classes), remedy="layers")
    levels = [i for i, what in enumerate(classes) if what.kind == "level"]
    here = on_level([collection.features[i] for i in [*used, *levels]], options.level)
    used = [i for i, is_here in zip(used, here, strict=False) if is_here]
    drawn = [geometry_of(collection.features[i], i) for i in used]
    others = dict(_on_the_same_level(collection, used, {*levels, *used}))
    metres, origin = to_metres(drawn, collection.crs, options.unit, list(others.values()))
    placed = [
        Placed(collection.features[i], classes[i], geometry)
        for i, geometry in zip([*used, *others], metres, strict=True)
    ]
    return placed[: len(used)], placed[len(used) :], origin


def _on_the_same_level(
    collection: Collection, used: Sequence[int], known: Set[int]
) -> Iterator[tuple[int, BaseGeometry]]:
    """Yield index and geometry of the other features that are on the levels of the used ones."""
    levels = frozenset[str]().union(*(levels_of(collection.features[i]) for i in used))
    for i, feature in enumerate(collection.features):
        own = levels_of(feature)
        if i not in known and (not own or own & levels):
            with suppress(PlanError):  # what is left out need not be readable
                yield i, geometry_of(feature, i)


def _original(placed: Sequence[Placed], left_out: Sequence[Placed]) -> Original:
    """The features of the level, by their names."""
    layers: dict[tuple[str, bool], list[BaseGeometry]] = {}
    for features, is_used in ((placed, True), (left_out, False)):
        for feature in features:
            layers.setdefault((feature.what.label, is_used), []).append(feature.geometry)
    return Original(
        tuple(
            DrawnLayer(
                label, "used" if is_used else "left out", is_used, GeometryCollection(shapes)
            )
            for (label, is_used), shapes in sorted(layers.items(), key=lambda item: item[0])
        )
    )


def _named(origin: GeoOrigin) -> Origin:
    return Origin(origin.longitude_deg, origin.latitude_deg, "longitude and latitude [degrees]")


def _nothing_found(classes: Sequence[FeatureClass]) -> str:
    labels = Counter(what.label for what in classes)
    shown = ", ".join(f"{label} ({n})" for label, n in labels.most_common(12))
    return (
        f"no wall and no room was recognised among the features, which are called: {shown}; say "
        "which are walls, such as NAME=wall"
    )


def _uses(placed: Sequence[Placed], classes: Sequence[FeatureClass]) -> list[LayerUse]:
    """Report what became of the features, one entry per name."""
    total = Counter((what.label, what.kind) for what in classes)
    here = Counter((p.what.label, p.what.kind) for p in placed)
    return [
        LayerUse(label, n, _became(label, kind, here[label, kind], n), is_unknown=kind is None)
        for (label, kind), n in sorted(total.items(), key=lambda item: item[0][0])
    ]


def _became(label: str, kind: str | None, n_here: int, n_total: int) -> str:
    if kind not in _USED:
        in_slab = kind == "ignore" and is_horizontal_opening(label)
        return "left out (in a floor or roof, not in a wall)" if in_slab else "left out"
    return f"{kind}" if n_here == n_total else f"{kind}; {n_total - n_here} on other levels"
