"""An import as one HTML page: the plan over the drawing, what was assumed and what was changed."""

from __future__ import annotations

from collections import Counter, defaultdict
from dataclasses import dataclass

from jinja2 import Environment, PackageLoader, StrictUndefined

from floorplans.importers.imported import DraftPlan, ImportRecord
from floorplans.importers.page.shapes import (
    drawn_paths,
    marks_of,
    opening_paths,
    picture_of,
    plan_view,
    wall_paths,
    whole_view,
)
from floorplans.repair.geometry import Change

_KINDS = {
    "closed": "Closed: gaps in the outline that got a wall",
    "dropped": "Left out: walls and openings that no room has",
    "raised": "Raised to the ceiling: low walls in the outline",
}
"""Changes that are listed one by one."""
_OTHERS = {"moved": "ends and corners moved", "joined": "walls merged", "cut": "walls cut"}


@dataclass(frozen=True)
class MaterialUse:
    """Walls of one material: their number and total length [m]."""

    name: str
    colour: str
    n_walls: int
    length_m: float


def import_page(record: ImportRecord) -> str:
    """Write an import as a page that needs no other file.

    Parameters
    ----------
    record : ImportRecord
        An `Imported` plan or a `DraftPlan`.

    Returns
    -------
    str
        HTML.
    """
    faults = record.faults if isinstance(record, DraftPlan) else ()
    gaps = record.gaps if isinstance(record, DraftPlan) else ()
    original = record.original
    view = whole_view(record.plan, original)
    near = plan_view(record.plan)
    counts = Counter(change.kind for change in record.changes)
    return (
        _environment()
        .get_template("page.html.j2")
        .render(
            record=record,
            title=f"Import of {record.source_file}",
            view=view,
            near=near,
            picture=picture_of(original),
            drawn=drawn_paths(original),
            walls=wall_paths(record.plan),
            openings=opening_paths(record.plan),
            marks=marks_of(record.plan, record.changes, gaps, near),
            faults=[str(fault) for fault in faults],
            materials=_materials(record),
            listed=[(text, _rows(record, kind)) for kind, text in _KINDS.items() if counts[kind]],
            others=[f"{text}: {counts[kind]}" for kind, text in _OTHERS.items() if counts[kind]],
        )
    )


def _environment() -> Environment:
    return Environment(
        loader=PackageLoader("floorplans.importers.page"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )


def _rows(record: ImportRecord, kind: str) -> list[Change]:
    return [change for change in record.changes if change.kind == kind]


def _materials(record: ImportRecord) -> list[MaterialUse]:
    lengths_m: defaultdict[str, list[float]] = defaultdict(list)
    for wall in record.plan.walls:
        lengths_m[wall.material].append(wall.length_m)
    return [
        MaterialUse(name, record.plan.colour_of(name), len(each), sum(each))
        for name, each in sorted(lengths_m.items(), key=lambda item: -sum(item[1]))
    ]
