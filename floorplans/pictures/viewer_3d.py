"""A plan in three dimensions: a GLB file, or an interactive HTML page.

>>> import floorplans
>>> from floorplans.pictures.viewer_3d import add_lines, plan_scene, save_scene
>>> scene = plan_scene(floorplans.load("flat"))
>>> add_lines(scene, "paths", [[(1, 1, 1), (2, 3, 2)]], "crimson")
>>> save_scene(scene, "flat.html")  # doctest: +SKIP

A scene is a `trimesh.Scene` with a node per material ("walls:brick"), y up as in glTF. The page
embeds three.js and works offline.
"""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from pathlib import Path
from typing import NamedTuple

import numpy as np
import trimesh
from matplotlib.colors import to_rgba_array
from matplotlib.typing import ColorType
from numpy.typing import ArrayLike, NDArray
from trimesh.exchange.gltf import export_glb
from trimesh.viewer.notebook import scene_to_html
from trimesh.visual import TextureVisuals
from trimesh.visual.material import PBRMaterial

from atomicfiles import atomic_write
from floorplans.mesh import Triangles, mesh_of, slab_triangles
from floorplans.pictures.legend import SOURCE, START
from floorplans.plan import FloorPlan

Y_UP = np.array(
    [[1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, -1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]]
)
"""Transforms (x, y, z) with z up to glTF's axes, y up."""

GLASS_OPACITY = 0.35
FLOOR_COLOUR = "#cfc9ba"
MARKER_RADIUS_M, MARKER_SHARE = 0.15, 0.006
"""Radius of source, transmitters and start, and at least as a fraction of the plan's diagonal."""

LINE_RADIUS_M = 0.02
CAMERA_PITCH_DEG = -50.0
FIELD_OF_VIEW_DEG = 45.0

_TUBE_SIDES = 5
_NARROW_PX = 600
_WIDE = 1.15
"""Width over height of a page that shows all of a scene with the camera's field of view."""

_MARGIN = 1.2
"""Half the height of a page over that of the scene, which the legends need."""

_NEARER, _FARTHER = 100.0, 20.0
"""How much one may come nearer and go farther; in a wider range sheets close to each other mix."""

_RAISED = 0.06
"""How much higher than the middle of a page the scene is, for the legend below it; a share."""

_FONT = "font:13px/1.5 sans-serif;pointer-events:none"
_OLD_TITLE = "<title>trimesh: threejs viewer</title>"
_PAGE_CHANGES = (
    (
        "scene.add(tracklight);",
        "scene.add(tracklight);scene.add(tracklight.target);tracklight.intensity=0.7;"
        "scene.add(new THREE.AmbientLight(0xffffff,0.6));",
    ),
    (
        "tracklight.position.copy(camera.position);",
        "tracklight.position.copy(camera.position);"
        "tracklight.target.position.copy(controls.target);",
    ),
    (
        "camera.aspect=window.innerWidth/window.innerHeight;",
        "camera.aspect=window.innerWidth/window.innerHeight;"
        "camera.fov=Math.atan(Math.max(TALL,WIDE/camera.aspect))*360/Math.PI;"
        "camera.setViewOffset(innerWidth,innerHeight,"
        f"0,{_RAISED}*innerHeight,innerWidth,innerHeight);",
    ),
)
"""Ambient light, a lamp that follows the view, and all of the scene on a page of any shape."""


def plan_scene(plan: FloorPlan, *, opacity: float = 1.0, ceiling: bool = False) -> trimesh.Scene:
    """Build the scene of a plan: walls by material, floor, source and start.

    Parameters
    ----------
    plan : FloorPlan
    opacity : float
        Of walls that are not glass, 0 to 1.
    ceiling : bool
        Whether to show the ceiling.
    """
    scene = trimesh.Scene()
    walls = plan.to_mesh()
    triangles = np.asarray(walls.mesh.triangles, dtype=np.float64)
    names = np.array([material.name for material in walls.materials])[walls.face_material]
    is_wall = np.ptp(triangles[:, :, 2], axis=1) > 0
    for name in dict.fromkeys(names[is_wall].tolist()):
        alpha = min(opacity, GLASS_OPACITY) if name == "glass" else opacity
        sheet = triangles[is_wall & (names == name)]
        add_triangles(scene, f"walls:{name}", sheet, plan.colour_of(name), alpha)
    add_triangles(scene, "floor", slab_triangles(plan.outline, 0.0), FLOOR_COLOUR)
    if ceiling:
        slab = slab_triangles(plan.outline, plan.height_m)
        add_triangles(scene, "ceiling", slab, plan.colour_of(plan.ceiling_material), 0.5)
    radius_m = marker_radius_m(plan)
    if plan.source is not None:
        add_points(scene, "source", [plan.source], SOURCE, radius_m)
    if plan.transmitters:
        places = [t.position for t in plan.transmitters]
        add_points(scene, "transmitters", places, SOURCE, radius_m)
    if plan.start is not None:
        add_points(scene, "start", [(*plan.start, radius_m)], START, radius_m)
    _set_camera(scene)
    return scene


def marker_radius_m(plan: FloorPlan) -> float:
    """Radius of a ball that is seen in the whole of a plan [m]."""
    x_min, y_min, x_max, y_max = plan.bounds
    return max(MARKER_RADIUS_M, MARKER_SHARE * float(np.hypot(x_max - x_min, y_max - y_min)))


def add_triangles(
    scene: trimesh.Scene, name: str, triangles: Triangles, colour: ColorType, opacity: float = 1.0
) -> None:
    """Add a double-sided sheet.

    Parameters
    ----------
    scene : trimesh.Scene
    name : str
        Of the node and of its material, shown by viewers.
    triangles : (n, 3, 3) array
        Triangle, corner, (x, y, z) [m], z up.
    colour : colour of matplotlib
    opacity : float
        0 to 1.
    """
    rgba = to_rgba_array(colour)[0] * (1.0, 1.0, 1.0, opacity)
    material = _material(name.rpartition(":")[2], rgba)
    mesh = mesh_of(triangles)
    mesh.visual = TextureVisuals(material=material)
    _add(scene, name, mesh)


def add_lines(
    scene: trimesh.Scene,
    name: str,
    lines: Sequence[ArrayLike],
    colours: ColorType | Sequence[ColorType],
    radius_m: float = LINE_RADIUS_M,
) -> None:
    """Add polylines as thin tubes, which every viewer shows with the same width.

    Parameters
    ----------
    scene : trimesh.Scene
    name : str
        Of the node.
    lines : sequence of (n_i, 3) arrays
        Vertices (x, y, z) of each line [m], z up.
    colours : colour of matplotlib, or one per line
    radius_m : float
        Of the tubes [m].
    """
    points = [np.asarray(line, dtype=np.float64).reshape(-1, 3) for line in lines]
    segments = [np.stack([line[:-1], line[1:]], axis=1) for line in points]
    if not sum(map(len, segments)):
        return
    shades = np.broadcast_to(to_rgba_array(colours), (len(points), 4))
    tubes = _tubes(np.concatenate(segments), radius_m)
    owner = np.repeat(np.arange(len(points)), [len(pieces) for pieces in segments])
    mesh = mesh_of(tubes.reshape(-1, 3, 3))
    rgba = (255 * shades[owner]).astype(np.uint8)
    visual = TextureVisuals(material=_material("", np.ones(4)))
    visual.vertex_attributes["color"] = np.repeat(rgba, 3 * tubes.shape[1], axis=0)
    mesh.visual = visual
    _add(scene, name, mesh)


def add_points(
    scene: trimesh.Scene,
    name: str,
    points: Sequence[ArrayLike],
    colour: ColorType,
    radius_m: float = MARKER_RADIUS_M,
) -> None:
    """Add a ball at each point (x, y, z) [m]."""
    if not len(points):
        return
    ball = trimesh.creation.icosphere(subdivisions=2, radius=radius_m).triangles
    centres = np.asarray(points, dtype=np.float64).reshape(-1, 1, 1, 3)
    add_triangles(scene, name, (centres + ball).reshape(-1, 3, 3), colour)


class ColourBar(NamedTuple):
    """Legend of line colours.

    Attributes
    ----------
    colours : sequence of colours of matplotlib
        At even steps from `low` to `high`.
    low, high : str
        Written at the ends of the bar.
    label : str
        Written above it.
    """

    colours: Sequence[ColorType]
    low: str
    high: str
    label: str

    def html(self) -> str:
        """HTML of the bar and its texts in the lower left corner of a page."""
        rgb = [f"rgb({r:.0f},{g:.0f},{b:.0f})" for r, g, b, _ in 255 * to_rgba_array(self.colours)]
        bar = f"height:12px;background:linear-gradient(to right,{','.join(rgb)})"
        ends = f"<span>{escape(self.low)}</span><span>{escape(self.high)}</span>"
        return (
            f'<div id="colour-bar" style="position:absolute;left:12px;bottom:14px;width:240px;'
            f'{_FONT}">{escape(self.label)}<div style="{bar}"></div>'
            f'<div style="display:flex;justify-content:space-between">{ends}</div></div>'
        )


def scene_html(scene: trimesh.Scene, title: str, bar: ColourBar | None = None) -> str:
    """Return a page that shows the scene: drag to rotate, wheel to zoom, right button to pan."""
    page = scene_to_html(scene)
    for old, new in _PAGE_CHANGES:
        page = page.replace(old, new, 1)
    page = page.replace(_OLD_TITLE, f"<title>{escape(title)}</title>", 1)
    wide, tall = _MARGIN * np.tan(_half_angles(scene))
    page = page.replace("<script>", f"<script>const WIDE={wide:.6f},TALL={tall:.6f};", 1)
    overlay = _key(scene, title) + ("" if bar is None else bar.html())
    return page.replace("<body>", f"<body>{overlay}", 1)


def _key(scene: trimesh.Scene, title: str) -> str:
    """HTML of the title and the colour legend in the upper left corner; folded on a narrow page."""
    rows: list[str] = []
    for name, mesh in scene.geometry.items():
        material = getattr(mesh.visual, "material", None)
        if isinstance(material, PBRMaterial) and material.name:
            red, green, blue, _ = (int(part) for part in np.array(material.baseColorFactor))
            patch = f'<span style="color:rgb({red},{green},{blue})">&#9632;</span>'
            rows.append(f"{patch} {escape(name.removeprefix('walls:').replace('_', ' '))}")
    style = f"position:absolute;left:12px;top:10px;{_FONT}"
    summary = (
        f'<summary style="pointer-events:auto;cursor:pointer"><b>{escape(title)}</b></summary>'
    )
    return (
        f'<details id="key" style="{style}" open>{summary}{"<br>".join(rows)}</details>'
        f"<script>document.getElementById('key').open=innerWidth>={_NARROW_PX}</script>"
    )


def save_scene(
    scene: trimesh.Scene, path: str | Path, title: str | None = None, bar: ColourBar | None = None
) -> None:
    """Write a scene to a file, whole or not at all.

    Parameters
    ----------
    scene : trimesh.Scene
    path : str or Path
        Its suffix names the format: .glb or .html.
    title : str, optional
        Of the page; by default the file's name.
    bar : ColourBar, optional
        Legend of line colours, for the page.

    Raises
    ------
    ValueError
        For another suffix.
    """
    path = Path(path)
    if path.suffix.lower() == ".glb":
        content = export_glb(scene)
    elif path.suffix.lower() == ".html":
        content = scene_html(scene, title or path.stem, bar).encode()
    else:
        raise ValueError(f"{path}: expected a name that ends in .glb or .html")
    with atomic_write(path) as beside:
        beside.write_bytes(content)


def _material(name: str, rgba: NDArray[np.float64]) -> PBRMaterial:
    return PBRMaterial(
        name=name,
        baseColorFactor=(255 * rgba).astype(np.uint8),
        alphaMode="BLEND" if rgba[3] < 1.0 else "OPAQUE",
        doubleSided=True,
        metallicFactor=0.0,
        roughnessFactor=0.9,
    )


def _add(scene: trimesh.Scene, name: str, mesh: trimesh.Trimesh) -> None:
    scene.add_geometry(mesh, node_name=name, geom_name=name, transform=Y_UP)


def _tubes(segments: NDArray[np.float64], radius_m: float) -> NDArray[np.float64]:
    """Sides of a thin prism around each segment (n, 2, 3): (n, 2 * sides, 3, 3)."""
    along = segments[:, 1] - segments[:, 0]
    along /= np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-12)
    helper = np.where(np.abs(along[:, 2:]) < 0.9, [0.0, 0.0, 1.0], [1.0, 0.0, 0.0])
    across = np.cross(along, helper)
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    angle = np.arange(_TUBE_SIDES) * (2 * np.pi / _TUBE_SIDES)
    turned = np.cross(along, across)
    ring = radius_m * (
        np.cos(angle)[:, None] * across[:, None] + np.sin(angle)[:, None] * turned[:, None]
    )
    near, far = segments[:, :1] + ring, segments[:, 1:] + ring
    near_next, far_next = np.roll(near, -1, axis=1), np.roll(far, -1, axis=1)
    lower = np.stack([near, near_next, far_next], axis=2)
    upper = np.stack([near, far_next, far], axis=2)
    return np.concatenate([lower, upper], axis=1)


def _set_camera(scene: trimesh.Scene) -> None:
    """Look down at the middle of the scene from the south, as near as all of it is in view."""
    low, high = scene.bounds
    corners = trimesh.bounds.corners(scene.bounds) - (low + high) / 2
    pitch = np.radians(CAMERA_PITCH_DEG)
    level = trimesh.transformations.rotation_matrix(-pitch, (1, 0, 0))[:3, :3]
    across, up, near = level @ corners.T
    reach = np.tan(np.radians(FIELD_OF_VIEW_DEG / 2)) / _MARGIN
    distance = np.max(near + np.maximum(np.abs(across) / _WIDE, np.abs(up)) / reach)
    scene.set_camera(
        angles=(pitch, 0.0, 0.0),
        distance=float(distance),
        center=(low + high) / 2,
        fov=(FIELD_OF_VIEW_DEG, FIELD_OF_VIEW_DEG),
    )
    scene.camera.z_near, scene.camera.z_far = float(distance) / _NEARER, float(distance) * _FARTHER


def _half_angles(scene: trimesh.Scene) -> NDArray[np.float64]:
    """Angles [rad] from the camera's axis to the scene's edges, across and up, (2,)."""
    corners = trimesh.transform_points(
        trimesh.bounds.corners(scene.bounds), np.linalg.inv(scene.camera_transform)
    )
    return np.arctan(np.max(np.abs(corners[:, :2]) / -corners[:, 2:], axis=0))
