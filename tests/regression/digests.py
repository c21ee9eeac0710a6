"""Digests of a small map, of its paths and of trainings in it, which no change may alter unnoticed.

`python tests/regression/digests.py` writes `digests.json` again. A change of the physics or of
the learning rules needs that, and a line in the changelog that says why.
"""

import hashlib
import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import floorplans
from raytrace import Grid, RadioMap, Scene, TraceConfig, Transmitter, compute_radio_map, trace_paths
from rssnav import GridWorld, LocationAgent, RssAgent, TrainingResult, train

FILE = Path(__file__).with_name("digests.json")
DECIMALS = 5
"""Of decibels and metres: processors differ in the last bits of fused operations."""


def digest(*arrays: NDArray) -> str:
    """Hash of arrays, floating-point numbers rounded."""
    found = hashlib.sha256()
    for array in arrays:
        whole = array.dtype.kind in "iub"
        rounded = array.astype(np.int64) if whole else np.round(array.astype(float), DECIMALS) + 0.0
        found.update(str(array.shape).encode() + np.ascontiguousarray(rounded).tobytes())
    return found.hexdigest()[:16]


def small_map() -> RadioMap:
    """Map of the built-in flat of three reflections and one diffraction."""
    scene, source, bounds = flat()
    return compute_radio_map(scene, source, Grid.over(bounds, 1.0, 2.0), TraceConfig(3, 1))


def flat() -> tuple[Scene, Transmitter, tuple[float, float, float, float]]:
    plan = floorplans.load("flat")
    walls = plan.to_mesh()
    scene = Scene.from_mesh(walls.mesh, walls.face_material, walls.materials)
    return scene, Transmitter(plan.source), plan.bounds


def digest_of_map() -> str:
    radio_map = small_map()
    return digest(radio_map.rss_dbm, radio_map.rss_coherent_dbm, radio_map.path_count)


def digest_of_paths() -> str:
    scene, source, _ = flat()
    paths = trace_paths(scene, source, [[9.5, 6.5, 2.0], [2.25, 7.75, 1.0]], TraceConfig(3, 1))
    length_m = np.round(paths.length_m, DECIMALS)
    power_db = np.round(20.0 * np.log10(np.abs(paths.gain)), DECIMALS)
    order = np.lexsort((*paths.interactions.T, power_db, length_m, paths.receiver))
    columns = (paths.receiver, paths.interactions, length_m, power_db)
    return digest(*(column[order] for column in columns))


def digest_of_training(agent: RssAgent | LocationAgent) -> str:
    radio_map = small_map()
    world = GridWorld.from_map(floorplans.load("flat"), radio_map, speed=1)
    result: TrainingResult = train(world, agent, runs=3, episodes=200, seed=7)
    return digest(result.steps, result.visit_counts, result.trajectories, result.converged_episode)


MEASURED: dict[str, Callable[[], str]] = {
    "map of the flat, 3R 1D": digest_of_map,
    "paths in the flat, 3R 1D": digest_of_paths,
    "training, RSS-based": lambda: digest_of_training(RssAgent(terminal_dbm=-30.0)),
    "training, location-based": lambda: digest_of_training(LocationAgent()),
}

if __name__ == "__main__":
    FILE.write_text(json.dumps({name: make() for name, make in MEASURED.items()}, indent=2) + "\n")
