"""Small IFC models, made with ifcopenshell itself."""

from __future__ import annotations

from math import hypot
from pathlib import Path

import ifcopenshell
import numpy as np
from ifcopenshell.api import (
    aggregate,
    context,
    feature,
    geometry,
    material,
    project,
    root,
    spatial,
    unit,
)

Point = tuple[float, float]


class Model:
    """A building to which storeys, walls, doors and slabs are added, lengths in metres."""

    def __init__(self, prefix: str | None = "MILLI", schema: str = "IFC4") -> None:
        self.file = project.create_file(version=schema)
        self.project = root.create_entity(self.file, ifc_class="IfcProject", name="House")
        length = unit.add_si_unit(self.file, unit_type="LENGTHUNIT", prefix=prefix)
        self.units = unit.assign_unit(self.file, units=[length])
        model = context.add_context(self.file, context_type="Model")
        self.contexts = {
            name: context.add_context(
                self.file,
                context_type="Model",
                context_identifier=name,
                target_view=view,
                parent=model,
            )
            for name, view in (("Body", "MODEL_VIEW"), ("Axis", "GRAPH_VIEW"))
        }
        self.metre = 1000.0 if prefix == "MILLI" else 1.0
        self.building = root.create_entity(self.file, ifc_class="IfcBuilding", name="House")
        aggregate.assign_object(self.file, products=[self.building], relating_object=self.project)
        self.storey = None
        self.elevation_m = 0.0

    def add_storey(self, name: str, elevation_m: float = 0.0) -> None:
        self.storey = root.create_entity(self.file, ifc_class="IfcBuildingStorey", name=name)
        aggregate.assign_object(self.file, products=[self.storey], relating_object=self.building)
        self.elevation_m = elevation_m
        self._place(self.storey, (0.0, 0.0), (1.0, 0.0), 0.0)

    def add_wall(
        self,
        start: Point,
        end: Point,
        thickness_m: float = 0.2,
        height_m: float = 2.7,
        ifc_class: str = "IfcWall",
    ):
        """Add a wall whose body lies in the middle of its line."""
        wall = root.create_entity(self.file, ifc_class=ifc_class)
        along = (end[0] - start[0], end[1] - start[1])
        body = geometry.add_wall_representation(
            self.file, context=self.contexts["Body"], length=hypot(*along), height=height_m,
            thickness=thickness_m, offset=-thickness_m / 2,
        )  # fmt: skip
        geometry.assign_representation(self.file, product=wall, representation=body)
        self._place(wall, start, along, 0.0)
        if self.storey is not None:
            spatial.assign_container(self.file, products=[wall], relating_structure=self.storey)
        return wall

    def add_column(self, at: Point, width_m: float, height_m: float = 2.7, is_round: bool = False):
        f, metre = self.file, self.metre
        column = root.create_entity(f, ifc_class="IfcColumn")
        axes = f.createIfcAxis2Placement2D(f.createIfcCartesianPoint((0.0, 0.0)))
        if is_round:
            profile = f.createIfcCircleProfileDef("AREA", None, axes, width_m / 2 * metre)
        else:
            profile = f.createIfcRectangleProfileDef(
                "AREA", None, axes, width_m * metre, width_m * metre
            )
        self._give_body(column, profile, height_m)
        self._place(column, at, (1.0, 0.0), 0.0)
        spatial.assign_container(f, products=[column], relating_structure=self.storey)
        return column

    def add_curtain_wall(self, length_m: float, step_m: float, height_m: float = 2.7):
        """Add a curtain wall of plates and mullions 0.15 m deep, along x from (0, 0)."""
        f, metre = self.file, self.metre
        curtain = root.create_entity(f, ifc_class="IfcCurtainWall")
        self._place(curtain, (0.0, 0.0), (1.0, 0.0), 0.0)
        spatial.assign_container(f, products=[curtain], relating_structure=self.storey)
        n = round(length_m / step_m)
        parts = [("IfcPlate", (k + 0.5) * step_m, step_m - 0.05, 0.02) for k in range(n)]
        parts += [("IfcMember", k * step_m, 0.05, 0.15) for k in range(n + 1)]
        for ifc_class, x, *sides in parts:
            part = root.create_entity(f, ifc_class=ifc_class)
            axes = f.createIfcAxis2Placement2D(f.createIfcCartesianPoint((0.0, 0.0)))
            sizes = [side * metre for side in sides]
            self._give_body(
                part, f.createIfcRectangleProfileDef("AREA", None, axes, *sizes), height_m
            )
            self._place(part, (x, 0.0), (1.0, 0.0), 0.0)
            aggregate.assign_object(f, products=[part], relating_object=curtain)

    def add_wall_of_faces(self, start: Point, end: Point, thickness_m: float, height_m: float):
        """Add a wall along x or y whose body is six faces."""
        wall = root.create_entity(self.file, ifc_class="IfcWall")
        (x0, y0), (x1, y1), half = start, end, thickness_m / 2
        dx, dy = (0.0, half) if y0 == y1 else (half, 0.0)
        low = [(x0 - dx, y0 - dy), (x1 - dx, y1 - dy), (x1 + dx, y1 + dy), (x0 + dx, y0 + dy)]
        vertices = [(x, y, z) for z in (0.0, height_m) for x, y in low]
        sides = [[k, (k + 1) % 4, (k + 1) % 4 + 4, k + 4] for k in range(4)]
        body = geometry.add_mesh_representation(
            self.file,
            context=self.contexts["Body"],
            vertices=[vertices],
            faces=[[[3, 2, 1, 0], [4, 5, 6, 7], *sides]],
        )
        geometry.assign_representation(self.file, product=wall, representation=body)
        self._place(wall, (0.0, 0.0), (1.0, 0.0), 0.0)
        spatial.assign_container(self.file, products=[wall], relating_structure=self.storey)
        return wall

    def add_ring(self, corners: list[Point], **options):
        sides = zip(corners, corners[1:] + corners[:1], strict=True)
        return [self.add_wall(start, end, **options) for start, end in sides]

    def add_curved_wall(self, centre: Point, radius_m: float, thickness_m: float, height_m: float):
        """Add a half ring, from east over north to west, with a trimmed circle for its axis."""
        f, metre = self.file, self.metre
        wall = root.create_entity(f, ifc_class="IfcWall")
        axes = f.createIfcAxis2Placement2D(f.createIfcCartesianPoint((0.0, 0.0)))

        def arc(radius: float):
            circle = f.createIfcCircle(axes, radius * metre)
            ends = [(f.createIfcCartesianPoint((x * radius * metre, 0.0)),) for x in (1.0, -1.0)]
            return f.createIfcTrimmedCurve(circle, *ends, True, "CARTESIAN")

        outer, inner = radius_m + thickness_m / 2, radius_m - thickness_m / 2
        segments = [
            f.createIfcCompositeCurveSegment("CONTINUOUS", True, arc(outer)),
            f.createIfcCompositeCurveSegment("CONTINUOUS", True, self._line(-outer, -inner)),
            f.createIfcCompositeCurveSegment("CONTINUOUS", False, arc(inner)),
            f.createIfcCompositeCurveSegment("CONTINUOUS", True, self._line(inner, outer)),
        ]
        ring = f.createIfcCompositeCurve(segments, False)
        profile = f.createIfcArbitraryClosedProfileDef("AREA", None, ring)
        self._give_body(wall, profile, height_m)
        axis = f.createIfcShapeRepresentation(
            self.contexts["Axis"], "Axis", "Curve2D", [arc(radius_m)]
        )
        geometry.assign_representation(f, product=wall, representation=axis)
        self._place(wall, centre, (1.0, 0.0), 0.0)
        spatial.assign_container(f, products=[wall], relating_structure=self.storey)
        return wall

    def _line(self, from_x: float, to_x: float):
        points = [self.file.createIfcCartesianPoint((x * self.metre, 0.0)) for x in (from_x, to_x)]
        return self.file.createIfcPolyline(points)

    def add_hole(self, wall, offset_m: float, width_m: float, sill_m: float, head_m: float):
        """Cut a hole from a wall, `offset_m` from its start."""
        hole = root.create_entity(self.file, ifc_class="IfcOpeningElement")
        corner = self.file.createIfcCartesianPoint((width_m / 2 * self.metre, 0.0))
        profile = self.file.createIfcRectangleProfileDef(
            "AREA", None, self.file.createIfcAxis2Placement2D(corner),
            width_m * self.metre, 1.0 * self.metre,
        )  # fmt: skip
        self._give_body(hole, profile, head_m - sill_m)
        x, y, u = self._start_of(wall)
        self._place(hole, (x + u[0] * offset_m, y + u[1] * offset_m), u, sill_m)
        feature.add_feature(self.file, feature=hole, element=wall)
        return hole

    def add_hole_across(
        self, wall, middle: Point, width_m: float, sill_m: float, head_m: float
    ) -> None:
        """Cut a hole with a window, along x and 4 m deep, from a wall whose start is (0, 0)."""
        hole = root.create_entity(self.file, ifc_class="IfcOpeningElement")
        origin = self.file.createIfcCartesianPoint((0.0, 0.0))
        profile = self.file.createIfcRectangleProfileDef(
            "AREA", None, self.file.createIfcAxis2Placement2D(origin),
            width_m * self.metre, 4.0 * self.metre,
        )  # fmt: skip
        self._give_body(hole, profile, head_m - sill_m)
        self._place(hole, middle, (1.0, 0.0), sill_m)
        feature.add_feature(self.file, feature=hole, element=wall)
        self.add_filling(hole, "IfcWindow")

    def add_filling(self, hole, ifc_class: str):
        filling = root.create_entity(self.file, ifc_class=ifc_class)
        feature.add_filling(self.file, opening=hole, element=filling)
        spatial.assign_container(self.file, products=[filling], relating_structure=self.storey)
        return filling

    def add_slab(self, corners: list[Point], top_m: float, thickness_m: float = 0.25, **entity):
        slab = root.create_entity(self.file, **({"ifc_class": "IfcSlab"} | entity))
        points = [self.file.createIfcCartesianPoint((x * self.metre, y * self.metre))
                  for x, y in [*corners, corners[0]]]  # fmt: skip
        ring = self.file.createIfcPolyline(points)
        profile = self.file.createIfcArbitraryClosedProfileDef("AREA", None, ring)
        self._give_body(slab, profile, thickness_m)
        self._place(slab, (0.0, 0.0), (1.0, 0.0), top_m - thickness_m)
        spatial.assign_container(self.file, products=[slab], relating_structure=self.storey)
        return slab

    def set_layers(self, element, *layers: tuple[str, float]) -> None:
        """Make an element of layers (material, thickness [m])."""
        layer_set = material.add_material_set(self.file, "walls", "IfcMaterialLayerSet")
        for name, thickness_m in layers:
            one = material.add_material(self.file, name=name)
            layer = material.add_layer(self.file, layer_set=layer_set, material=one)
            layer.LayerThickness = thickness_m * self.metre
        material.assign_material(
            self.file, products=[element], type="IfcMaterialLayerSetUsage", material=layer_set
        )

    def set_constituents(self, element, *layers: tuple[str, float]) -> None:
        """Give an element materials whose widths are quantities, as reference views do."""
        f = self.file
        them = material.add_material_set(f, "wall", "IfcMaterialConstituentSet")
        parts = []
        for k, (name, thickness_m) in enumerate(layers):
            one = material.add_material(f, name=name)
            part = material.add_constituent(f, constituent_set=them, material=one)
            part.Name = f"Layer{k}"
            width = f.createIfcQuantityLength("Width", None, None, thickness_m * self.metre)
            parts.append(f.createIfcPhysicalComplexQuantity(part.Name, None, [width], "layer"))
        quantities = f.createIfcElementQuantity(
            ifcopenshell.guid.new(), None, "Qto", Quantities=parts
        )
        f.createIfcRelDefinesByProperties(
            ifcopenshell.guid.new(), RelatedObjects=[element], RelatingPropertyDefinition=quantities
        )
        material.assign_material(f, products=[element], material=them)

    def set_material(self, element, name: str) -> None:
        one = material.add_material(self.file, name=name)
        material.assign_material(self.file, products=[element], material=one)

    def write(self, path: Path) -> Path:
        self.file.write(str(path))
        return path

    def _give_body(self, product, profile, depth_m: float) -> None:
        up = self.file.createIfcDirection((0.0, 0.0, 1.0))
        solid = self.file.createIfcExtrudedAreaSolid(profile, None, up, depth_m * self.metre)
        body = self.file.createIfcShapeRepresentation(
            self.contexts["Body"], "Body", "SweptSolid", [solid]
        )
        geometry.assign_representation(self.file, product=product, representation=body)

    def _start_of(self, wall) -> tuple[float, float, Point]:
        matrix = ifcopenshell.util.placement.get_local_placement(wall.ObjectPlacement)
        x, y = matrix[:2, 3] / self.metre
        return float(x), float(y), (float(matrix[0, 0]), float(matrix[1, 0]))

    def _place(self, product, start: Point, along: Point, z_m: float) -> None:
        u = np.array(along) / hypot(*along)
        matrix = np.eye(4)
        matrix[:2, 0], matrix[:2, 1] = u, (-u[1], u[0])
        matrix[:3, 3] = (*start, self.elevation_m + z_m)
        geometry.edit_object_placement(self.file, product=product, matrix=matrix, is_si=True)


HOUSE: list[Point] = [(0.0, 0.0), (8.0, 0.0), (8.0, 5.0), (0.0, 5.0)]


def house(prefix: str | None = "MILLI", schema: str = "IFC4") -> Model:
    """Return a storey of 8 m x 5 m: a partition with a door, an entrance, a window, slabs."""
    model = Model(prefix, schema)
    model.add_storey("Ground floor")
    south, east, north, west = model.add_ring(HOUSE, thickness_m=0.3)
    for wall in (south, east, north, west):
        model.set_layers(wall, ("Gypsum plaster", 0.015), ("Brick masonry", 0.27),
                         ("Cement render", 0.015))  # fmt: skip
    partition = model.add_wall((3.0, 0.0), (3.0, 5.0), 0.1)
    model.set_material(partition, "Gipskarton")
    model.add_filling(model.add_hole(south, 4.5, 1.0, 0.0, 2.1), "IfcDoor")
    model.add_filling(model.add_hole(partition, 2.0, 0.9, 0.0, 2.05), "IfcDoor")
    model.add_filling(model.add_hole(north, 1.0, 1.5, 0.9, 2.2), "IfcWindow")
    model.set_material(model.add_slab(HOUSE, 0.0), "Stahlbeton")
    model.set_material(model.add_slab(HOUSE, 2.95), "Stahlbeton")
    return model
