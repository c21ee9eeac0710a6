"""The page's HTML and styles, and the HTML of the words on it.

Widgets live in shadow trees of their own, which the page's style sheet does not reach; so each is
given one, `WIDGETS`.
"""

from html import escape
from importlib import resources

import numpy as np

from floorplans import FloorPlan
from rssnav.explorer.tracing import TracedMap


def _text(name: str) -> str:
    return (resources.files("rssnav.explorer") / name).read_text(encoding="utf-8")


PAGE = _text("page.html")
PAGE_CSS = _text("page.css")
WIDGETS = [_text("widgets.css")]
FRAME = ":host, :host > div { height: 100%; width: 100%; }"
"""Style of a pane that a frame fills."""

THIN_SPACE = "\u2009"
MINUS = "\u2212"


def problem(text: str) -> str:
    """Say what went wrong."""
    return f'<p class="problem" role="alert">{escape(text)}</p>'


def pairs(rows: list[tuple[str, str]]) -> str:
    """List names and values."""
    return "<dl>" + "".join(f"<dt>{escape(a)}</dt><dd>{escape(b)}</dd>" for a, b in rows) + "</dl>"


def progress_bar(share: float | None, what: str) -> str:
    """Say what is being done, and which share of it is; None where nobody can tell."""
    value = "" if share is None else f' value="{share:.3f}"'
    percent = "" if not share else f" {round(100 * share)} %"
    return f"<div>{escape(what)}{percent}</div><progress{value}></progress>"


def plan_words(plan: FloorPlan) -> str:
    """Name a plan and its size."""
    x_min, y_min, x_max, y_max = plan.bounds
    size = f"{x_max - x_min:g} \u00d7 {y_max - y_min:g} \u00d7 {plan.height_m:g} m"
    walls = f"{len(plan.walls)} walls"
    return f'<b>{escape(plan.name)}</b> <span class="quiet">{size}, {walls}</span>'


def map_words(traced: TracedMap) -> str:
    """Say what a map holds."""
    radio_map = traced.radio_map
    lit = radio_map.rss_dbm[np.isfinite(radio_map.rss_dbm)]
    parts = [f"{thousands(radio_map.rss_dbm.size)} cells"]
    if lit.size:
        parts.append(f"{decibels(lit.min(), '')}to {decibels(lit.max())}")
    parts.append(f"{thousands(int(radio_map.path_count.sum()))} paths")
    parts.append(f"traced in {radio_map.provenance['wall_time_s']:.1f} s")
    if not traced.complete:
        parts.append("without diffraction")
    return f'<span class="quiet">{", ".join(parts)}</span>'


def thousands(number: int) -> str:
    """Write a number with thin spaces between its thousands."""
    return f"{number:,}".replace(",", THIN_SPACE)


def decibels(value: float, unit: str = "dBm") -> str:
    """Write a level with one decimal and a true minus; "no path" for -inf."""
    return "no path" if np.isneginf(value) else f"{value:.1f} {unit}".replace("-", MINUS)
