"""Floor plans: read them from TOML, check them, draw them, and turn them into wall meshes.

>>> import floorplans
>>> plan = floorplans.load("flat")
>>> plan.bounds
(0.0, 0.0, 12.0, 9.0)

A `FloorPlan` is one storey: straight walls with openings, flat floor and ceiling, a material each,
transmitters, and for flights the one to search for (`source`) and the start. `FloorPlan.to_mesh`
builds a `trimesh` of sheets with a material per face, `FloorPlan.solid_segments` returns what is
solid at a height, and `floorplans.pictures.plan_view` draws it. Lengths are in
metres, z is the height above the floor.
"""

from floorplans.errors import PlanError
from floorplans.frame import PlanFrame
from floorplans.generators import generate
from floorplans.generators.regular_office import generate_office
from floorplans.georeference import GeoOrigin
from floorplans.loading import builtin_names, load, loads, save
from floorplans.materials import (
    MATERIAL_COLOURS,
    MATERIAL_EDITIONS,
    MATERIALS,
    MaterialLayer,
    PlanMaterial,
)
from floorplans.mesh import SheetMaterial, WallMesh
from floorplans.plan import FloorPlan
from floorplans.toml.writer import dumps
from floorplans.transmitters import PlanTransmitter
from floorplans.walls import Opening, OpeningKind, Panel, Wall, panels

__all__ = [
    "MATERIALS",
    "MATERIAL_COLOURS",
    "MATERIAL_EDITIONS",
    "FloorPlan",
    "GeoOrigin",
    "MaterialLayer",
    "Opening",
    "OpeningKind",
    "Panel",
    "PlanError",
    "PlanFrame",
    "PlanMaterial",
    "PlanTransmitter",
    "SheetMaterial",
    "Wall",
    "WallMesh",
    "builtin_names",
    "dumps",
    "generate",
    "generate_office",
    "load",
    "loads",
    "panels",
    "save",
]
