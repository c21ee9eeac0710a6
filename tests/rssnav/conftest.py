import pytest
from small_worlds import room_plan, world_of


@pytest.fixture
def room():
    return room_plan()


@pytest.fixture
def room_world(room):
    return world_of(room)
