import pytest
from small_worlds import log_distance_map, room_plan, world_of

from rssnav.experiments.paper.data import Scenario
from rssnav.experiments.studies import common as studies
from rssnav.experiments.studies import sensitivity


@pytest.fixture
def room():
    return room_plan()


@pytest.fixture
def room_world(room):
    return world_of(room)


@pytest.fixture
def small_study(tmp_path, monkeypatch, room):
    """A folder for a study whose two scenarios are a small room."""
    radio_map = log_distance_map(room)
    scenarios = {number: Scenario(room, radio_map) for number in (1, 2)}
    monkeypatch.setattr(studies, "load_scenarios", lambda *_: scenarios)
    monkeypatch.setattr(studies, "SPEEDS", (1,))
    monkeypatch.setattr(sensitivity, "load_scenarios", lambda *_: scenarios)
    return tmp_path
