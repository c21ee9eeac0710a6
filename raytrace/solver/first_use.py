"""The kernels of paths over horizontal edges, compiled without those of other paths.

Numba compiles one function at a time in a process. These kernels take about as long as all the
others together, so a second process can compile them meanwhile.
"""

import numpy as np

from raytrace.config import TraceConfig
from raytrace.kernels.beam_hits import Targets, no_hits
from raytrace.kernels.beams import CELL, EDGE, FRACTION, IMAGE_X, IMAGE_Y, PARENT, Tree
from raytrace.kernels.guard import no_guard
from raytrace.kernels.lanes import WIDTH
from raytrace.radio.antennas import Antenna
from raytrace.radio.transmitter import Transmitter
from raytrace.scene import Scene
from raytrace.solver.evaluation import evaluation_of
from raytrace.solver.extruded_classes import OverHorizontalEdge
from raytrace.solver.loss_limits import continuations
from raytrace.solver.setup import Tracing, heights_of, limits_by_number, trace_geometry


def compile_horizontal_edges(
    scene: Scene,
    transmitter: Transmitter,
    config: TraceConfig,
    receive_antenna: Antenna | None = None,
) -> None:
    """Trace the direct rays over one horizontal edge, to a receiver at the transmitter.

    Parameters
    ----------
    scene
        A building with a horizontal edge, for instance of a doorway.
    transmitter, receive_antenna
        The kernels differ between known and unknown polarisation.
    config
        The kernels are the same for all limits.
    """
    evaluation = evaluation_of(scene.slabs, transmitter, config, receive_antenna)
    tracing = _direct_rays(scene, transmitter, config)
    edge, counts = scene.horizontal_edges[0], continuations(scene, config).from_horizontal
    OverHorizontalEdge(tracing, edge, 0, counts).sum_paths(evaluation)


def _direct_rays(scene: Scene, transmitter: Transmitter, config: TraceConfig) -> Tracing:
    """Return the beam from the transmitter that has not split yet, and the edge in it."""
    view, edge = scene.view, scene.horizontal_edges[0]
    near = edge.plan_edges[0]
    cell = int(np.searchsorted(view.cell_edges, near, side="right")) - 1
    x, y, z = transmitter.position
    tree = Tree(np.zeros((1, 9), np.int32), np.zeros((1, 11)))
    tree.link[0, [PARENT, EDGE, CELL]] = -1, -1, cell
    tree.beam[0, [IMAGE_X, IMAGE_Y, FRACTION]] = x, y, 1.0
    in_cell = (np.arange(len(view.cell_edges)) > cell).astype(np.int64)
    at_transmitter = np.append(x, np.zeros(WIDTH)), np.append(y, np.zeros(WIDTH))
    return Tracing(
        scene,
        config,
        geometry=trace_geometry(scene, (x, y, z), np.array([[x, y, z]]), config),
        targets=Targets(in_cell, np.zeros(1, np.int64), np.ones(1), *at_transmitter),
        heights=heights_of(scene, z, np.array([[x, y, z]])),
        limits=limits_by_number(scene, config),
        tree=tree,
        left_out=0.0,
        corners=no_hits(),
        partial_walls=np.array([[near, 0]], np.int32),
        intervals=np.array([[0.0, 1.0]]),
        guard=no_guard(),
    )
