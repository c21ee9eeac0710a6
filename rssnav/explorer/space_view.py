"""The view in three dimensions: the building, the map on its floor, paths and flights."""

from __future__ import annotations

from html import escape

import numpy as np
import trimesh
from bokeh.palettes import Viridis256
from matplotlib.colors import to_rgba_array
from numpy.typing import NDArray
from PIL import Image
from trimesh.visual import TextureVisuals
from trimesh.visual.material import PBRMaterial

from floorplans import FloorPlan
from floorplans.mesh import mesh_of
from floorplans.pictures.viewer_3d import (
    Y_UP,
    ColourBar,
    add_lines,
    add_points,
    marker_radius_m,
    plan_scene,
    scene_html,
)
from raytrace import Grid, RadioMap
from rssnav.explorer.cell_paths import CellPaths, path_colours, strongest
from rssnav.explorer.space_flights import script
from rssnav.explorer.tracing import TracedMap
from rssnav.maps import cells_inside
from rssnav.pictures.radio_map import NO_PATH
from rssnav.pictures.style import INK

LINE_RADIUS = 0.002
"""Radius of a path, as a fraction of the plan's diagonal; a flight is twice as thick."""
OPACITY = 0.3
LIFT_M = 0.01
"""Height of the map above the floor."""
TEXTURE_PX = 1024
"""Least size of the map's picture: its cells have sharp edges."""


def page_3d(
    plan: FloorPlan, found: CellPaths | None = None, traced: TracedMap | None = None
) -> str:
    """HTML of a frame with the plan.

    Parameters
    ----------
    plan : FloorPlan
    found : CellPaths, optional
        Paths of which the strongest are drawn.
    traced : TracedMap, optional
        Map to lay on the floor; with it the frame shows the flights that it is sent.
    """
    scene = plan_scene(plan, opacity=OPACITY)
    x_min, y_min, x_max, y_max = plan.bounds
    radius_m = LINE_RADIUS * float(np.hypot(x_max - x_min, y_max - y_min))
    title, bar, flights = plan.name, None, ""
    if traced is not None:
        bar = _add_map(scene, plan, traced.radio_map)
        grid = traced.radio_map.grid
        flights = script(grid.height_m, 2 * radius_m, _corners(grid))
    if found is not None:
        lines = strongest(found)
        add_lines(scene, "paths", lines, path_colours(found.power_dbm[: len(lines)]), radius_m)
        add_points(scene, "receiver", [found.receiver], INK, marker_radius_m(plan))
        x, y, z = found.receiver
        title = f"{plan.name}: paths to ({x:g}, {y:g}, {z:g}) m"
    page = escape(scene_html(scene, title, bar).replace("</body>", f"{flights}</body>"))
    style = "width:100%;height:100%;border:0;border-radius:8px"
    return f'<iframe title="3D" sandbox="allow-scripts" srcdoc="{page}" style="{style}"></iframe>'


def map_picture(radio_map: RadioMap, inside: NDArray[np.bool_]) -> NDArray[np.uint8]:
    """Picture (n_y, n_x, 4) of a map, north up: RSS in colour, grey without a path, clear outside.

    Parameters
    ----------
    radio_map : RadioMap
    inside : (n_y, n_x) bool
        Cells within the building.
    """
    rss, covered = radio_map.rss_dbm, np.isfinite(radio_map.rss_dbm)
    low, high = _levels(radio_map)
    share = np.where(covered, rss - low, 0.0) / max(high - low, 1e-9)
    colours = (255 * to_rgba_array(Viridis256)).astype(np.uint8)
    picture = colours[np.clip(256 * share, 0, 255).astype(np.int64)]
    picture[~covered] = (255 * to_rgba_array(NO_PATH)[0]).astype(np.uint8)
    picture[~inside & ~covered, 3] = 0
    return picture[::-1]


def _glowing(picture: NDArray[np.uint8]) -> PBRMaterial:
    """Material with exactly the colours of a picture (n, m, 4), whatever the light.

    glTF stores textures in sRGB, while the viewer shows linear values as they are.
    """
    linear = picture[..., :3] / 255.0
    stored = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    black = np.concatenate([np.zeros_like(picture[..., :3]), picture[..., 3:]], axis=-1)
    return PBRMaterial(
        baseColorTexture=Image.fromarray(black),
        emissiveTexture=Image.fromarray((255 * stored).round().astype(np.uint8)),
        emissiveFactor=(1.0, 1.0, 1.0),
        alphaMode="MASK",  # drawn before what is transparent, so that walls are seen over it
        alphaCutoff=0.5,
        doubleSided=True,
        metallicFactor=0.0,
        roughnessFactor=1.0,
    )


def _levels(radio_map: RadioMap) -> tuple[float, float]:
    """Lowest and highest RSS [dBm] of a map; equal in one without a path."""
    covered = radio_map.rss_dbm[np.isfinite(radio_map.rss_dbm)]
    return (float(covered.min()), float(covered.max())) if covered.size else (0.0, 0.0)


def _corners(grid: Grid) -> tuple[float, float, float, float]:
    """x_min, y_min, x_max, y_max of all cells [m]."""
    half = 0.5 * grid.cell_size_m
    (x0, x1), (y0, y1) = ((float(at[0]) - half, float(at[-1]) + half) for at in (grid.x, grid.y))
    return x0, y0, x1, y1


def _add_map(scene: trimesh.Scene, plan: FloorPlan, radio_map: RadioMap) -> ColourBar:
    """Lay a map on the floor; return the legend of its colours."""
    picture = map_picture(radio_map, cells_inside(plan, radio_map.grid))
    scale = max(1, TEXTURE_PX // max(picture.shape[:2]))
    sharp = picture.repeat(scale, axis=0).repeat(scale, axis=1)
    x0, y0, x1, y1 = _corners(radio_map.grid)
    corners = np.array([(x0, y0), (x1, y0), (x1, y1), (x0, y1)])
    triangles = np.array([(0, 1, 2), (0, 2, 3)])
    raised = np.column_stack([corners, np.full(4, LIFT_M)])
    mesh = mesh_of(raised[triangles])
    material = _glowing(sharp)
    shares = (corners - corners[0]) / (corners[2] - corners[0])
    mesh.visual = TextureVisuals(uv=shares[triangles].reshape(-1, 2), material=material)
    scene.add_geometry(mesh, node_name="map", geom_name="map", transform=Y_UP)
    low, high = _levels(radio_map)
    return ColourBar(Viridis256[::16], f"{low:.0f}", f"{high:.0f}", "RSS [dBm]")
