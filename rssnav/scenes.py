"""Floor plan -> scene: the tracer's view of a building, for any transmitter in it."""

from dataclasses import dataclass, fields

import numpy as np

from floorplans import FloorPlan, PlanMaterial
from raytrace import Dielectric, Layer, Layered, Material, Scene, SceneError
from raytrace.radio.itu import DEFAULT_EDITION
from raytrace.radio.materials import Slab, find_material

_NOT_OF_THE_SCENE = {
    "name",
    "source",
    "start",
    "transmitters",
    "origin",
    "frame",
    "material_edition",
}
"""Attributes of a plan that its scene does not depend on; `PlanScene` compares the edition."""


def edition_of(plan: FloorPlan, edition: str | None = None) -> str:
    """Edition of ITU-R P.2040: the one asked for, or the plan's, or the tracer's default."""
    return edition or plan.material_edition or DEFAULT_EDITION


def scene_of(plan: FloorPlan, edition: str | None = None) -> Scene:
    """Make a plan's scene.

    Parameters
    ----------
    plan : FloorPlan
    edition : str, optional
        Of ITU-R P.2040, for the built-in materials; see `edition_of`.

    Raises
    ------
    SceneError
        Where the tracer cannot work with the plan; the message names it.
    """
    walls = plan.to_mesh()
    edition = edition_of(plan, edition)
    try:
        own = _own_materials(plan, edition)
        materials = [(_material(plan, own, *sheet), sheet.thickness_m) for sheet in walls.materials]
        return Scene.from_mesh(
            walls.mesh,
            walls.face_material,
            materials,
            edition=edition,
            edgeless=np.flatnonzero(walls.clutter),
            ground_margin_m=plan.ground_margin_m,
        )
    except SceneError as error:
        raise SceneError(f"plan {plan.name!r}: {error}") from error


@dataclass(frozen=True, eq=False)
class PlanScene:
    """The scene of a plan's building, for any source and start in it.

    Attributes
    ----------
    plan
        The plan it was built from.
    scene
        The building as the tracer sees it.
    """

    plan: FloorPlan
    scene: Scene

    def __repr__(self) -> str:
        """Plan and scene in one line."""
        return f"<PlanScene: {self.plan!r}, {self.scene!r}>"

    @classmethod
    def of(cls, plan: FloorPlan, edition: str | None = None) -> "PlanScene":
        """Build a plan's scene; parameters and errors as of `scene_of`."""
        return cls(plan, scene_of(plan, edition))

    def fits(self, plan: FloorPlan, edition: str | None = None) -> bool:
        """Return whether a plan has the same building: all but what is placed in it.

        Name, source, start, transmitters, origin and frame may differ. For the edition see
        `scene_of`.
        """
        return edition_of(plan, edition) == self.scene.material_edition and all(
            getattr(plan, field.name) == getattr(self.plan, field.name)
            for field in fields(plan)
            if field.name not in _NOT_OF_THE_SCENE
        )


def slab_of(plan: FloorPlan, name: str, thickness_m: float, edition: str | None = None) -> Slab:
    """Return what the tracer makes of a sheet of a plan's walls.

    Raises
    ------
    SceneError
        For an unknown material.
    """
    edition = edition_of(plan, edition)
    own = _own_materials(plan, edition)
    return Slab.of(_material(plan, own, name, thickness_m), thickness_m, edition)


def _material(
    plan: FloorPlan, own: dict[str, Material], name: str, thickness_m: float
) -> Material | str:
    """Material of a sheet; a measured loss is that of the sheet's thickness."""
    told = plan.own_materials.get(name)
    if told is None or told.loss_db is None or told.loss_frequency_hz is None:
        return own.get(name, name)
    return Dielectric.of_loss(name, told.a, told.loss_db, told.loss_frequency_hz, thickness_m)


def _own_materials(plan: FloorPlan, edition: str) -> dict[str, Material]:
    """Convert a plan's own materials to those of the tracer."""
    dielectrics = {m.name: _dielectric(m) for m in plan.materials if not m.layers}

    def layer(name: str, thickness_m: float) -> Layer:
        material = dielectrics.get(name) or find_material(name, edition)
        assert isinstance(material, Dielectric)
        return Layer(material, thickness_m)

    layered = {
        m.name: Layered(m.name, tuple(layer(*of) for of in m.layers))
        for m in plan.materials
        if m.layers
    }
    return {**dielectrics, **layered}


def _dielectric(material: PlanMaterial) -> Dielectric:
    return Dielectric.of_law(material.name, material.a, material.b, material.c, material.d)
