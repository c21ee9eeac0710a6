"""Source and start on the map: marks that can be dragged."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from bokeh.events import Pan, PanEnd, PanStart
from bokeh.models import ColumnDataSource, PointDrawTool
from bokeh.plotting import figure

from floorplans import FloorPlan
from floorplans.pictures.legend import SOURCE, START
from rssnav.arguments import is_finite

MARKS = ("source", "start")
MARK_REACH = 0.03
"""Largest distance from a mark at which a drag begins, as a fraction of the plan's longer side."""


class Marks:
    """The marks of a plan's source and start.

    Parameters
    ----------
    model : bokeh.plotting.figure
        What they are drawn on.
    plan : FloorPlan
    on_move : callable
        Called with the mark, "source" or "start", and where it was dropped, x and y [m].
    on_drag : callable
        Called likewise while a mark is dragged.
    """

    def __init__(
        self,
        model: figure,
        plan: FloorPlan,
        on_move: Callable[[str, float, float], None],
        on_drag: Callable[[str, float, float], None],
    ) -> None:
        self._on_move, self._on_drag = on_move, on_drag
        self._plan = plan
        self._dragged: str | None = None
        self._data = ColumnDataSource(_columns(plan))
        self._draw(model)
        self._data.on_change("data", self._moved)
        self._follow_drags(model)

    def show(self, plan: FloorPlan) -> None:
        """Move the marks to a plan's source and start."""
        self._plan = plan
        self._data.data = _columns(plan)

    def _draw(self, model: figure) -> None:
        marks = model.scatter(
            "x", "y", source=self._data, marker="marker", size="size", fill_color="colour",
            line_color="white", line_width=2, nonselection_alpha=1.0,
        )  # fmt: skip
        tool = PointDrawTool(
            renderers=[marks],  # pyright: ignore[reportArgumentType]
            add=False,
            num_objects=len(MARKS),
            description="Drag source and start",
        )
        model.add_tools(tool)
        model.toolbar.active_drag = tool

    def _moved(self, _name: str, _old: object, new: dict[str, Any]) -> None:
        """Report a mark that was dropped elsewhere; restore those that are not two points."""
        x, y = (list(new.get(name, ())) for name in ("x", "y"))
        if not len(x) == len(y) == len(MARKS) or not are_numbers(*x, *y):
            self._data.data = _columns(self._plan)
            return
        for which, *dropped, before in zip(MARKS, x, y, _positions(self._plan), strict=True):
            if tuple(dropped) != before:
                self._on_move(which, *map(float, dropped))

    def _follow_drags(self, model: figure) -> None:
        """Report the position of a mark while it is dragged."""

        def begin(event: Any) -> None:
            at = (event.x, event.y)
            self._dragged = self._mark_at(*at) if are_numbers(*at) else None

        def go_on(event: Any) -> None:
            if self._dragged is not None and are_numbers(event.x, event.y):
                self._on_drag(self._dragged, event.x, event.y)

        def end(_event: Any) -> None:
            self._dragged = None

        model.on_event(PanStart, begin)
        model.on_event(Pan, go_on)
        model.on_event(PanEnd, end)

    def _mark_at(self, x: float, y: float) -> str | None:
        """Return the mark at a point [m]; None if there is none."""
        x_min, y_min, x_max, y_max = self._plan.bounds
        distance_m = np.hypot(*(np.array(_positions(self._plan)) - (x, y)).T)
        nearest = int(np.argmin(distance_m))
        reach_m = MARK_REACH * max(x_max - x_min, y_max - y_min)
        return MARKS[nearest] if distance_m[nearest] < reach_m else None


def _positions(plan: FloorPlan) -> tuple[tuple[float, float], tuple[float, float]]:
    """Positions (x, y) [m] of source and start."""
    return plan.require_source()[:2], plan.require_start()


def _columns(plan: FloorPlan) -> dict[str, Any]:
    """Data columns of the source and start marks."""
    x, y = zip(*_positions(plan), strict=True)
    return {
        "x": list(x),
        "y": list(y),
        "marker": ["star", "circle"],
        "size": [26, 17],
        "colour": [SOURCE, START],
    }


def are_numbers(*values: object) -> bool:
    """Whether all values, which come from the browser, are finite numbers."""
    return all(isinstance(value, int | float) and is_finite(value) for value in values)
