"""Generated buildings: sound, connected, as large as asked for, and the same on any machine."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

import floorplans
from floorplans import FloorPlan, generate
from floorplans.checks.inspection import inspect
from floorplans.generators import KINDS
from floorplans.generators.generate import LEAST_WITH_WING_M2
from floorplans.generators.rooms import Room, borders, divided
from floorplans.unchecked import PlanFile

SHA256 = {
    "flat": "64d4debd9a19ddc2f5644e481ca49bdd9d7343ba9ca25d03f1abae9e51960027",
    "office": "849790fb6631da1a0b9360c9e61cb8aaca1f00110a90015cde514c058b31a104",
    "hotel": "8bfd9485c6192ce62ced8a5df228d422a134eb5feb7e97d4aa361f3b441908e9",
    "school": "0e7d7654cc425be1f44df04cf84a0065771df514f031b86fff0dca048c92abab",
    "hall": "9acfab37df41dc0c92aa97cff5eb0b60b12c7151f5f63b05072df95610b28077",
}
"""Hashes of the plans of seed 1, as `python -m` of this file prints them."""

kinds = pytest.mark.parametrize("kind", KINDS)


@kinds
@given(seed=st.integers(0, 2**63 - 1), area=st.sampled_from([None, 50.0, 400.0, 10_000.0]))
@settings(max_examples=8)
def test_plans_have_no_errors_and_no_warnings(kind: str, seed: int, area: float | None) -> None:
    plan = generate(kind, seed, area_m2=area)
    assert inspect(PlanFile.of(plan)) == ()
    if area is not None:
        assert plan.outline.area == pytest.approx(area, rel=0.12)


@kinds
@given(seed=st.integers(0, 2**63 - 1), times=st.sampled_from([1.0, 2.0]))
@settings(max_examples=3)
def test_buildings_with_a_wing_have_six_corners_and_no_warnings(
    kind: str, seed: int, times: float
) -> None:
    area = times * LEAST_WITH_WING_M2[kind]
    plan = generate(kind, seed, area_m2=area, shape="L")
    assert inspect(PlanFile.of(plan)) == ()
    assert len(plan.outline.exterior.coords) == 7
    assert plan.outline.area == pytest.approx(area, rel=0.25)
    assert not plan.outline.equals(plan.outline.envelope)


def test_a_wing_needs_room() -> None:
    with pytest.raises(ValueError, match=r"area_m2 = 100\.0: expected 450 m"):
        generate("office", 1, area_m2=100.0, shape="L")
    with pytest.raises(ValueError, match="shape = 'T': expected one of rectangle, L"):
        generate("office", 1, shape="T")


@kinds
@pytest.mark.parametrize("seed", range(6))
def test_every_room_can_be_reached_through_doors(kind: str, seed: int) -> None:
    """The floor without walls, but with the openings of doors, is one piece."""
    plan = generate(kind, seed, furniture=False, shape="L" if seed > 3 else "rectangle")
    solid = [segment for wall in plan.walls for segment in _between_doors(wall)]
    free = plan.outline.difference(shapely.union_all(shapely.linestrings(solid)).buffer(0.03))
    assert isinstance(free, shapely.Polygon)


def _between_doors(wall: floorplans.Wall) -> list[list[tuple[float, float]]]:
    doors = [(o.offset_m, o.end_m) for o in wall.openings if o.kind == "door"]
    is_outer = len(wall.openings) != len(doors)
    ends = [0.0, *(s for door in doors for s in door), wall.length_m]
    if is_outer:
        ends = [0.0, wall.length_m]
    return [
        [wall.point_at(low), wall.point_at(high)]
        for low, high in list(pairwise(ends))[::2]
        if high - low > 1e-9
    ]


@kinds
def test_the_same_seed_gives_the_same_plan(kind: str) -> None:
    assert generate(kind, 1).sha256 == SHA256[kind]
    assert generate(kind, 1).sha256 != generate(kind, 2).sha256


@kinds
@pytest.mark.parametrize("seed", range(4))
def test_connecting_doors_leave_all_else_as_it_is(kind: str, seed: int) -> None:
    """Walls are the same; one without an opening may have a door, and no other changes."""
    without = generate(kind, seed, furniture=False)
    plan = generate(kind, seed, furniture=False, connecting_doors=1.0)
    assert generate(kind, seed, furniture=False, connecting_doors=0.0).sha256 == without.sha256
    more = 0
    for wall, before in zip(plan.walls, without.walls, strict=True):
        assert (wall.start, wall.end, wall.material) == (before.start, before.end, before.material)
        if wall != before:
            assert not before.openings
            assert [opening.kind for opening in wall.openings] == ["door"]
            more += 1
    assert more > 0 or kind == "hall"
    assert inspect(PlanFile.of(generate(kind, seed, connecting_doors=0.5))) == ()


def test_a_chance_of_doors_is_from_0_to_1() -> None:
    with pytest.raises(ValueError, match=r"connecting_doors = 1\.5: expected a chance from 0 to 1"):
        generate("office", 1, connecting_doors=1.5)


@kinds
def test_furniture_is_clutter_clear_of_walls(kind: str) -> None:
    plan = generate(kind, 3)
    clutter = [wall for wall in plan.walls if wall.kind == "clutter"]
    assert clutter
    lines = shapely.linestrings([[wall.start, wall.end] for wall in clutter])
    walls = shapely.union_all(
        shapely.linestrings([[w.start, w.end] for w in plan.walls if w.kind == "wall"])
    )
    assert shapely.distance(lines, walls).min() >= 0.35
    bare = generate(kind, 3, furniture=False)
    assert bare.walls == tuple(wall for wall in plan.walls if wall.kind == "wall")


@pytest.mark.parametrize("count", [0, 1, 4, 12])
def test_transmitters_are_spread_and_hang_free(count: int) -> None:
    plan = generate("office", 4, area_m2=800.0, n_transmitters=count)
    assert len(plan.transmitters) == count
    assert len({transmitter.position for transmitter in plan.transmitters}) == count
    places = np.array([t.position for t in plan.transmitters]).reshape(-1, 3)
    assert np.all(places[:, 2] < plan.height_m)
    for point in shapely.points(places[:, :2]):
        assert plan.outline.contains(point)
        assert shapely.distance(point, _lines(plan)) >= 0.25
    if count > 1:
        gaps = np.hypot(*(places[:, None, :2] - places[None, :, :2]).T)
        assert gaps[gaps > 0.0].min() > 0.5 * np.sqrt(plan.outline.area / count)


def _lines(plan: FloorPlan) -> shapely.Geometry:
    return shapely.union_all(shapely.linestrings([[w.start, w.end] for w in plan.walls]))


@given(st.data())
@settings(max_examples=30)
def test_borders_are_those_of_a_rectangle_that_was_cut(data: st.DataObject) -> None:
    """Every border has the rooms beside it that contain points beside its middle."""
    width, depth = (data.draw(st.integers(40, 900)) for _ in range(2))
    rooms = [Room((0, 0), (width, depth), "hall")]
    for _ in range(data.draw(st.integers(0, 8))):
        room = rooms.pop(data.draw(st.integers(0, len(rooms) - 1)))
        axis = data.draw(st.sampled_from((0, 1)))
        if room.size[axis] < 20:
            rooms.append(room)
            continue
        at = data.draw(st.integers(room.low[axis] + 10, room.high[axis] - 10))
        rooms.extend(room.cut(axis, at))
    total = 0
    for border in borders(rooms):
        middle = 0.5 * (border.low + border.high)
        for side, number in ((-0.1, border.below), (0.1, border.above)):
            point = [middle, border.at + side]
            assert _room_at(rooms, point[:: 1 if border.axis == 0 else -1]) == number
        total += border.length * (2 if min(border.below, border.above) >= 0 else 1)
    assert total == sum(2 * sum(room.size) for room in rooms)


def _room_at(rooms: list[Room], point: list[float]) -> int:
    inside = [
        number
        for number, room in enumerate(rooms)
        if all(a < c < b for a, c, b in zip(room.low, point, room.high, strict=True))
    ]
    return inside[0] if inside else -1


@given(st.integers(100, 9000), st.integers(20, 60), st.integers(0, 40), st.integers(0, 99))
def test_divided_intervals_keep_to_their_widths(
    length: int, tens: int, more: int, seed: int
) -> None:
    least, most = 10 * tens, 10 * (tens + more)
    ends = divided(np.random.default_rng(seed), 0, length, (least, most))
    widths = np.diff(ends)
    assert ends[0] == 0
    assert ends[-1] == length
    assert np.all(widths[:-1] <= most)
    assert np.all(widths[:-1] >= least)
    assert widths[-1] >= min(least, length)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("castle", 1), "kind = 'castle': expected one of flat, office"),
        (("flat", -1), "seed = -1: expected an integer"),
        (("flat", 2**63), "expected an integer from 0"),
        (("flat", 1.5), r"seed = 1\.5"),
    ],
)
def test_wrong_arguments_are_refused(arguments: tuple[str, int], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        generate(*arguments)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"area_m2": 49.0}, r"area_m2 = 49.0: expected 50 to 10000 m\^2"),
        ({"area_m2": float("nan")}, "area_m2 = nan"),
        ({"n_transmitters": -1}, "n_transmitters = -1: expected an integer from 0 to 1000"),
        ({"n_transmitters": 1.5}, r"n_transmitters = 1\.5"),
        ({"n_transmitters": True}, "n_transmitters = True"),
    ],
)
def test_wrong_options_are_refused(options: dict[str, float], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        generate("hall", 1, **options)  # pyright: ignore[reportArgumentType]


if __name__ == "__main__":
    for name in KINDS:
        print(f'    "{name}": "{generate(name, 1).sha256}",')
