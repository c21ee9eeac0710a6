"""Markers and legend entries that the pictures of a plan share."""

from collections.abc import Iterator
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.path import Path

from floorplans.materials import MATERIALS
from floorplans.pictures.symbols import leaf_and_arc
from floorplans.unchecked import UncheckedPlan
from floorplans.walls import Opening, Wall

INK = "#222222"
SOURCE = "#d81b60"
START = "#1e6fd9"

_MARKERS: dict[str, dict[str, Any]] = {
    "source": {"marker": "*", "markersize": 15, "color": SOURCE, "label": "source (phone)"},
    "transmitter": {"marker": "*", "markersize": 12, "color": SOURCE, "label": "transmitter"},
    "start": {"marker": "o", "markersize": 8, "color": START, "label": "start"},
}


def markers(plan: UncheckedPlan) -> Iterator[tuple[Line2D, tuple[float, float, float]]]:
    """Yield markers of source, transmitters and start, as far as there are, and their places."""
    placed = [("transmitter", transmitter.position) for transmitter in plan.transmitters]
    if plan.source is not None:
        placed.insert(0, ("source", plan.source))
    if plan.start is not None:
        placed.append(("start", (*plan.start, 0.0)))
    for kind, position in placed:
        artist = Line2D([], [], **_MARKERS[kind])
        artist.set(gid=kind, linestyle="none", markeredgecolor="white", zorder=5)
        yield artist, position


def marker_handles(plan: UncheckedPlan) -> list[Artist]:
    """One marker of each kind that the plan has, for a legend."""
    return list({artist.get_gid(): artist for artist, _ in markers(plan)}.values())


def material_handles(plan: UncheckedPlan) -> Iterator[Artist]:
    """Yield a patch for each material of walls and fillings: built-in ones, then the plan's own."""
    used = {wall.material for wall in plan.walls}
    used |= {o.material for _, o in plan_openings(plan) if o.material is not None}
    for material in (*MATERIALS, *plan.own_materials):
        if material in used:
            yield Patch(facecolor=plan.colour_of(material), label=material.replace("_", " "))


def kind_handles(plan: UncheckedPlan) -> Iterator[Artist]:
    """Yield the symbols of low walls and of the kinds of openings that the plan has."""
    for height_m in sorted({wall.height_m for wall in plan.walls if is_low(wall, plan)}):
        yield Patch(facecolor=("k", 0.2), edgecolor="k", lw=0.4, label=f"wall {height_m:g} m high")
    symbols = {
        "door": _door_symbol(),
        "window": Patch(facecolor="white", edgecolor=INK, lw=0.6, label="window"),
        "passage": Line2D([], [], color=INK, lw=0.6, linestyle="--", label="passage"),
    }
    used = {opening.kind for _, opening in plan_openings(plan)}
    yield from (symbol for kind, symbol in symbols.items() if kind in used)


def plan_openings(plan: UncheckedPlan) -> Iterator[tuple[Wall, Opening]]:
    """Yield every opening with its wall."""
    for wall in plan.walls:
        for opening in wall.openings:
            yield wall, opening


def is_low(wall: Wall, plan: UncheckedPlan) -> bool:
    """Whether a wall ends below the ceiling."""
    return wall.height_m < plan.height_m


def _door_symbol() -> Line2D:
    leaf, arc = leaf_and_arc(np.zeros(2), np.array([1.0, 0.0]), np.array([0.0, 1.0]))
    swing = Path(np.concatenate([arc, leaf[::-1]]) - 0.5)
    door = Line2D([], [], linestyle="none", marker=swing, markersize=12, label="door")
    door.set(markerfacecolor="none", markeredgecolor=INK, markeredgewidth=0.6)
    return door
