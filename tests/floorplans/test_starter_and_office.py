"""Plans the program writes by itself: starters of any size, and generated offices."""

import time

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import floorplans
from floorplans.pictures.plan_view import save_plan_picture
from floorplans.starter import starter_plan


@settings(deadline=None, max_examples=60)
@given(st.floats(5.0, 1000.0), st.floats(5.0, 1000.0), st.floats(2.5, 50.0))
def test_starter_of_any_size_is_a_plan(width: float, depth: float, height: float) -> None:
    plan = floorplans.loads(starter_plan('of "any" size', width, depth, height))
    assert plan.name == 'of "any" size'
    assert plan.bounds == pytest.approx((0.0, 0.0, width, depth))
    assert {o.kind for wall in plan.walls for o in wall.openings} == {"door", "window", "passage"}


def test_starter_explains_its_keys() -> None:
    text = starter_plan("my", 40.0, 25.0)
    assert text.count("\n#") > 10
    assert "outline = [[0, 0], [40, 0], [40, 25], [0, 25], [0, 0]]" in text


@pytest.mark.parametrize("size", [(4.9, 9.0, 3.0), (9.0, 1001.0, 3.0), (9.0, 9.0, 2.0)])
def test_starter_of_invalid_size_is_rejected(size: tuple[float, float, float]) -> None:
    with pytest.raises(ValueError, match="expected"):
        starter_plan("my", *size)


@pytest.mark.parametrize("courtyard", [False, True])
def test_office_has_two_openings_a_room(courtyard: bool) -> None:
    office = floorplans.generate_office(5, 4, courtyard=courtyard)
    assert sum(len(wall.openings) for wall in office.walls) == 2 * 5 * 4
    assert len(office.outline.interiors) == courtyard
    assert floorplans.loads(floorplans.dumps(office)) == office


def test_courtyard_needs_rooms_around_it() -> None:
    with pytest.raises(ValueError, match="2 x 5 rooms: a courtyard needs 3 x 3"):
        floorplans.generate_office(2, 5, courtyard=True)


def test_large_office_loads_checks_and_draws_in_time(tmp_path) -> None:
    office = floorplans.generate_office(15, 10, courtyard=True)
    text = floorplans.dumps(office)
    start_s = time.process_time()
    save_plan_picture(floorplans.loads(text), tmp_path / "office.png")
    assert time.process_time() - start_s < 5.0
