"""Turns at floor and ceiling: never more than a path has, and as many as its walls need."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from raytrace.kernels.compiling import jit
from raytrace.kernels.plan_view import PARTIAL, PlanView
from raytrace.kernels.turns import Heights, turns_at, turns_needed

HEIGHT_M = 3.0
DOOR, WINDOW, COUNTER = (
    ((2.1, -1), (3.0, 0)),
    ((0.9, 0), (2.1, -1), (3.0, 0)),
    ((1.0, 0), (3.0, -1)),
)
PROFILES = (DOOR, WINDOW, COUNTER, ((0.5, -1), (1.0, 0), (2.5, -1), (3.0, 0)))


def view_of_profiles() -> PlanView:
    """Edges with one profile each; nothing else of them matters here."""
    numbers = np.zeros(0, np.int64)
    intervals = [interval for profile in PROFILES for interval in profile]
    return PlanView(
        cell_edges=numbers,
        ends=np.zeros((0, 4)),
        vertex=np.zeros((0, 2), np.int64),
        plane=np.zeros((0, 3)),
        line=numbers,
        kind=np.full(len(PROFILES), PARTIAL),
        profile=np.arange(len(PROFILES)),
        twin=numbers,
        beyond=numbers,
        behind_first=numbers,
        behind=numbers,
        cell_of=numbers,
        is_outdoors=np.zeros(0, np.bool_),
        profile_intervals=np.cumsum([0, *map(len, PROFILES)]),
        interval_top=np.array([top for top, _ in intervals]),
        interval_slab=np.array([slab for _, slab in intervals]),
    )


VIEW = view_of_profiles()


@jit()
def turns_of_walls(view, numbers, solid, start, heights):
    turns = 0, start, 0, start
    for k in range(len(numbers)):
        turns = turns_at(view, numbers[k], solid[k], turns)
    return turns_needed(turns, heights)


def needed(walls, start: float, end: float) -> int:
    """Turns of a path that meets walls, each a profile and whether it is solid there."""
    numbers = np.array([number for number, _ in walls], np.int64)
    solid = np.array([is_solid for _, is_solid in walls], np.bool_)
    return turns_of_walls(VIEW, numbers, solid, start, Heights(start, end, end))


def folded(z):
    storeys = np.floor(z / HEIGHT_M)
    rest = z - storeys * HEIGHT_M
    return np.where(storeys % 2 == 1, HEIGHT_M - rest, rest)


def solid_at(profile, z: float) -> bool:
    """Whether a profile is solid at a height."""
    return next(slab >= 0 for top, slab in profile if z <= top)


@given(st.data())
def test_no_path_needs_more_turns_than_it_has(data) -> None:
    heights = st.floats(0.05, HEIGHT_M - 0.05)
    start, end, bounces = data.draw(heights), data.draw(heights), data.draw(st.integers(-4, 4))
    storey = bounces * HEIGHT_M
    unfolded = storey + (end if bounces % 2 == 0 else HEIGHT_M - end)
    shares = sorted(data.draw(st.lists(st.floats(0.01, 0.99), max_size=8, unique=True)))
    walls = []
    for share in shares:
        number = data.draw(st.integers(0, len(PROFILES) - 1))
        z = float(folded(start + share * (unfolded - start)))
        walls.append((number, solid_at(PROFILES[number], z)))
    assert needed(walls, start, end) <= abs(bounces)


@pytest.mark.parametrize(
    ("walls", "expected"),
    [
        ([], 0),
        ([(0, False)], 0),
        ([(0, True)], 1),
        ([(0, True), (0, False)], 1),
        ([(0, False), (0, True), (0, False)], 1),
        ([(0, True), (0, False), (0, True)], 3),
        ([(0, True), (2, True)], 2),
        ([(0, True), (2, True), (0, True)], 3),
        ([(1, True), (1, False)], 1),
        ([(3, True), (3, True)], 1),
    ],
)
def test_walls_that_need_turns(walls, expected) -> None:
    assert needed(walls, 1.2, 1.5) == expected


def test_level_path_at_a_lintel_grazes_both_sides() -> None:
    assert needed([(0, True), (0, False), (0, True)], 2.1, 2.1) == 0
