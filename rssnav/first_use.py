"""Compile the tracer's kernels in two processes, before the first trace on a machine.

Numba compiles one function at a time in a process, and kernels as they are called. Here a second
process, ``python -m rssnav.first_use PRESET``, compiles those of paths over horizontal edges, and
this one all others; both find them in the cache afterwards.
"""

from __future__ import annotations

import subprocess
import sys
import time
from dataclasses import replace

import floorplans
from raytrace import Grid, Scene, TraceConfig, Transmitter, compute_radio_map
from raytrace.solver.first_use import compile_horizontal_edges
from raytrace.threads import n_threads
from rssnav.kernel_cache import tracer_cache
from rssnav.presets import PRESETS, PresetName
from rssnav.scenes import scene_of

BOX = """
name = "box of 6 m x 4 m"
format = 1
height_m = 3
floor_material = "concrete"
ceiling_material = "concrete"
source = [1.2, 1.3, 1.5]
start = [5.5, 2.5]
outline = [[0, 0], [6, 0], [6, 4], [0, 4], [0, 0]]

[[walls]]
points = [[0, 0], [6, 0], [6, 4], [0, 4], [0, 0]]
material = "concrete"
thickness_m = 0.2
"""
"""A plan of one room."""

PARTITION = """
[[walls]]
points = [[3, 0], [3, 4]]
material = "concrete"
thickness_m = 0.1
openings = [{ kind = "passage", offset_m = 1, width_m = 1, head_m = HEAD }]
"""
"""A wall that makes two rooms of it."""

POLL_S = 0.05


def compile_kernels(preset: PresetName, *, threads: int | None = None) -> bool:
    """Compile what traces with a preset need, if the cache of the kernels is empty.

    Parameters
    ----------
    preset
        Its antennas and kinds of paths count.
    threads
        Two or more for a second process; one per processor by default.

    Returns
    -------
    bool
        Whether there was anything to do, and two threads to do it with.
    """
    cache = tracer_cache()
    if cache.folder is None or cache.n_compiled or n_threads(threads) < 2:
        return False
    other = _other_process(preset)
    try:
        _trace_without_horizontal_edges(preset)
        while other.poll() is None:
            time.sleep(POLL_S)
    finally:
        other.kill()
        other.wait()
    return True


def _other_process(preset: PresetName) -> subprocess.Popen[bytes]:
    """Start the second process: quiet, deaf to the terminal, and with installed modules only."""
    command = [sys.executable, "-P", "-m", "rssnav.first_use", preset]
    nothing = subprocess.DEVNULL
    return subprocess.Popen(
        command, stdin=nothing, stdout=nothing, stderr=nothing, start_new_session=True
    )


def _trace_without_horizontal_edges(preset: PresetName) -> None:
    scene, transmitter, config = _two_rooms(preset, head_m=3.0)
    cell = Grid.over((5.0, 1.0, 6.0, 2.0), cell_size_m=1.0, height_m=1.0)
    antenna = PRESETS[preset].antenna
    compute_radio_map(scene, transmitter, cell, config, receive_antenna=antenna)


def _trace_horizontal_edges(preset: PresetName) -> None:
    scene, transmitter, config = _two_rooms(preset, head_m=2.0)
    compile_horizontal_edges(scene, transmitter, config, PRESETS[preset].antenna)


def _two_rooms(preset: PresetName, head_m: float) -> tuple[Scene, Transmitter, TraceConfig]:
    """Return two rooms with a passage, whose head is a horizontal edge unless it is the ceiling."""
    plan = floorplans.loads(BOX + PARTITION.replace("HEAD", str(head_m)))
    chosen = PRESETS[preset]
    transmitter = Transmitter(plan.require_source(), antenna=chosen.antenna)
    return scene_of(plan), transmitter, replace(chosen.config, max_reflections=1)


if __name__ == "__main__":
    for name in PRESETS:
        if name == sys.argv[1]:
            _trace_horizontal_edges(name)
