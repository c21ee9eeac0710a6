"""Seeded buildings: flats, offices, hotels, schools, halls.

A layout divides a rectangle into rooms and corridors (`layouts`), in whole centimetres. From it
follow walls, doors and windows (`building`), furniture (`furniture`), and transmitters, source and
start (`places`). `regular_office` has offices of equal rooms, without a seed, for measurements.
"""

from floorplans.generators.generate import KINDS, LARGEST_M2, LEAST_M2, Kind, generate

__all__ = ["KINDS", "LARGEST_M2", "LEAST_M2", "Kind", "generate"]
