"""The first use on a machine: two processes compile what a trace needs, and nothing else."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from rssnav import first_use
from rssnav.kernel_cache import CacheState

HALVES = """
import sys

import raytrace
from raytrace.compilation import watched_compilation
from raytrace.kernels import horizontal_edges, reflections, vertical_edges
from rssnav.first_use import _trace_horizontal_edges, _trace_without_horizontal_edges, _two_rooms
from rssnav.presets import PRESETS

PRESET = sys.argv[1]


def kernels():
    of = horizontal_edges.sum_horizontal_edge, reflections.sum_reflections, \\
        vertical_edges.sum_vertical_edge
    return [[str(each) for each in kernel.signatures] for kernel in of]

_trace_horizontal_edges(PRESET)
assert [len(each) for each in kernels()] == [1, 0, 0]
_trace_without_horizontal_edges(PRESET)
found = kernels()
assert [len(each) for each in found] == [1, 1, 1]

scene, transmitter, config = _two_rooms(PRESET, head_m=2.0)
grid = raytrace.Grid.over((0.0, 0.0, 6.0, 4.0), cell_size_m=2.0, height_m=1.0)
with watched_compilation() as compilation:
    antenna = PRESETS[PRESET].antenna
    radio_map = raytrace.compute_radio_map(
        scene, transmitter, grid, config, receive_antenna=antenna)
assert radio_map.path_count.min() > 0
assert compilation.n_compiled == 0
assert kernels() == found
"""


@pytest.mark.parametrize("preset", ["paper", "building"])
def test_halves_compile_what_a_trace_needs(preset) -> None:
    subprocess.run([sys.executable, "-c", HALVES, preset], check=True, timeout=300)


def _with_cache(monkeypatch, n_compiled: int) -> None:
    state = CacheState(Path("anywhere"), n_compiled, 0)
    monkeypatch.setattr(first_use, "tracer_cache", lambda: state)


def test_interrupt_ends_the_other_process(monkeypatch) -> None:
    started = []

    def endless(_preset):
        command = [sys.executable, "-c", "import time; time.sleep(600)"]
        started.append(subprocess.Popen(command))
        return started[0]

    def interrupted(_preset):
        raise KeyboardInterrupt

    _with_cache(monkeypatch, 0)
    monkeypatch.setattr(first_use, "_other_process", endless)
    monkeypatch.setattr(first_use, "_trace_without_horizontal_edges", interrupted)
    with pytest.raises(KeyboardInterrupt):
        first_use.compile_kernels("paper", threads=2)
    assert started[0].returncode is not None


def test_kernels_of_an_earlier_use_are_left_alone(monkeypatch) -> None:
    monkeypatch.setattr(first_use, "_other_process", None)  # not called
    _with_cache(monkeypatch, 150)
    assert not first_use.compile_kernels("paper", threads=2)
    _with_cache(monkeypatch, 0)
    assert not first_use.compile_kernels("paper", threads=1)
