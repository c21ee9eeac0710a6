"""Paths in their plan, coloured by power: from above, or in 3D."""

import textwrap
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from numpy.typing import NDArray

from floorplans import FloorPlan
from floorplans.pictures.viewer_3d import ColourBar, add_lines, add_points, plan_scene, save_scene
from raytrace import Paths
from raytrace.kernels.path_points import DIFFRACTION, REFLECTION
from rssnav.pictures.radio_map import draw_walls, plan_height_in, plan_width_in, set_limits
from rssnav.pictures.style import INK, draw_transmitter, save_picture, styled

COLOUR_MAP = "plasma_r"
"""Strong paths are dark: they must stand out on a light background."""

RECEIVER = "#0b8f5a"
WALL_OPACITY = 0.35
POWER_LABEL = "power of the path [dBm]"
MARKS = {REFLECTION: ("o", "reflection"), DIFFRACTION: ("D", "diffraction")}


def path_lines(paths: Paths) -> list[NDArray[np.float64]]:
    """Vertices (n_vertices, 3) [m] of each path, from the transmitter to the receiver."""
    ends = paths.n_interactions + 2
    return [vertices[:end] for vertices, end in zip(paths.vertices, ends, strict=True)]


def power_scale(powers_dbm: NDArray[np.float64]) -> Normalize:
    """Scale from the weakest to the strongest power [dBm], at least 1 dB wide."""
    finite = powers_dbm[np.isfinite(powers_dbm)]
    high = float(finite.max(initial=-np.inf)) if len(finite) else 0.0
    low = float(finite.min(initial=np.inf)) if len(finite) else -1.0
    return Normalize(min(low, high - 1.0), high)


def draw_paths(plan: FloorPlan, paths: Paths, power_dbm: float, ax: Axes) -> ScalarMappable:
    """Draw paths and the plan's walls from above, the strongest path on top.

    Parameters
    ----------
    plan : FloorPlan
    paths : Paths
        Paths to one receiver, strongest first.
    power_dbm : float
        Transmit power [dBm].
    ax : matplotlib.axes.Axes
        Axes of the drawing, which become x and y [m].

    Returns
    -------
    matplotlib.cm.ScalarMappable
        For the colour bar.
    """
    powers = power_dbm + paths.gain_db
    scale = power_scale(powers)
    draw_walls(plan, float(paths.vertices[0, -1, 2]), ax)
    weakest_first = LineCollection(
        [line[:, :2] for line in path_lines(paths)[::-1]],
        array=powers[::-1], cmap=COLOUR_MAP, norm=scale, linewidths=1.0, zorder=4,
    )  # fmt: skip
    weakest_first.set_gid("paths")
    ax.add_collection(weakest_first, autolim=False)
    _draw_interactions(paths, powers, scale, ax)
    position = _position(paths.vertices[0, 0])
    draw_transmitter(ax, position, "source" if position == plan.source else "transmitter")
    x, y = paths.vertices[0, -1, :2]
    ax.plot(
        [x], [y], "^", color=RECEIVER, markeredgecolor="white", markersize=8, zorder=7,
        label="receiver", gid="receiver",
    )  # fmt: skip
    set_limits(plan, ax)
    ax.set_aspect("equal")
    ax.set(xlabel="$x$ [m]", ylabel="$y$ [m]")
    return weakest_first


def _position(vertex: NDArray[np.float64]) -> tuple[float, float, float]:
    x, y, z = vertex.tolist()
    return x, y, z


def _draw_interactions(
    paths: Paths, powers: NDArray[np.float64], scale: Normalize, ax: Axes
) -> None:
    """Mark reflections and diffractions in the colours of the paths' powers."""
    for kind, (mark, label) in MARKS.items():
        path, place = np.nonzero(paths.interactions == kind)
        if not len(path):
            continue
        x, y, _ = paths.vertices[path, place + 1].T
        ax.scatter(
            x, y, c=powers[path], cmap=COLOUR_MAP, norm=scale, marker=mark, s=9, linewidths=0.4,
            edgecolors=INK, zorder=5, clip_on=False, label=label, gid=label,
        )  # fmt: skip


@styled
def paths_figure(plan: FloorPlan, paths: Paths, power_dbm: float, title: str) -> Figure:
    """Return the picture of `draw_paths` with colour bar, legend and title."""
    width_in = plan_width_in(plan)
    lines = textwrap.wrap(title, int(width_in * 17))
    figure = Figure(
        (width_in, plan_height_in(plan, width_in, len(lines) + 2)),
        layout=ConstrainedLayoutEngine(w_pad=0.05, h_pad=0.05),
    )
    ax = figure.add_subplot()
    drawn = draw_paths(plan, paths, power_dbm, ax)
    figure.colorbar(drawn, ax=ax, label=POWER_LABEL, pad=0.02, aspect=25)
    figure.suptitle("\n".join(lines), x=0.01, ha="left", fontsize="medium", parse_math=False)
    handles, _ = ax.get_legend_handles_labels()
    figure.legend(handles=handles, loc="outside lower center", ncols=4)
    return figure


def save_paths_picture(
    plan: FloorPlan, paths: Paths, power_dbm: float, title: str, path: str | Path
) -> None:
    """Draw paths into a file, written atomically.

    Parameters
    ----------
    plan, paths, power_dbm
        As for `draw_paths`.
    title : str
        Written above the picture.
    path : str or Path
        Its suffix names the format: .png, .svg or .pdf from above; .glb or .html (an interactive
        page that needs no network) in 3D.
    """
    if Path(path).suffix.lower() in (".glb", ".html"):
        _save_scene(plan, paths, power_dbm, title, path)
    else:
        save_picture(paths_figure(plan, paths, power_dbm, title), path)


def _save_scene(
    plan: FloorPlan, paths: Paths, power_dbm: float, title: str, path: str | Path
) -> None:
    powers = power_dbm + paths.gain_db
    scale = power_scale(powers)
    colours = mpl.colormaps[COLOUR_MAP]
    scene = plan_scene(plan, opacity=WALL_OPACITY)
    add_lines(scene, "paths", path_lines(paths), [*colours(scale(powers))])
    add_points(scene, "receiver", [paths.vertices[0, -1]], RECEIVER)
    bar = ColourBar(
        [*colours(np.linspace(0.0, 1.0, 9))],
        f"{scale.vmin:.1f}", f"{scale.vmax:.1f}", POWER_LABEL,
    )  # fmt: skip
    save_scene(scene, path, title, bar)
