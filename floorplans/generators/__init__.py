"""Seeded buildings: flats, offices, hotels, schools, halls.

A layout divides a rectangle into rooms and corridors (`layouts`), in whole centimetres. From it
follow walls, doors and windows (`building`), furniture (`furniture`), and transmitters, source and
start (`places`). `regular_office` has offices of equal rooms, without a seed, for measurements.
"""

from floorplans.generators.generate import (
    GENERATOR_VERSION,
    KINDS,
    LARGEST_M2,
    LEAST_M2,
    SHAPES,
    Kind,
    generate,
)
from floorplans.generators.layouts import Shape

__all__ = [
    "GENERATOR_VERSION",
    "KINDS",
    "LARGEST_M2",
    "LEAST_M2",
    "SHAPES",
    "Kind",
    "Shape",
    "generate",
]
