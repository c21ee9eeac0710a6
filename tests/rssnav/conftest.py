import pytest
from small_worlds import log_distance_map, room_plan, world_of

from rssnav.experiments.paper.scenarios import Scenario, make_worlds
from rssnav.experiments.studies import study


@pytest.fixture
def room():
    return room_plan()


@pytest.fixture
def room_world(room):
    return world_of(room)


@pytest.fixture
def small_study(tmp_path, monkeypatch, room):
    """A folder for a study whose two scenarios are a small room, at 1 m/s only."""
    radio_map = log_distance_map(room)
    scenarios = {number: Scenario(room, radio_map) for number in (1, 2)}
    monkeypatch.setattr(study, "load_scenarios", lambda *_, **__: scenarios)
    monkeypatch.setattr(study, "make_worlds", lambda scenarios: make_worlds(scenarios, (1,)))
    return tmp_path
