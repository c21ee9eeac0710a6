"""A scene, a source and receivers made ready for the kernels."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from raytrace.config import TraceConfig
from raytrace.errors import SceneError
from raytrace.geometry.point_location import bounces_needed, cells_around, targets_in, wall_around
from raytrace.kernels.beams import Hits, Targets, Tree, grow_tree, hit_corners, hit_partial_walls
from raytrace.kernels.plan_view import GRAZING_M
from raytrace.kernels.tracing import Trace
from raytrace.kernels.unfolding import image_heights
from raytrace.radio.antennas import Antenna
from raytrace.radio.tables import make_radio
from raytrace.radio.transmitter import Transmitter
from raytrace.scene import Scene

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Tracing:
    """A scene with one source and its receivers, prepared for the kernels.

    Attributes
    ----------
    scene, config
        What is traced, and how far.
    trace
        The kernels' constants.
    targets
        The receivers, cell by cell.
    bounces
        (n_edges, 2) see `locating.bounces_needed`.
    tree
        Beams from the source.
    corners
        Corners of the plan view that beams of the source light.
    rims, stretches
        (n, 2), (n, 2) partial walls that beams of the source light, and which part of them.
    """

    scene: Scene
    config: TraceConfig
    trace: Trace
    targets: Targets
    bounces: NDArray[np.int64]
    tree: Tree
    corners: Hits
    rims: NDArray[np.int32]
    stretches: Floats


def prepare(
    scene: Scene,
    source: Transmitter,
    receivers: Floats,
    config: TraceConfig,
    receive_antenna: Antenna | None = None,
) -> Tracing:
    """Grow the beams from the source and make the tables.

    Parameters
    ----------
    scene, source, config
        What is traced, from where, and how far.
    receivers
        (n, 3) positions [m]; those outside the building are reached by no path.
    receive_antenna
        The receivers' antenna; a half-wave dipole of 0 dB peak gain by default.
    """
    view = scene.view
    x, y, z = source.position
    root = _cells_of_source(scene, source)
    most = (config.max_reflections, config.max_transmissions)
    heights, level = np.unique(receivers[:, 2], return_inverse=True)
    trace = Trace(
        plan=view,
        radio=make_radio(
            source, scene.slabs, height_m=scene.height_m, floor=scene.floor_material,
            ceiling=scene.ceiling_material, receive_antenna=receive_antenna,
            through_walls=config.max_transmissions > 0,
        ),
        source=np.array([x, y, z]),
        source_z=image_heights(z, scene.height_m, config.max_reflections)[0],
        receivers=np.ascontiguousarray(receivers[:, :2]),
        level=level.astype(np.int64),
        image_z=np.array(
            [image_heights(h, scene.height_m, config.max_reflections)[0] for h in heights]
        ).reshape(len(heights), 2 * config.max_reflections + 1),
        image_bounces=image_heights(0.0, 1.0, config.max_reflections)[1],
        max_order=config.max_reflections,
        max_walls=config.max_transmissions,
        least_power=10.0 ** ((config.min_power_dbm - source.power_dbm) / 10.0),
    )  # fmt: skip
    band = [z, *heights, *(e.z for e in scene.horizontal_edges)]
    bounces = bounces_needed(view, min(band), max(band), config.max_transmissions > 0)
    tree = grow_tree(view, bounces, x, y, root, most)
    rims, stretches = hit_partial_walls(view, tree)
    inside = (receivers[:, 2] > 0.0) & (receivers[:, 2] < scene.height_m)
    return Tracing(
        scene, config, trace, targets_in(view, trace.receivers, inside), bounces, tree,
        hit_corners(view, tree), rims, stretches,
    )  # fmt: skip


def _cells_of_source(scene: Scene, source: Transmitter) -> NDArray[np.int64]:
    """Cells around the transmitter; it may stand in a doorway, but not in a wall."""
    x, y, z = source.position
    view = scene.view
    places, _ = cells_around(view, np.array([[x, y]]))
    if not len(places) or not 0.0 < z < scene.height_m:
        raise SceneError(
            f"the transmitter at {source.position} is not inside the building: "
            f"expected a place on its floor and a height between 0 and {scene.height_m:g} m"
        )
    e = wall_around(view, places[:, 1], source.position)
    if e >= 0:
        x1, y1, x2, y2 = view.ends[e]
        raise SceneError(
            f"the transmitter at {source.position} stands in the wall from ({x1:g}, {y1:g}) to "
            f"({x2:g}, {y2:g}): move it away by more than {GRAZING_M:g} m"
        )
    return places[:, 1]
