"""Traces one request with rssnav or pyroomacoustics, in a process of its own.

    python peer_workers.py rssnav request.json result.npz

See `sionna_worker.py` for the request and the result.
"""

import json
import resource
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

import floorplans
from raytrace import Isotropic, Scene, TraceConfig, Transmitter, trace_paths

Request = dict[str, Any]
Found = dict[str, Any]


def plan_named(name: str) -> floorplans.FloorPlan:
    """Return a built-in plan, or an office of two rooms."""
    return floorplans.generate_office(2, 1) if name == "office" else floorplans.load(name)


def with_rssnav(request: Request) -> Callable[[], Found]:
    """Return a function that traces with rssnav."""
    walls = plan_named(request["plan"]).to_mesh()
    scene = Scene.from_mesh(walls.mesh, walls.face_material, walls.materials)
    source = Transmitter(
        tuple(request["source"]), frequency_hz=request["frequency_hz"], antenna=Isotropic()
    )
    config = TraceConfig(request["max_reflections"], request["max_diffractions"])
    receivers = np.array(request["receivers"])

    def trace() -> Found:
        paths = trace_paths(scene, source, receivers, config, receive_antenna=Isotropic())
        return {
            "receiver": paths.receiver,
            "interactions": paths.interactions,
            "vertices": paths.vertices,
            "gain": paths.gain,
        }

    return trace


def with_pyroomacoustics(request: Request) -> Callable[[], Found]:
    """Return a function that finds images with pyroomacoustics, both sides of every wall.

    A point of a building of sheets is not inside what they bound, so it is not asked for.
    """
    import pyroomacoustics as pra

    class SheetRoom(pra.Room):
        def is_inside(self, *_point: object, **_how: object) -> bool:
            return True

    plan = plan_named(request["plan"])
    quads = [
        floorplans.mesh.panel_corners(wall, panel)
        for wall in plan.walls
        for panel in floorplans.panels(wall)
    ]
    ground = np.array(plan.outline.exterior.coords)[:-1]
    slabs = [np.column_stack([ground, np.full(len(ground), z)]) for z in (0.0, plan.height_m)]
    sides = [c for quad in (*quads, *slabs) for c in (quad, quad[::-1])]

    def trace() -> Found:
        walls = [pra.wall_factory(c.T, [0.1], [0.0]) for c in sides]
        room = SheetRoom(walls, max_order=request["max_reflections"])
        room.add_source(request["source"])
        room.add_microphone_array(np.array(request["receivers"]).T)
        room.image_source_model()
        source = room.sources[0]
        receiver, image = np.nonzero(room.visibility[0])
        places = np.array(request["receivers"])[receiver]
        lengths = np.linalg.norm(source.images.T[image] - places, axis=1)
        return {"receiver": receiver, "length_m": lengths}

    return trace


TRACERS = {"rssnav": with_rssnav, "pyroomacoustics": with_pyroomacoustics}


def main() -> None:
    """Trace twice, the first time to compile."""
    name, request, result = sys.argv[1:]
    trace = TRACERS[name](json.loads(Path(request).read_text()))
    for _ in range(2):
        started = time.perf_counter()
        found = trace()
        seconds = time.perf_counter() - started
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
    np.savez(result, **found, seconds=seconds, peak_bytes=peak)


if __name__ == "__main__":
    main()
