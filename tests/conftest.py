"""Shared by all tests: hypothesis repeats itself, and the scenarios' maps are made once."""

from collections.abc import Callable, Generator
from functools import cache

import pytest
from hypothesis import settings
from own_interrupts import accept_interrupts

import floorplans
from raytrace import Grid, RadioMap, Scene, Transmitter, compute_radio_map

settings.register_profile("rssnav", deadline=None, derandomize=True, print_blob=False)
settings.load_profile("rssnav")
accept_interrupts()


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport() -> Generator[None, pytest.TestReport, pytest.TestReport]:
    """Escape what is no text in captured output: other processes get reports as UTF-8."""
    report = yield
    report.sections = [
        (name, text.encode("utf-8", "backslashreplace").decode()) for name, text in report.sections
    ]
    return report


ScenarioMap = Callable[[str], RadioMap]


@pytest.fixture(scope="session")
def scenario_map() -> ScenarioMap:
    """Return a function from a built-in plan's name to its whole map, 1 m apart at 2 m height."""

    @cache
    def compute(name: str) -> RadioMap:
        plan = floorplans.load(name)
        walls = plan.to_mesh()
        scene = Scene.from_mesh(walls.mesh, walls.face_material, walls.materials)
        grid = Grid.over(plan.bounds, 1.0, 2.0)
        return compute_radio_map(scene, Transmitter(plan.source), grid)

    return compute
