"""Pictures of a plan: a drawing from above, and a view of its walls in three dimensions.

The plan view follows architectural practice: all openings show, whatever their height. Artists
carry a group id ("walls:brick", "openings:door", "source" ...) by which they can be found and
restyled, and which an SVG keeps.
"""

from collections import defaultdict
from math import ceil, floor, log10
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from matplotlib.transforms import ScaledTranslation
from numpy.typing import NDArray
from shapely import get_coordinates

from atomicfiles import atomic_write
from floorplans.pictures.legend import (
    INK,
    is_low,
    kind_handles,
    marker_handles,
    markers,
    material_handles,
    plan_openings,
)
from floorplans.pictures.symbols import DoorSwings, WallStrips, strip, strip_edges
from floorplans.unchecked import UncheckedPlan

MIN_WIDTH = 0.004
"""Least drawn width of walls, as a fraction of the plan's longer side."""

FLOOR = "#fbfaf7"

PAGE_IN = 7.16
"""Width of both columns of a two-column page [inch]."""

_LABELS_IN = 0.45

Quads = list[NDArray[np.float64]]


def draw_plan(plan: UncheckedPlan, ax: Axes) -> None:
    """Draw a plan from above, with legend, scale bar, and axes in metres.

    Parameters
    ----------
    plan : UncheckedPlan
    ax : matplotlib.axes.Axes
        The legend lies below it: give its figure ``layout="constrained"`` or save it with
        ``bbox_inches="tight"``.
    """
    x_min, y_min, x_max, y_max = plan.bounds
    strips = WallStrips(plan, MIN_WIDTH * max(x_max - x_min, y_max - y_min))
    _draw_floor(plan, ax)
    _draw_walls(plan, ax, strips)
    _draw_openings(plan, ax, strips)
    _draw_markers(plan, ax)
    _draw_scale_bar(plan, ax)
    _draw_legend(plan, ax)
    _set_up_axes(plan, ax)


def save_plan_picture(plan: UncheckedPlan, path: str | Path, *, width_in: float = PAGE_IN) -> None:
    """Draw a plan from above into a file, which is written whole or not at all.

    Parameters
    ----------
    plan : UncheckedPlan
    path : str or Path
        Its suffix names the format: .png, .svg or .pdf.
    width_in : float
        Width of the picture, about [inch]; that of a page of two columns by default. A plan that
        is higher than wide is drawn narrower.
    """
    x_min, y_min, x_max, y_max = plan.bounds
    width, height = x_max - x_min, y_max - y_min
    scale = (width_in - _LABELS_IN) / max(width, 1.2 * height)
    figure = Figure(figsize=(width * scale + _LABELS_IN, height * scale + _LABELS_IN))
    draw_plan(plan, figure.add_axes((0.0, 0.0, 1.0, 1.0)))
    with atomic_write(path) as beside:
        figure.savefig(beside, dpi=300, bbox_inches="tight", pad_inches=0.03)


def _draw_floor(plan: UncheckedPlan, ax: Axes) -> None:
    rings = [plan.outline.exterior, *plan.outline.interiors]
    colours = [FLOOR] + ["white"] * len(plan.outline.interiors)
    floor = PolyCollection([get_coordinates(ring) for ring in rings], facecolors=colours, zorder=0)
    floor.set_gid("floor")
    ax.add_collection(floor)


def _draw_walls(plan: UncheckedPlan, ax: Axes, strips: WallStrips) -> None:
    """Draw walls and columns by material: low walls under the others, thick over thin."""
    by_style: defaultdict[tuple[bool, str], Quads] = defaultdict(list)
    for wall in sorted(plan.walls, key=lambda wall: wall.thickness_m):
        by_style[is_low(wall, plan), wall.material] += strips.strips(wall)
    for region in plan.solid_regions:
        by_style[region.top_m < plan.height_m, region.material].append(
            get_coordinates(region.polygon.exterior)
        )
    for rank, ((low, material), quads) in enumerate(by_style.items()):
        colour = plan.colour_of(material)
        collection = PolyCollection(
            quads,
            facecolors=[(colour, 0.35 if low else 1.0)],
            edgecolors=[colour],
            linewidths=[0.4],
            zorder=1 if low else 2 + rank / 100,
        )
        collection.set_gid(f"{'low walls' if low else 'walls'}:{material}")
        ax.add_collection(collection)


def _draw_openings(plan: UncheckedPlan, ax: Axes, strips: WallStrips) -> None:
    fillings: defaultdict[str, Quads] = defaultdict(list)
    lines: defaultdict[str, Quads] = defaultdict(list)
    swings = DoorSwings(plan)
    for wall, opening in plan_openings(plan):
        width = strips.width_m(wall)
        if opening.material is not None:
            filling = strip(wall, opening.offset_m, opening.end_m, width * 0.5)
            fillings[opening.material].append(filling)
        if opening.kind == "door":
            lines["door"] += swings.symbol(wall, opening)
        else:
            lines[opening.kind] += strip_edges(wall, opening.offset_m, opening.end_m, width)
    for material, quads in fillings.items():
        collection = PolyCollection(quads, facecolors=plan.colour_of(material), zorder=3)
        collection.set_gid(f"fillings:{material}")
        ax.add_collection(collection)
    for kind, segments in lines.items():
        style = "--" if kind == "passage" else "-"
        collection = LineCollection(
            segments, colors=INK, linewidths=0.6, linestyles=style, zorder=3.5
        )
        collection.set_gid(f"openings:{kind}")
        ax.add_collection(collection)


def _draw_markers(plan: UncheckedPlan, ax: Axes) -> None:
    for artist, (x, y, _) in markers(plan):
        artist.set_data([x], [y])
        ax.add_line(artist)


def _draw_scale_bar(plan: UncheckedPlan, ax: Axes) -> None:
    """Draw a bar of round length, half dark and half light, above the plan's right corner."""
    x_min, y_min, x_max, y_max = plan.bounds
    extent = max(x_max - x_min, y_max - y_min)
    length, thickness, y = _round_length(extent / 5), 0.006 * extent, y_max + 0.03 * extent
    for x, colour in ((x_max - length, INK), (x_max - length / 2, "white")):
        half = Rectangle((x, y), length / 2, thickness, facecolor=colour, edgecolor=INK, lw=0.6)
        half.set_gid("scale bar")
        ax.add_patch(half)
    label = ax.annotate(
        f"{length:g} m",
        (x_max - length, y + thickness / 2),
        xytext=(-5, 0),
        textcoords="offset points",
        ha="right",
        va="center",
        fontsize="medium",
    )
    label.set_gid("scale bar")


def _round_length(length: float) -> float:
    """Round down to 1, 2 or 5 times a power of ten."""
    power = 10.0 ** floor(log10(length))
    return max(step for step in (1, 2, 5) if step * power <= length * (1 + 1e-9)) * power


def _draw_legend(plan: UncheckedPlan, ax: Axes) -> None:
    figure = ax.get_figure(root=True)
    assert figure is not None
    below = ScaledTranslation(0, -0.5, figure.dpi_scale_trans)
    handles = [*marker_handles(plan), *material_handles(plan), *kind_handles(plan)]
    ax.legend(
        handles=handles,
        loc="upper center",
        bbox_to_anchor=(0.5, 0),
        bbox_transform=ax.transAxes + below,
        ncols=min(len(handles), 5),
        frameon=False,
        fontsize="medium",
    )


def _set_up_axes(plan: UncheckedPlan, ax: Axes) -> None:
    x_min, y_min, x_max, y_max = plan.bounds
    extent = max(x_max - x_min, y_max - y_min)
    margin = 0.01 * extent + max(wall.thickness_m for wall in plan.walls) / 2
    ax.set_aspect("equal")
    ax.set_xlim(x_min - margin, x_max + margin)
    ax.set_ylim(y_min - margin, y_max + margin + 0.04 * extent)
    ax.set_xticks(_ticks(x_min, x_max, extent))
    ax.set_yticks(_ticks(y_min, y_max, extent))
    ax.set_title(plan.name, loc="left", parse_math=False)
    ax.set_xlabel("x [m]")
    ax.set_ylabel("y [m]")
    ax.spines[:].set_visible(False)


def _ticks(low: float, high: float, extent: float) -> NDArray[np.float64]:
    """Round numbers from `low` to `high` [m], with the same spacing on both axes."""
    step = _round_length(extent / 5)
    return step * np.arange(ceil(low / step), floor(high / step) + 1, dtype=np.float64)
