"""Widgets for numbers, and their values checked on the server."""

from collections.abc import Mapping
from typing import Any

import panel as pn

from rssnav.explorer.ranges import Range
from rssnav.explorer.styles import WIDGETS

WIDE, NARROW = 152, 98
"""Widths of widgets: two or three in a row [px]."""
MARGIN = (3, 5)


def number_input(allowed: Range, width: int = WIDE, **options: Any) -> Any:
    """Return a widget for a number in a range."""
    kind, number = (pn.widgets.IntInput, int) if allowed.whole else (pn.widgets.FloatInput, float)
    return kind(
        label=allowed.label,
        start=number(allowed.low),
        end=number(allowed.high),
        step=number(allowed.step),
        stylesheets=WIDGETS,
        width=width,
        margin=MARGIN,
        **options,
    )


def select(label: str, options: Mapping[str, Any] | None = None) -> Any:
    """Return a widget for one of several choices."""
    return pn.widgets.Select(
        label=label,
        options=dict(options or {}),
        stylesheets=WIDGETS,
        width=WIDE,
        margin=MARGIN,
    )


def flow(*widgets: Any) -> Any:
    """Return widgets in a row, or in several where they do not fit."""
    return pn.FlexBox(*widgets, gap="0px 4px", margin=(0, 5), sizing_mode="stretch_width")


def heading(title: str) -> Any:
    """Return the heading of a part of a panel."""
    return pn.pane.HTML(f"<h2>{title}</h2>", stylesheets=WIDGETS, margin=(0, 10))


def checked_values(inputs: Mapping[str, Any], ranges: Mapping[str, Range]) -> dict[str, Any]:
    """Values of widgets, by name; raise ValueError for one out of its range."""
    values = {name: widget.value for name, widget in inputs.items()}
    for name, allowed in ranges.items():
        allowed.check(values[name])
    return values
