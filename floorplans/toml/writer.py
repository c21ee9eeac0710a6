"""FloorPlan -> TOML text in canonical form."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from shapely.geometry.polygon import LinearRing

from floorplans.georeference import GeoOrigin
from floorplans.toml.materials import write_materials
from floorplans.toml.transmitters import write_transmitters
from floorplans.toml.values import toml_number as _number
from floorplans.toml.values import toml_text as _text
from floorplans.unchecked import UncheckedPlan
from floorplans.walls import Opening, Wall

FORMAT_VERSION = 1


def dumps(plan: UncheckedPlan) -> str:
    """Write a plan as TOML text; `floorplans.loads` gives an equal plan back.

    Equal plans give equal texts: keys are in a fixed order, values equal to the format's defaults
    are left out, and numbers are the shortest that read back exactly.
    """
    blocks = ["\n".join(_top_level(plan)), *write_materials(plan.materials)]
    blocks += write_transmitters(plan.transmitters)
    blocks += ["\n".join(_wall(wall, plan.height_m)) for wall in plan.walls]
    return "\n\n".join(blocks) + "\n"


def _top_level(plan: UncheckedPlan) -> Iterator[str]:
    yield f"name = {_text(plan.name)}"
    yield f"format = {FORMAT_VERSION}"
    yield f"height_m = {_number(plan.height_m)}"
    yield f"floor_material = {_text(plan.floor_material)}"
    yield f"floor_thickness_m = {_number(plan.floor_thickness_m)}"
    yield f"ceiling_material = {_text(plan.ceiling_material)}"
    yield f"ceiling_thickness_m = {_number(plan.ceiling_thickness_m)}"
    if plan.source is not None:
        yield f"source = {_point(plan.source)}"
    if plan.start is not None:
        yield f"start = {_point(plan.start)}"
    yield f"outline = {_ring(plan.outline.exterior)}"
    if plan.outline.interiors:
        yield "holes = [" + ", ".join(_ring(hole) for hole in plan.outline.interiors) + "]"
    if plan.material_edition is not None:
        yield f"material_edition = {_text(plan.material_edition)}"
    if plan.origin is not None:
        yield f"origin = {{ {', '.join(_origin(plan.origin))} }}"
    if plan.frame is not None:
        numbers = {key: _number(getattr(plan.frame, key)) for key in ("x_m", "y_m", "rotation_deg")}
        yield f"frame = {{ {', '.join(f'{key} = {text}' for key, text in numbers.items())} }}"
    if plan.ground_margin_m is not None:
        yield f"ground_margin_m = {_number(plan.ground_margin_m)}"


def _origin(origin: GeoOrigin) -> Iterator[str]:
    yield f"longitude_deg = {_number(origin.longitude_deg)}"
    yield f"latitude_deg = {_number(origin.latitude_deg)}"
    if origin.rotation_deg:
        yield f"rotation_deg = {_number(origin.rotation_deg)}"


def _wall(wall: Wall, ceiling_m: float) -> Iterator[str]:
    yield "[[walls]]"
    if wall.kind != "wall":
        yield f"kind = {_text(wall.kind)}"
    yield f"points = [{_point(wall.start)}, {_point(wall.end)}]"
    yield f"material = {_text(wall.material)}"
    yield f"thickness_m = {_number(wall.thickness_m)}"
    if wall.height_m != ceiling_m:
        yield f"height_m = {_number(wall.height_m)}"
    if wall.openings:
        yield "openings = ["
        yield from (f"  {{ {', '.join(_opening(opening))} }}," for opening in wall.openings)
        yield "]"


def _opening(opening: Opening) -> Iterator[str]:
    yield f"kind = {_text(opening.kind)}"
    yield f"offset_m = {_number(opening.offset_m)}"
    yield f"width_m = {_number(opening.width_m)}"
    if opening.sill_m:
        yield f"sill_m = {_number(opening.sill_m)}"
    yield f"head_m = {_number(opening.head_m)}"
    if opening.material is not None:
        yield f"material = {_text(opening.material)}"
    if opening.thickness_m is not None:
        yield f"thickness_m = {_number(opening.thickness_m)}"


def _ring(ring: LinearRing) -> str:
    return "[" + ", ".join(_point(point) for point in ring.coords) + "]"


def _point(coordinates: Iterable[float]) -> str:
    return "[" + ", ".join(_number(coordinate) for coordinate in coordinates) + "]"
