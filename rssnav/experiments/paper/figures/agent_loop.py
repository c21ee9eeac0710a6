"""Figure: interaction of the RSS-based agent and its environment."""

from __future__ import annotations

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import FancyArrowPatch, FancyBboxPatch
from matplotlib.path import Path

from rssnav.experiments.paper.data import PaperData
from rssnav.experiments.paper.figures.paper_figure import PaperFigure
from rssnav.pictures.style import AGENT_COLOURS, COLUMN_IN, INK, shade, styled

_HEIGHT_IN = 1.85
_LEFT, _RIGHT, _BOX_HEIGHT = 0.75, 2.75, 0.46
_AGENT_FOOT, _ENVIRONMENT_FOOT = 1.34, 0.05
_SENSED = (
    (0.12, "state", r"$s_{t+1} \leftarrow \mathrm{RSS}_{t+1}$"),
    (-0.12, "reward", r"$r_{t+1} = \mathrm{RSS}_{t+1} - \mathrm{RSS}_t$"),
)
"""Arrows back to the agent: height above the boxes' middle [inch], name, meaning."""

Point = tuple[float, float]


@styled
def draw(_data: PaperData | None = None) -> Figure:
    """Draw agent, environment, and the arrows of action, reward and state between them."""
    figure = Figure(figsize=(COLUMN_IN, _HEIGHT_IN))
    ax = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    ax.set(xlim=(0.0, COLUMN_IN), ylim=(0.0, _HEIGHT_IN))
    ax.set_axis_off()
    blue = AGENT_COLOURS["rss"]
    _box(ax, _AGENT_FOOT, blue, "Agent (UAV)", r"table $Q(s, a)$, $\epsilon$-greedy choice")
    _box(ax, _ENVIRONMENT_FOOT, INK, "Environment", "building and radio field of the source")
    _draw_action(ax)
    _draw_sensed(ax, blue)
    return figure


def _draw_action(ax: Axes) -> None:
    """Draw the arrow from agent to environment on the right."""
    top, foot, x = _AGENT_FOOT + _BOX_HEIGHT / 2, _ENVIRONMENT_FOOT + _BOX_HEIGHT / 2, 3.1
    _arrow(ax, [(_RIGHT, top), (x, top), (x, foot), (_RIGHT, foot)], INK)
    middle = (top + foot) / 2
    ax.text(x - 0.06, middle + 0.1, "action $a_t$:", ha="right", va="center")
    ax.text(x - 0.06, middle - 0.1, "1 of 8 headings", ha="right", va="center")


def _draw_sensed(ax: Axes, colour: str) -> None:
    """Draw the arrows from environment to agent on the left: inner state, outer reward."""
    middle = (_AGENT_FOOT + _ENVIRONMENT_FOOT + _BOX_HEIGHT) / 2
    for k, (rise, name, meaning) in enumerate(_SENSED):
        x = 0.4 - 0.2 * k
        top = _AGENT_FOOT + _BOX_HEIGHT / 2 - rise
        foot = _ENVIRONMENT_FOOT + _BOX_HEIGHT / 2 + rise
        _arrow(ax, [(_LEFT, foot), (x, foot), (x, top), (_LEFT, top)], colour)
        ax.text(x + 0.025, middle, name, color=colour, rotation=90, ha="left", va="center")
        ax.text(0.64, middle + 0.2 - 0.2 * k, meaning, color=colour, va="center")
    ax.text(0.64, middle - 0.2, "(+1000 at the source)", color=colour, va="center")


def _box(ax: Axes, foot: float, colour: str, name: str, inside: str) -> None:
    box = FancyBboxPatch(
        (_LEFT, foot),
        _RIGHT - _LEFT,
        _BOX_HEIGHT,
        boxstyle="round,pad=0,rounding_size=0.06",
        facecolor=shade(colour, 0.9),
        edgecolor=colour,
        linewidth=0.9,
    )
    ax.add_patch(box)
    x, y = (_LEFT + _RIGHT) / 2, foot + _BOX_HEIGHT / 2
    ax.text(x, y + 0.1, name, ha="center", va="center", weight="bold")
    ax.text(x, y - 0.1, inside, ha="center", va="center")


def _arrow(ax: Axes, corners: list[Point], colour: str) -> None:
    """Draw an arrow along a polyline."""
    arrow = FancyArrowPatch(
        path=Path(corners),
        arrowstyle="-|>,head_length=4,head_width=2",
        color=colour,
        linewidth=1.0,
        joinstyle="round",
    )
    ax.add_patch(arrow)


def caption(_data: PaperData) -> str:
    """Return the caption."""
    return (
        "The RSS-based agent senses only the RSS: its value names the state, its change since the "
        "last position is the reward, and more than −21 dBm means that the source is found. The "
        "location-based agent has (x, y) as its state and 1/D as its reward instead."
    )


FIGURE = PaperFigure("agent_loop", "Agent and environment", "the paper's Fig. 2", draw, caption)
