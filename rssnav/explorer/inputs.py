"""Widgets for numbers, and their values checked on the server."""

from collections.abc import Mapping
from typing import Any

import panel as pn

from rssnav.explorer.ranges import Range
from rssnav.explorer.styles import WIDGETS


def number_input(allowed: Range, **options: Any) -> Any:
    """Return a widget for a number in a range."""
    kind, number = (pn.widgets.IntInput, int) if allowed.whole else (pn.widgets.FloatInput, float)
    return kind(
        label=allowed.label,
        start=number(allowed.low),
        end=number(allowed.high),
        step=number(allowed.step),
        stylesheets=WIDGETS,
        width=152,
        margin=(3, 5),
        **options,
    )


def checked_values(inputs: Mapping[str, Any], ranges: Mapping[str, Range]) -> dict[str, Any]:
    """Values of widgets, by name; raise ValueError for one out of its range."""
    values = {name: widget.value for name, widget in inputs.items()}
    for name, allowed in ranges.items():
        allowed.check(values[name])
    return values
