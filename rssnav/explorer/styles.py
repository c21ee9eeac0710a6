"""The page's HTML and styles, and HTML of the texts on it.

Widgets live in shadow trees, which the page's style sheet does not reach; each gets `WIDGETS`.
"""

from collections.abc import Sequence
from html import escape
from importlib import resources

import numpy as np

from floorplans import FloorPlan
from rssnav.explorer.survey_layer import Residuals
from rssnav.explorer.tracing import TracedMap


def _text(name: str) -> str:
    return (resources.files("rssnav.explorer") / name).read_text(encoding="utf-8")


PAGE = _text("page.html")
PAGE_CSS, PAGE_JS = _text("page.css"), _text("page.js")
WIDGETS = [_text("widgets.css")]
TABS = [*WIDGETS, ':host > [style*="visibility: hidden"] { height: 0; overflow: hidden; }']
"""Styles of tabs that are as high as the one that is open."""
FRAME = ":host, :host > div { height: 100%; width: 100%; }"
"""Style of a pane filled by a frame."""

THIN_SPACE = "\u2009"
MINUS = "\u2212"


def problem(text: str) -> str:
    """HTML of an error message."""
    return f'<p class="problem" role="alert">{escape(text)}</p>'


def pairs(rows: list[tuple[str, str]]) -> str:
    """HTML of a list of names and values."""
    return "<dl>" + "".join(f"<dt>{escape(a)}</dt><dd>{escape(b)}</dd>" for a, b in rows) + "</dl>"


def details(title: str, lines: Sequence[str]) -> str:
    """HTML of lines that are shown when one clicks their title; nothing for no lines."""
    if not lines:
        return ""
    items = "".join(f"<li>{escape(line)}</li>" for line in lines)
    return f"<details><summary>{escape(title)}</summary><ul>{items}</ul></details>"


def progress_bar(fraction: float | None, what: str) -> str:
    """HTML of a progress bar; None for an unknown fraction."""
    value = "" if fraction is None else f' value="{fraction:.3f}"'
    percent = "" if not fraction else f" {round(100 * fraction)} %"
    return f"<div>{escape(what)}{percent}</div><progress{value}></progress>"


def survey_words(found: Residuals) -> str:
    """HTML of how far traced RSS is off."""
    words = f"survey: {thousands(len(found.survey))} readings, sigma {found.sigma_db:.1f} dB"
    return f'<br><span class="quiet">{words}; red: measured above traced, blue: below</span>'


def plan_words(plan: FloorPlan) -> str:
    """HTML of a plan's name and size."""
    x_min, y_min, x_max, y_max = plan.bounds
    size = f"{x_max - x_min:g} \u00d7 {y_max - y_min:g} \u00d7 {plan.height_m:g} m"
    walls = f"{len(plan.walls)} walls"
    return f'<b>{escape(plan.name)}</b> <span class="quiet">{size}, {walls}</span>'


def map_words(traced: TracedMap) -> str:
    """HTML of a map's summary."""
    radio_map = traced.radio_map
    covered = radio_map.rss_dbm[np.isfinite(radio_map.rss_dbm)]
    parts = [f"{thousands(radio_map.rss_dbm.size)} cells"]
    if covered.size:
        parts.append(f"{decibels(covered.min(), '')}to {decibels(covered.max())}")
    parts.append(f"{thousands(int(radio_map.path_count.sum()))} paths")
    if traced.servers:
        parts.append(f"best of {len(traced.servers)} transmitters")
    parts.append(f"traced in {radio_map.provenance['wall_time_s']:.1f} s")
    if not traced.complete:
        parts.append("without diffraction")
    return f'<span class="quiet">{", ".join(parts)}</span>'


def thousands(number: int) -> str:
    """Format a number with thin spaces between thousands."""
    return f"{number:,}".replace(",", THIN_SPACE)


def decibels(value: float, unit: str = "dBm") -> str:
    """Format a level with one decimal and a minus sign; "no path" for -inf."""
    return "no path" if np.isneginf(value) else f"{value:.1f} {unit}".replace("-", MINUS)


def degrees(value: float) -> str:
    """Format an angle [deg] with one decimal and a minus sign."""
    return f"{round(value, 1) + 0.0:.1f}".replace("-", MINUS)
