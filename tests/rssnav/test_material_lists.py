"""The materials a plan may name are those the tracer knows."""

import floorplans
from raytrace.materials import MATERIALS


def test_plans_and_tracer_name_the_same_materials() -> None:
    assert set(floorplans.MATERIALS) == set(MATERIALS)
