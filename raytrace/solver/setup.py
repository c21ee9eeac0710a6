"""The beams from one transmitter to receivers in a scene, before any field is computed."""

import math
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from raytrace.arrays import Bools, Floats, Int32s, Ints
from raytrace.config import TraceConfig
from raytrace.errors import SceneError
from raytrace.geometry.point_location import cells_around, targets_in, wall_around
from raytrace.kernels.beam_hits import Hits, Targets, hit_corners, hit_partial_walls
from raytrace.kernels.beams import Tree, grow_tree
from raytrace.kernels.building import (
    Building,
    Receivers,
    TraceGeometry,
    image_bounces,
    image_heights,
)
from raytrace.kernels.edge_losses import no_edge_ways
from raytrace.kernels.guard import Guard, no_guard
from raytrace.kernels.horizontal_edge_bounds import DISTANCES
from raytrace.kernels.losses import COSINE_BINS, UNLIMITED, Limits, LossLimit
from raytrace.kernels.plan_view import GRAZING_M
from raytrace.kernels.turns import Heights
from raytrace.scene import Scene
from raytrace.solver.limits import check_whole, nbytes, taking

BEAMS = "the beams"


@dataclass(frozen=True, eq=False)
class Tracing:
    """A scene with a transmitter and receivers: geometry and beams, no fields.

    Attributes
    ----------
    scene, config
        What is traced, and the limits.
    geometry
        The same as the kernels take it.
    targets
        The receivers, cell by cell.
    heights
        Where paths begin and end.
    limits
        How far beams from the transmitter are grown.
    tree, left_out
        These beams, and a bound on the power of all paths in those that are too weak to be grown
        [fraction of the transmitted].
    corners
        Corners of the plan view within these beams.
    partial_walls, intervals
        (n, 2), (n, 2) partial walls that these beams meet, and which part of them.
    guard
        What may end the kernels, with the memory that is left.
    grown_for
        Digest of the materials, antennas and frequency by which a loss limits the beams (see
        `path_class.Evaluation`); None without such a limit: then they serve any.
    least, least_diffracted
        (n_receivers,) power below which paths are left out, those without and those with a
        diffraction [fraction of the transmitted]; empty where it is the same for all receivers.
    """

    scene: Scene
    config: TraceConfig
    geometry: TraceGeometry
    targets: Targets
    heights: Heights
    limits: Limits
    tree: Tree
    left_out: float
    corners: Hits
    partial_walls: Int32s
    intervals: Floats
    guard: Guard
    grown_for: bytes | None = None
    least: Floats = field(default_factory=lambda: np.zeros(0))
    least_diffracted: Floats = field(default_factory=lambda: np.zeros(0))

    @cached_property
    def reachable(self) -> Ints:
        """Numbers of the receivers inside the building."""
        return np.unique(self.targets.number)

    def shared_by(self, threads: int) -> "Tracing":
        """Return the same, with the memory that is left for each of some threads."""
        each = self.guard._replace(max_bytes=self.guard.max_bytes // threads)
        return replace(self, guard=each)


def prepare(
    scene: Scene,
    position: tuple[float, float, float],
    receivers: Floats,
    config: TraceConfig,
    guard: Guard | None = None,
    limits: Limits | None = None,
) -> Tracing:
    """Grow the beams from a transmitter.

    Parameters
    ----------
    scene, config
        What is traced, and how far; `min_power_dbm` is not used.
    position
        Of the transmitter [m].
    receivers
        (n, 3) positions [m]; no path reaches those outside the building.
    guard
        What may end the kernels; nothing by default.
    limits
        How far beams are grown (see `loss_limits.limits_from_transmitter`); as far as the numbers
        of `config` allow by default.

    Raises
    ------
    SceneError
        Where the transmitter is not inside the building.
    ValueError
        Where neither a number nor a loss limits the transmissions.
    TraceStoppedError, MemoryLimitError
        Where the guard has ended a kernel.
    """
    guard = guard or no_guard()
    x, y, z = (float(coordinate) for coordinate in position)
    root = _cells_of_transmitter(scene, (x, y, z))
    geometry = trace_geometry(scene, (x, y, z), receivers, config)
    heights = heights_of(scene, z, receivers)
    limits = limits or limits_by_number(scene, config)
    if config.max_transmissions is None and not limits.loss.is_active:
        raise ValueError("max_transmissions = None: expected limits by loss")
    to_edges = heights.reaching(e.z for e in scene.horizontal_edges)
    beams = _beams(scene, to_edges, (x, y), root, limits, guard)
    tree, left_out, corners, partial_walls, intervals = beams
    return Tracing(
        scene,
        config,
        geometry,
        _targets(scene, receivers),
        heights,
        limits,
        tree,
        left_out,
        corners,
        partial_walls,
        intervals,
        taking(guard, nbytes((tree, corners, partial_walls, intervals)), BEAMS),
    )


def limits_by_number(scene: Scene, config: TraceConfig) -> Limits:
    """Return the limits of beams from the transmitter, without one by loss."""
    order, transmissions = config.max_reflections, config.max_transmissions
    no_slabs = np.zeros((0, COSINE_BINS, COSINE_BINS))
    loss = LossLimit(
        is_active=False,
        least=np.zeros(len(scene.view.line)),
        power_at_1m=0.0,
        height=scene.height_m,
        most_reflections=order,
        wavelength=0.0,
        reflectance=no_slabs,
        transmittance=no_slabs,
        shadow=no_slabs,
        is_alone=False,
        roots=np.zeros((order + 1, 2)),
        most_behind_edge=0.0,
        edge_ways=no_edge_ways(),
        ranks=np.zeros((0, 4)),
        ways=np.zeros((0, 6)),
        across=np.zeros((0, 0, 2)),
        rises=np.zeros(0),
        over_edge=np.zeros((0, order + 1, DISTANCES + 1)),
        further=np.zeros(0),
    )
    return Limits(order, UNLIMITED if transmissions is None else transmissions, loss)


def with_receivers(tracing: Tracing, receivers: Floats) -> Tracing:
    """Return the same beams with other receivers (n, 3) [m], at heights between the others'.

    Their paths are limited by the beams alone.
    """
    x, y, z = (float(coordinate) for coordinate in tracing.geometry.transmitter)
    geometry = trace_geometry(tracing.scene, (x, y, z), receivers, tracing.config)
    return replace(
        tracing,
        geometry=geometry,
        targets=_targets(tracing.scene, receivers),
        least=np.zeros(0),
        least_diffracted=np.zeros(0),
    )


def heights_of(scene: Scene, z: float, receivers: Floats) -> Heights:
    """Return where paths from a height [m] to receivers (n, 3) [m] begin and end."""
    ends = np.unique(receivers[_between_floors(scene, receivers), 2])
    return Heights(z, math.inf, -math.inf).reaching(ends.tolist())


def _between_floors(scene: Scene, receivers: Floats) -> Bools:
    return (receivers[:, 2] > 0.0) & (receivers[:, 2] < scene.height_m)


def _targets(scene: Scene, receivers: Floats) -> Targets:
    inside = _between_floors(scene, receivers)
    return targets_in(scene.view, np.ascontiguousarray(receivers[:, :2]), inside)


def _beams(
    scene: Scene,
    heights: Heights,
    root: tuple[float, float],
    root_cells: Ints,
    limits: Limits,
    guard: Guard,
) -> tuple[Tree, float, Hits, Int32s, Floats]:
    """Grow the beams from a point; find the corners and partial walls within them."""
    view = scene.view
    tree, left_out, is_whole = grow_tree(view, heights, root, root_cells, limits, guard)
    check_whole(guard, is_whole, BEAMS)
    guard = taking(guard, nbytes(tree), BEAMS)
    corners, is_whole = hit_corners(view, tree, guard)
    check_whole(guard, is_whole, BEAMS)
    guard = taking(guard, nbytes(corners), BEAMS)
    partial_walls, intervals, is_whole = hit_partial_walls(view, tree, guard)
    check_whole(guard, is_whole, BEAMS)
    return tree, left_out, corners, partial_walls, intervals


def trace_geometry(
    scene: Scene, position: tuple[float, float, float], receivers: Floats, config: TraceConfig
) -> TraceGeometry:
    """Return a scene, its transmitter and receivers as the kernels take them."""
    order, height = config.max_reflections, scene.height_m
    heights, level = np.unique(receivers[:, 2], return_inverse=True)
    images = [image_heights(h, height, order) for h in heights]
    return TraceGeometry(
        Building(
            scene.view,
            height,
            scene.floor_slab,
            scene.ceiling_slab,
            bool(scene.view.is_outdoors.any()),
        ),
        np.array(position),
        image_heights(position[2], height, order),
        Receivers(
            np.ascontiguousarray(receivers[:, :2]),
            level.astype(np.int64),
            np.array(images).reshape(len(heights), 2 * order + 1),
        ),
        image_bounces(order),
        order,
        limits_by_number(scene, config).max_transmissions,
    )


def _cells_of_transmitter(scene: Scene, position: tuple[float, float, float]) -> Ints:
    """Cells around the transmitter; it may stand in a doorway, but not in a wall."""
    x, y, z = position
    view = scene.view
    places, _ = cells_around(view, np.array([[x, y]]))
    if not len(places) or not 0.0 < z < scene.height_m:
        raise SceneError(
            f"the transmitter at {position} is not inside the building: "
            f"expected a place on its floor and a height between 0 and {scene.height_m:g} m"
        )
    e = wall_around(view, places[:, 1], position)
    if e >= 0:
        x1, y1, x2, y2 = view.ends[e]
        raise SceneError(
            f"the transmitter at {position} stands in the wall from ({x1:g}, {y1:g}) to "
            f"({x2:g}, {y2:g}): move it away by more than {GRAZING_M:g} m"
        )
    return places[:, 1]
