"""A plan in three dimensions: translucent walls on a light floor, in parallel projection."""

from itertools import product

import numpy as np
from matplotlib.colors import to_rgb
from matplotlib.lines import Line2D
from mpl_toolkits.mplot3d import Axes3D
from mpl_toolkits.mplot3d.art3d import Poly3DCollection
from numpy.typing import NDArray

from floorplans.mesh import panel_corners, slab_triangles
from floorplans.pictures.legend import marker_handles, markers, material_handles
from floorplans.plan import FloorPlan
from floorplans.walls import Panel, Wall, panels

LIGHT = np.array([0.35, -0.85])
"""Direction the walls are lit from, in the plan view."""

ELEVATION_DEG = 42
AZIMUTH_DEG = -76
"""Direction of the camera: above the horizon, and counter-clockwise from the x axis [degrees]."""

FILL = np.array([0.92, 0.8])
"""Fractions of the axes' width and height for the plan; the rest is for legend and text."""

ALPHA = 0.72
GLASS_ALPHA = 0.35
MARKER_HEIGHT = 1.6
"""Height of the markers of source and start, in ceiling heights."""

FLOOR = "#f1eee6"


def draw_plan_3d(plan: FloorPlan, ax: Axes3D) -> None:
    """Draw a plan's walls in parallel projection, true to scale, without ceiling.

    Parameters
    ----------
    plan : FloorPlan
    ax : mpl_toolkits.mplot3d.Axes3D
        Made by ``figure.add_subplot(projection="3d")``.
    """
    ax.computed_zorder = False
    _draw_floor(plan, ax)
    _draw_panels(plan, ax)
    _draw_markers(plan, ax)
    _draw_dimensions(plan, ax)
    _set_up_camera(plan, ax)
    _draw_frame_and_legend(plan, ax)


def _draw_floor(plan: FloorPlan, ax: Axes3D) -> None:
    triangles = slab_triangles(plan.outline, 0.0)
    floor = Poly3DCollection(triangles, facecolors=FLOOR, edgecolors=FLOOR, linewidths=0.5)
    floor.set_clip_on(False)
    floor.set_gid("floor")
    floor.set_zorder(0)
    ax.add_collection3d(floor)


def _draw_panels(plan: FloorPlan, ax: Axes3D) -> None:
    parts = [(wall, panel) for wall in plan.walls for panel in panels(wall)]
    shades = np.array([_shade(plan, wall, panel) for wall, panel in parts])
    collection = Poly3DCollection(
        [panel_corners(wall, panel) for wall, panel in parts],
        facecolors=shades,
        edgecolors=0.6 * shades[:, :3],
        linewidths=0.4,
        clip_on=False,
    )
    collection.set_gid("walls")
    collection.set_zorder(1)
    ax.add_collection3d(collection)


def _shade(plan: FloorPlan, wall: Wall, panel: Panel) -> NDArray[np.float64]:
    """Colour (r, g, b, a) of a panel: lighter the more its wall faces the light; lintels darker."""
    along = (np.array(wall.end) - np.array(wall.start)) / wall.length_m
    facing = abs(along[0] * LIGHT[1] - along[1] * LIGHT[0])
    lightness = 0.75 + 0.35 * facing - (0.15 if panel.z_min > 0 else 0.0)
    colour = np.clip(lightness * np.array(to_rgb(plan.colour_of(panel.material))), 0, 1)
    return np.append(colour, GLASS_ALPHA if panel.material == "glass" else ALPHA)


def _draw_markers(plan: FloorPlan, ax: Axes3D) -> None:
    """Draw source, transmitters and start as pins that extend above the walls."""
    top = MARKER_HEIGHT * plan.height_m
    for mark, (x, y, z) in markers(plan):
        colour = mark.get_color()
        (stem,) = ax.plot([x, x], [y, y], [z, top], color=colour, lw=1.2, zorder=2)
        (head,) = ax.plot([x], [y], [top], marker=mark.get_marker(), color=colour, zorder=3)
        head.set(gid=mark.get_gid(), markersize=mark.get_markersize(), markeredgecolor="white")
        stem.set(clip_on=False, in_layout=False)
        head.set(clip_on=False, in_layout=False)


def _draw_dimensions(plan: FloorPlan, ax: Axes3D) -> None:
    x_min, y_min, x_max, y_max = plan.bounds
    gap = 0.045 * max(x_max - x_min, y_max - y_min)
    ax.text((x_min + x_max) / 2, y_min - gap, 0, f"{x_max - x_min:g} m", ha="center", va="top")
    ax.text(x_max + gap, (y_min + y_max) / 2, 0, f"{y_max - y_min:g} m", ha="left", va="center")


def _set_up_camera(plan: FloorPlan, ax: Axes3D) -> None:
    x_min, y_min, x_max, y_max = plan.bounds
    ax.set_xlim(x_min, x_max)
    ax.set_ylim(y_min, y_max)
    ax.set_zlim(0, plan.height_m)
    ax.set_proj_type("ortho")
    ax.view_init(elev=ELEVATION_DEG, azim=AZIMUTH_DEG)
    ax.set_axis_off()
    box = (x_max - x_min, y_max - y_min, plan.height_m)
    ax.set_box_aspect(box)
    ax.set_box_aspect(box, zoom=_zoom_to_fit(plan, ax))  # pyright: ignore[reportArgumentType]


def _zoom_to_fit(plan: FloorPlan, ax: Axes3D) -> float:
    """Return the zoom at which the plan fills the axes' whole rectangle, not only its square."""
    figure = ax.get_figure(root=False)
    assert figure is not None
    rectangle = ax.get_position(original=True).transformed(figure.transSubfigure)
    available = np.array([rectangle.width, rectangle.height]) / min(rectangle.size)
    spans = np.ptp(_projected_corners(plan, ax), axis=0) / ax.viewLim.width
    return float(np.min(FILL * available / spans))


def _projected_corners(plan: FloorPlan, ax: Axes3D) -> NDArray[np.float64]:
    """Corners of the box around the plan and its pins, projected; (8, 2), for `ax.transData`."""
    x_min, y_min, x_max, y_max = plan.bounds
    corners = product((x_min, x_max), (y_min, y_max), (0, MARKER_HEIGHT * plan.height_m), (1,))
    projected = np.array(list(corners)) @ ax.get_proj().T
    return projected[:, :2] / projected[:, 3:]


def _draw_frame_and_legend(plan: FloorPlan, ax: Axes3D) -> None:
    """Draw the legend below the plan, and an invisible line as wide as the plan for layouts."""
    corners = _projected_corners(plan, ax)
    pad = 0.06 * np.ptp(corners[:, 0])
    low, high = corners.min(axis=0) - pad, corners.max(axis=0) + pad
    frame = Line2D([low[0], high[0]], [low[1], high[1]], linestyle="none", clip_on=False)
    ax.add_artist(frame)
    handles = [*marker_handles(plan), *material_handles(plan)]
    ax.legend(
        handles=handles,
        loc="upper center",
        bbox_to_anchor=((low[0] + high[0]) / 2, low[1] + pad / 2),
        bbox_transform=ax.transData,
        ncols=min(len(handles), 4),
        frameon=False,
        fontsize="medium",
    )
