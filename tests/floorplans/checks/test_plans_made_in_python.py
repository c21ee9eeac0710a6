"""A plan made in Python is checked as one from a file: types, ranges, and lengths of lists."""

from __future__ import annotations

from dataclasses import fields, replace
from decimal import Decimal

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely.geometry import MultiPolygon, Polygon
from small_plans import box

import floorplans
from floorplans import GeoOrigin, MaterialLayer, Opening, PlanError, PlanMaterial, Wall
from floorplans.values import MAX_OPENINGS

SCREEN = Wall((1.0, 2.0), (3.0, 2.0), "wood", 0.1, 3.0)
DOOR = Opening(0.5, 1.0, 0.0, 2.0, "door")
BOARD = PlanMaterial("board", layers=(MaterialLayer("wood", 0.1),), colour="#112233")
PLAN = box(
    (replace(SCREEN, openings=(DOOR,)),), materials=(BOARD,), origin=GeoOrigin(-2.9, 56.4, 12.0)
)
PARTS = {
    Wall: lambda wall: {"walls": (*PLAN.walls[:4], wall)},
    Opening: lambda opening: {"walls": (*PLAN.walls[:4], replace(SCREEN, openings=(opening,)))},
    PlanMaterial: lambda material: {"materials": (material,)},
    GeoOrigin: lambda origin: {"origin": origin},
}
WHOLE = {Wall: PLAN.walls[4], Opening: DOOR, PlanMaterial: BOARD, GeoOrigin: PLAN.origin}
PLACES = [(type(PLAN), field.name) for field in fields(PLAN)]
PLACES += [(kind, field.name) for kind in PARTS for field in fields(kind)]
WRONG = (
    None, True, "", "x", "\ud800", 10**400, -(10**5000), float("nan"), float("inf"), 1e308, -1.0,
    1e-308, (), (1.0,), ("a", "b", "c"), (float("nan"),) * 2, (1e308, 0.0), (1e308,) * 3, [[]], {},
    b"x", 3 + 4j, Decimal(1), np.array([1.0, 2.0]), np.nan, object(), MultiPolygon(), Polygon(),
    PLAN, GeoOrigin("a", 1e9), (Wall(None, None, None, None, None),), (PlanMaterial(3),),
)  # fmt: skip


def fault(changes: dict[str, object]) -> str | None:
    """Return the message of a changed plan; None if it can be made, and then also written."""
    try:
        plan = replace(PLAN, **changes)
    except PlanError as error:
        return str(error)
    assert floorplans.loads(floorplans.dumps(plan)).sha256 == plan.sha256
    return None


@pytest.mark.parametrize(("kind", "key"), PLACES)
def test_wrong_values(kind: type, key: str) -> None:
    for value in WRONG:
        changes = {key: value}
        if kind in PARTS:
            changes = PARTS[kind](replace(WHOLE[kind], **changes))
        assert len(fault(changes) or "") < 2000


NUMBERS = [(kind, key) for kind, key in PLACES if key.endswith(("_m", "_deg"))]


@settings(max_examples=200, deadline=None)
@given(st.sampled_from(NUMBERS), st.floats() | st.integers() | st.integers(10**300, 10**400))
def test_any_number(place: tuple[type, str], number: float) -> None:
    kind, key = place
    changes = {key: number}
    if kind in PARTS:
        changes = PARTS[kind](replace(WHOLE[kind], **changes))
    message = fault(changes)
    assert message is None or key in message or "wall" in message or "source" in message


@pytest.mark.parametrize("number", [np.float32, np.float64, np.int32, np.uint8, int])
def test_scalars_of_any_width_are_numbers(number: type) -> None:
    plan = box(height_m=number(3), source=tuple(map(number, (1, 1, 1))))
    assert plan == box(source=(1.0, 1.0, 1.0))


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"name": 3}, "name = 3: expected str, not int"),
        ({"walls": (7,)}, "walls[4] = 7: expected Wall, not int"),
        ({"materials": None}, "materials: expected tuple, not NoneType"),
        ({"source": (1.0, 1.0)}, "source = [1.0, 1.0]: expected 3 values"),
        ({"height_m": "3"}, 'height_m = "3": expected a finite number'),
        ({"height_m": 1e4}, "height_m = 10000.0: expected a finite number from 1e-09 to 1000 [m]"),
        (
            {"outline": Polygon([(0, 0), (3000, 0), (0, 1)])},
            "outline: the outline extends over 3000 m; expected at most 2000",
        ),
        (
            {"walls": (replace(SCREEN, openings=(DOOR,) * (MAX_OPENINGS + 1)),)},
            "walls[4].openings: a list of 5001; expected at most 5000",
        ),
        (
            {"walls": (replace(SCREEN, openings=(replace(DOOR, kind="gate"),)),)},
            'walls[4].openings[0].kind = "gate": expected one of door, window, passage',
        ),
    ],
)
def test_messages(changes: dict[str, object], message: str) -> None:
    with pytest.raises(PlanError) as caught:
        box(**changes)
    assert str(caught.value) == message
