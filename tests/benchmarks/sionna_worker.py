"""Traces one scene with Sionna RT, in an environment of its own.

    python sionna_worker.py request.json result.npz

The request holds the scene's file, the transmitter, receivers, frequency and limits; the result
every path's receiver, interactions, vertices and coefficient, the time and the peak memory.
`peers.py` writes the one and reads the other.
"""

import json
import resource
import sys
import time
from pathlib import Path

import numpy as np
import sionna.rt as rt

REFLECTION, DIFFRACTION = 1, 2
KIND_OF = {
    int(rt.InteractionType.SPECULAR): REFLECTION,
    int(rt.InteractionType.DIFFRACTION): DIFFRACTION,
}
SAMPLES = 1_000_000
"""Rays that it launches, its default."""


def scene_of(request: dict) -> rt.Scene:
    """Load the scene, with a transmitter and receivers that have vertical isotropic antennas."""
    scene = rt.load_scene(request["scene"], merge_shapes=False)
    scene.frequency = request["frequency_hz"]
    antenna = rt.PlanarArray(num_rows=1, num_cols=1, pattern="iso", polarization="V")
    scene.tx_array = scene.rx_array = antenna
    scene.add(rt.Transmitter("tx", position=request["source"]))
    for k, place in enumerate(request["receivers"]):
        scene.add(rt.Receiver(f"rx{k}", position=place))
    return scene


def solve(scene: rt.Scene, request: dict) -> rt.Paths:
    """Find its paths: specular reflections, and one diffraction where asked for."""
    diffraction = request["max_diffractions"] > 0
    return rt.PathSolver()(
        scene,
        max_depth=request["max_reflections"] + request["max_diffractions"],
        samples_per_src=SAMPLES,
        synthetic_array=True,
        refraction=False,
        diffraction=diffraction,
        edge_diffraction=diffraction,
    )


def arrays_of(paths: rt.Paths, source: list[float], receivers: list[list[float]]) -> dict:
    """Receiver, interactions, vertices and coefficient of every valid path."""
    valid = np.array(paths.valid).reshape(len(receivers), -1)
    kinds = np.array(paths.interactions).reshape(-1, *valid.shape)
    points = np.array(paths.vertices).reshape(-1, *valid.shape, 3)
    real, imaginary = (np.array(part).reshape(valid.shape) for part in paths.a)
    receiver, path = np.nonzero(valid)
    kinds = np.vectorize(lambda k: KIND_OF.get(int(k), 0))(kinds[:, receiver, path]).T
    vertices = np.empty((len(receiver), kinds.shape[1] + 2, 3))
    vertices[:, 0] = source
    vertices[:, 1:] = np.array(receivers)[receiver][:, None]
    on_way = kinds > 0
    vertices[:, 1:-1][on_way] = points[:, receiver, path].transpose(1, 0, 2)[on_way]
    gain = (real + 1j * imaginary)[receiver, path]
    return {"receiver": receiver, "interactions": kinds, "vertices": vertices, "gain": gain}


def main() -> None:
    """Trace twice, the first time to compile."""
    request = json.loads(Path(sys.argv[1]).read_text())
    scene = scene_of(request)
    for _ in range(2):
        started = time.perf_counter()
        paths = solve(scene, request)
        found = arrays_of(paths, request["source"], request["receivers"])
        seconds = time.perf_counter() - started
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
    np.savez(sys.argv[2], **found, seconds=seconds, peak_bytes=peak, version=rt.__version__)


if __name__ == "__main__":
    main()
