"""The style of all figures: sizes, fonts, colours, and shared parts.

Figures use matplotlib's object interface (no pyplot, no global figure), the widths of a two-column
IEEE page, and 8 pt type. An agent has the same colour in every figure; maps use viridis. The
colours can be told apart by colour-blind readers and in print. PDF embeds its fonts, SVG keeps text
as text. `chosen_style` applies a matplotlib style on top.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Sequence
from contextlib import contextmanager, nullcontext
from contextvars import ContextVar
from functools import wraps
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any, ParamSpec

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection
from matplotlib.colors import Normalize, to_rgb
from matplotlib.figure import Figure
from matplotlib.image import AxesImage
from matplotlib.lines import Line2D
from matplotlib.patheffects import withStroke
from matplotlib.style import available, context
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from atomicfiles import atomic_write, atomic_write_all
from floorplans.pictures.plan_view import PAGE_IN as PAGE_IN

if TYPE_CHECKING:
    from floorplans import FloorPlan
    from raytrace import Grid

COLUMN_IN = 3.5
"""Width of one column [inch]."""

DPI = 300

AGENT_COLOURS = {"rss": "#0072b2", "location": "#d55e00"}
OTHER_AGENT = "#cc79a7"
INK = "#1a1a1a"
FAINT = "#8a8a8a"
SOURCE = "#d81b60"
START = "#ffffff"
MAP_COLOURS = "viridis"

STYLE: dict[Any, Any] = {
    "font.family": "STIXGeneral",
    "mathtext.fontset": "stix",
    "font.size": 8.0,
    "axes.titlesize": 8.0,
    "axes.labelsize": 8.0,
    "xtick.labelsize": 8.0,
    "ytick.labelsize": 8.0,
    "legend.fontsize": 8.0,
    "axes.linewidth": 0.6,
    "axes.edgecolor": INK,
    "axes.labelcolor": INK,
    "text.color": INK,
    "xtick.color": INK,
    "ytick.color": INK,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "xtick.minor.width": 0.4,
    "ytick.minor.width": 0.4,
    "xtick.major.size": 2.5,
    "ytick.major.size": 2.5,
    "xtick.minor.size": 1.5,
    "ytick.minor.size": 1.5,
    "axes.titlelocation": "left",
    "axes.titlepad": 3.0,
    "axes.labelpad": 2.0,
    "legend.frameon": False,
    "legend.handlelength": 1.8,
    "lines.linewidth": 1.1,
    "grid.color": "#d9d9d9",
    "grid.linewidth": 0.4,
    "image.interpolation": "nearest",
    "pdf.fonttype": 42,
    "svg.fonttype": "none",
    "figure.constrained_layout.h_pad": 0.07,
    "figure.constrained_layout.w_pad": 0.04,
    "savefig.facecolor": "white",
    "svg.hashsalt": "rssnav",
}

_NO_DATE: dict[str, dict[str, None]] = {
    ".png": {"Software": None},
    ".svg": {"Date": None},
    ".pdf": {"CreationDate": None},
}

P = ParamSpec("P")

_CHOSEN: ContextVar[str | None] = ContextVar("matplotlib style", default=None)


@contextmanager
def chosen_style(style: str | None) -> Generator[None]:
    """Context manager: apply a user's matplotlib style on top of the project's.

    Parameters
    ----------
    style : str or None
        Name of a matplotlib style, ``package.name`` of an installed one, or the path of a
        ``.mplstyle`` file; None for the project's style alone.

    Raises
    ------
    ValueError
        For a style that does not exist.
    """
    if style is not None:
        check_style(style)
    token = _CHOSEN.set(style)
    try:
        yield
    finally:
        _CHOSEN.reset(token)


def check_style(style: str) -> None:
    """Raise ValueError unless matplotlib knows a style; URLs are rejected."""
    try:
        if "://" in style:
            raise OSError
        with context(style):
            return
    except OSError as error:
        raise ValueError(
            f"{style!r} is not a matplotlib style; give the path of a .mplstyle file, or one of "
            f"{', '.join(name for name in available if not name.startswith('_'))}"
        ) from error


@contextmanager
def drawing() -> Generator[None]:
    """Context manager: apply the project's style, then the chosen one."""
    style = _CHOSEN.get()
    with rc_context(STYLE), nullcontext() if style is None else context(style):
        yield


def styled(draw: Callable[P, Figure]) -> Callable[P, Figure]:
    """Decorate a function that draws a figure, to draw it in the project's style."""

    @wraps(draw)
    def draw_in_style(*args: P.args, **kwargs: P.kwargs) -> Figure:
        with drawing():
            return draw(*args, **kwargs)

    return draw_in_style


def new_figure(width_in: float, height_in: float, *, maps: bool = False) -> Figure:
    """Return an empty figure whose axes do not overlap; ``maps`` for a grid of maps to scale."""
    layout = "compressed" if maps else "constrained"
    return Figure(figsize=(width_in, height_in), layout=layout)


def png_bytes(figure: Figure, dpi: float = DPI) -> bytes:
    """Return a figure as a PNG file's content."""
    buffer = BytesIO()
    with drawing():
        figure.savefig(buffer, format="png", dpi=dpi, metadata={"Software": None})
    return buffer.getvalue()


def save_picture(figure: Figure, path: str | Path) -> None:
    """Write a figure to a file (.png, .svg or .pdf) atomically."""
    with atomic_write(path) as beside, drawing():
        figure.savefig(beside, dpi=DPI, metadata=_NO_DATE[beside.suffix.lower()])


def save_figure(figure: Figure, stem: Path) -> bytes:
    """Write a figure to ``stem`` + .png and .pdf atomically; return the PNG's content."""
    png, pdf = png_bytes(figure), BytesIO()
    figure.set_layout_engine("none")  # the PDF has the layout of the PNG
    with drawing():
        figure.savefig(pdf, format="pdf", metadata={"CreationDate": None})
    atomic_write_all(
        {
            stem.with_name(f"{stem.name}.png"): png,
            stem.with_name(f"{stem.name}.pdf"): pdf.getvalue(),
        }
    )
    return png


def shade(colour: str, lightness: float) -> tuple[float, float, float]:
    """Mix a colour with white (``lightness`` in 0..1) or with black (in -1..0)."""
    target = 1.0 if lightness > 0.0 else 0.0
    mixed = np.array(to_rgb(colour)) * (1.0 - abs(lightness)) + target * abs(lightness)
    red, green, blue = (float(part) for part in mixed)
    return red, green, blue


def label_panel(ax: Axes, letter: str, title: str = "") -> None:
    """Write "(a) title" above a panel."""
    ax.set_title(f"({letter}) {title}".rstrip())


def draw_cells(
    ax: Axes,
    grid: Grid,
    values: NDArray[np.float64],
    *,
    norm: Normalize,
) -> AxesImage:
    """Draw a value per cell, true to scale, with axes in metres.

    Parameters
    ----------
    ax : matplotlib.axes.Axes
    grid : Grid
        Position and size of the cells.
    values : (n_y, n_x) float64, may be masked
        Value of each cell.
    norm : matplotlib.colors.Normalize
        Scale from values to colours.
    """
    half = grid.cell_size_m / 2
    extent = (grid.x[0] - half, grid.x[-1] + half, grid.y[0] - half, grid.y[-1] + half)
    image = ax.imshow(values, origin="lower", extent=extent, norm=norm, cmap=MAP_COLOURS)
    ax.set_aspect("equal")
    for axis, name in ((ax.xaxis, "$x$ [m]"), (ax.yaxis, "$y$ [m]")):
        axis.set_label_text(name)
        axis.set_major_locator(MaxNLocator(5, steps=[1, 2, 5, 10]))
    return image


def draw_colour_bar(
    figure: Figure, panels: Sequence[Axes], norm: Normalize, label: str, alpha: float = 1.0
) -> None:
    """Draw the colour bar of several panels on their right; the lowest values lie below it."""
    bar = figure.colorbar(
        ScalarMappable(norm, MAP_COLOURS),
        ax=panels,
        extend="min",
        pad=0.01,
        aspect=36,
        alpha=alpha,
    )
    bar.set_label(label)


def draw_solid_walls(ax: Axes, plan: FloorPlan, height_m: float) -> None:
    """Draw the walls that are solid at a height [m]."""
    walls = LineCollection(
        list(plan.solid_segments(height_m)), colors=INK, linewidths=0.7, capstyle="round"
    )
    walls.set_gid("walls")
    walls.set_clip_on(False)
    ax.add_collection(walls, autolim=False)


def draw_source(ax: Axes, plan: FloorPlan) -> Line2D:
    """Mark the source of a plan with a star."""
    return draw_transmitter(ax, plan.require_source(), "source")


def draw_transmitter(ax: Axes, position: tuple[float, float, float], label: str) -> Line2D:
    """Mark a position [m] with the star of sources and transmitters."""
    (mark,) = ax.plot(
        [position[0]],
        [position[1]],
        marker="*",
        markersize=9,
        color=SOURCE,
        markeredgecolor="white",
        markeredgewidth=0.7,
        linestyle="none",
        label=label,
        zorder=5,
        gid=label,
    )
    return mark


def draw_start(ax: Axes, plan: FloorPlan) -> Line2D:
    """Mark the start of a plan with a ring."""
    x, y = plan.require_start()
    (mark,) = ax.plot(
        [x],
        [y],
        marker="o",
        markersize=5,
        color=START,
        markeredgecolor=INK,
        markeredgewidth=0.9,
        linestyle="none",
        label="start",
        zorder=5,
        gid="start",
    )
    return mark


def agent_colour(agent: str) -> str:
    """Colour of an agent, by its name; agents other than the paper's share one."""
    return AGENT_COLOURS.get(agent, OTHER_AGENT)


def draw_flight(ax: Axes, positions: NDArray[np.float64], agent: str) -> Line2D:
    """Draw a flight through positions (n, 2) [m], in its agent's colour with a white outline."""
    (line,) = ax.plot(
        positions[:, 0],
        positions[:, 1],
        color=agent_colour(agent),
        linewidth=1.5,
        solid_joinstyle="round",
        path_effects=[withStroke(linewidth=2.7, foreground="white")],
        zorder=4,
        gid=f"flight:{agent}",
    )
    return line
