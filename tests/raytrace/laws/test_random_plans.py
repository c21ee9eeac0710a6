"""On plans drawn at random every path is the brute force's, and every path's reverse is a path.

`RSSNAV_EXAMPLES=2000 pytest tests/raytrace/laws/test_random_plans.py` searches longer, with new
plans every time.
"""

import os

import numpy as np
from buildings import Building
from comparing import as_found, assert_same_paths, check_every_gain, check_every_path
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from random_plans import random_building
from scipy.spatial import cKDTree

from raytrace import Paths, TraceConfig, Transmitter, trace_paths
from raytrace.kernels.path_points import NOTHING

Floats = NDArray[np.float64]

EXACT_M = 1e-9
LONG = "RSSNAV_EXAMPLES" in os.environ

seeds = st.integers(0, 2**32 - 1)
n_inside = st.integers(1, 4)


def examples(few: int) -> settings:
    """Return settings with that many plans, the same ones every time, or as many as asked for."""
    return settings(max_examples=int(os.environ.get("RSSNAV_EXAMPLES", few)), derandomize=not LONG)


def check(seed: int, n_walls: int, config: TraceConfig) -> None:
    building = random_building(seed, n_walls)
    source, *receivers = building.random_points(3, seed)
    check_every_path(building, tuple(source), np.array(receivers), config, EXACT_M)
    check_every_gain(building, tuple(source), np.array(receivers), config)


@given(seed=seeds, n_walls=n_inside)
@examples(few=6)
def test_two_reflections_and_a_diffraction(seed: int, n_walls: int) -> None:
    check(seed, n_walls, TraceConfig(2, 1))


@given(seed=seeds, n_walls=st.integers(1, 2))
@examples(few=2)
def test_three_reflections_and_a_diffraction(seed: int, n_walls: int) -> None:
    check(seed, n_walls, TraceConfig(3, 1))


@given(seed=seeds, n_walls=n_inside)
@examples(few=6)
def test_four_reflections(seed: int, n_walls: int) -> None:
    check(seed, n_walls, TraceConfig(4, 0))


@given(seed=seeds, n_walls=st.integers(2, 4))
@examples(few=8)
def test_a_reflection_a_diffraction_and_transmissions(seed: int, n_walls: int) -> None:
    check(seed, n_walls, TraceConfig(1, 1, 3))


@given(seed=seeds, n_walls=st.integers(2, 4))
@examples(few=6)
def test_three_reflections_and_transmissions(seed: int, n_walls: int) -> None:
    check(seed, n_walls, TraceConfig(3, 0, 2))


def reverse(paths: Paths) -> Paths:
    """Return the same paths from their receivers to the transmitter."""
    vertices, kinds = paths.vertices.copy(), paths.interactions.copy()
    for k, n in enumerate(paths.n_interactions):
        vertices[k, : n + 2] = paths.vertices[k, n + 1 :: -1]
        vertices[k, n + 2 :] = paths.vertices[k, 0]
        kinds[k, :n] = paths.interactions[k, :n][::-1]
        kinds[k, n:] = NOTHING
    return Paths(paths.receiver, kinds, vertices, paths.length_m, paths.gain, paths.weight)


@given(seed=seeds, n_walls=n_inside)
@examples(few=8)
def test_every_path_reversed_is_a_path_of_the_same_gain(seed: int, n_walls: int) -> None:
    building = random_building(seed, n_walls)
    here, there = building.random_points(2, seed)
    forth = reverse(trace(building, here, there))
    back = trace(building, there, here)
    assert_same_paths(as_found(forth), as_found(back), EXACT_M)
    if len(back):
        _, same = cKDTree(flat(back.vertices)).query(flat(forth.vertices))
        np.testing.assert_allclose(forth.gain, back.gain[same], rtol=1e-5, atol=1e-12)


def trace(building: Building, source: Floats, receiver: Floats) -> Paths:
    transmitter = Transmitter((float(source[0]), float(source[1]), float(source[2])))
    return trace_paths(building.scene, transmitter, receiver[None], TraceConfig(3, 1))


def flat(vertices: Floats) -> Floats:
    return vertices.reshape(len(vertices), -1)
