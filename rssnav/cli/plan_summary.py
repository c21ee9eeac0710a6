"""Properties of a plan, in a few lines or as JSON."""

from dataclasses import asdict
from typing import Any

from floorplans import FloorPlan
from rssnav.cli.console import print_pairs


def summary_of(plan: FloorPlan) -> dict[str, Any]:
    """Return the properties of a plan, for JSON."""
    return {
        "title": plan.name,
        "bounds_m": plan.bounds,
        "height_m": plan.height_m,
        "area_m2": plan.outline.area,
        "walls": len(plan.walls),
        "openings": count_openings(plan),
        "materials": _materials(plan),
        "source_m": plan.source,
        "start_m": plan.start,
        "transmitters": [asdict(transmitter) for transmitter in plan.transmitters],
        "sha256": plan.sha256,
    }


def print_summary(plan: FloorPlan) -> None:
    """Print the properties of a plan, one per line."""
    print_pairs(
        [
            ("plan", plan.name),
            ("size", f"{size_text(plan)}, {plan.height_m:g} m high, {plan.outline.area:g} m²"),
            (
                "walls",
                f"{_counted(len(plan.walls), 'straight piece')} with "
                f"{_counted(count_openings(plan), 'opening')}",
            ),
            ("materials", ", ".join(_materials(plan))),
            *((f"transmitter {t.id}", f"{point_text(t.position)} m") for t in plan.transmitters),
            *(
                (name, f"{point_text(place)} m")
                for name, place in (("source", plan.source), ("start", plan.start))
                if place is not None
            ),
        ]
    )


def _materials(plan: FloorPlan) -> tuple[str, ...]:
    """Names of a plan's materials, each once."""
    return tuple(dict.fromkeys(sheet.name for sheet in plan.to_mesh().materials))


def _counted(number: int, noun: str) -> str:
    return f"{number} {noun}{'s' * (number != 1)}"


def count_openings(plan: FloorPlan) -> int:
    """Count the openings of all walls."""
    return sum(len(wall.openings) for wall in plan.walls)


def size_text(plan: FloorPlan) -> str:
    """Write the extent along x and y."""
    x_min, y_min, x_max, y_max = plan.bounds
    return f"{x_max - x_min:g} x {y_max - y_min:g} m"


def point_text(point: tuple[float, ...] | None) -> str:
    """Write a point [m] in the fewest digits; "-" for none."""
    if point is None:
        return "-"
    return f"({', '.join(f'{c:g}' for c in point)})"
