"""The properties of a plan's materials that are fitted: values, priors, and plans made of them."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from floorplans import FloorPlan, PlanMaterial
from floorplans.materials import MATERIALS, MaterialLayer
from raytrace.arrays import Floats
from raytrace.constants import TWO_PI, VACUUM_PERMITTIVITY
from raytrace.radio.materials import Dielectric, Layered, Material, Slab, dielectrics_of
from rssnav.measurements.survey import SurveyError

PERMITTIVITY, CONDUCTIVITY = "permittivity", "conductivity"
LEAST_CONDUCTIVITY = 1e-5
"""Conductivity that a material without losses is given as its prior [S/m]."""

SUFFIX = "_calibrated"
NOT_BUILDING = ("vacuum", "air", "metal", "very_dry_ground", "medium_dry_ground", "wet_ground")
"""Materials of the Recommendation that say nothing about how those of walls differ."""


@dataclass(frozen=True)
class MaterialValue:
    """A property of a material that is fitted, as a logarithm.

    Attributes
    ----------
    material
        Name of the material in the plan.
    kind
        "permittivity", for log(permittivity - 1), or "conductivity", for log(conductivity).
    prior, spread
        Mean and standard deviation of its prior.
    """

    material: str
    kind: str
    prior: float
    spread: float

    def quantity(self, value: float) -> float:
        """Return the relative permittivity or the conductivity [S/m] of a value."""
        return float(np.exp(value) + (1.0 if self.kind == PERMITTIVITY else 0.0))


def spreads(frequency_hz: float) -> dict[str, float]:
    """Standard deviation of both logarithms over the building materials of ITU-R P.2040."""
    found: list[tuple[float, float]] = []
    for name, material in dielectrics_of().items():
        rows = [r for r in material.rows if r.low_ghz <= frequency_hz * 1e-9 <= r.high_ghz]
        if rows and name not in NOT_BUILDING:
            found.append(_logarithms(material.complex_permittivity(frequency_hz), frequency_hz))
    if len(found) < 3:
        return {PERMITTIVITY: 1.0, CONDUCTIVITY: 1.5}
    deviation = np.std(np.array(found), axis=0)
    return {PERMITTIVITY: float(deviation[0]), CONDUCTIVITY: float(deviation[1])}


def _logarithms(permittivity: complex, frequency_hz: float) -> tuple[float, float]:
    conductivity = -permittivity.imag * TWO_PI * frequency_hz * VACUUM_PERMITTIVITY
    return (
        float(np.log(max(permittivity.real - 1.0, 1e-2))),
        float(np.log(max(conductivity, LEAST_CONDUCTIVITY))),
    )


def dielectrics_in(slabs: Sequence[Slab]) -> dict[str, Dielectric]:
    """Return the dielectrics of slabs and of their layers by name; air and vacuum are left out."""
    found: dict[str, Dielectric] = {}
    for slab in slabs:
        material = slab.material
        layers = [m for m, _ in material.layers] if isinstance(material, Layered) else [material]
        for part in layers:
            if isinstance(part, Dielectric) and part.name not in ("air", "vacuum"):
                found[part.name] = part
    return found


def material_values(
    slabs: Sequence[Slab],
    frequency_hz: float,
    names: Sequence[str] | None = None,
    measured: Collection[str] = (),
) -> tuple[MaterialValue, ...]:
    """List the properties that can be fitted.

    Parameters
    ----------
    slabs
        Of the scene.
    frequency_hz
        Frequency of the survey [Hz].
    names
        Materials; all of the slabs by default.
    measured
        Materials whose loss is measured, which keep it.

    Raises
    ------
    SurveyError
        For a name that no slab has, or of a measured material.
    """
    known = {n: m for n, m in dielectrics_in(slabs).items() if n not in measured}
    for name in names or ():
        if name in measured:
            raise SurveyError(
                f"material {name!r} has a measured loss, which stays as it is: give its "
                "conductivity in place of loss_db to fit it"
            )
        if name not in known:
            raise SurveyError(
                f"no wall, floor or ceiling is made of {name!r} as a dielectric: "
                f"known: {', '.join(known)}"
            )
    spread = spreads(frequency_hz)
    return tuple(
        MaterialValue(name, kind, prior, spread[kind])
        for name in (names or known)
        for kind, prior in zip(
            (PERMITTIVITY, CONDUCTIVITY),
            _logarithms(known[name].complex_permittivity(frequency_hz), frequency_hz),
            strict=True,
        )
    )


def plan_values(of: Sequence[MaterialValue]) -> Floats:
    """Return what the plan says of some properties (n_values,)."""
    return np.array([value.prior for value in of])


def slabs_with(
    slabs: Sequence[Slab], of: Sequence[MaterialValue], values: Floats, frequency_hz: float
) -> list[Slab]:
    """Return slabs with other values of their materials."""
    changed = {
        name: _dielectric(known, _of_material(of, values, name), frequency_hz)
        for name, known in dielectrics_in(slabs).items()
        if any(v.material == name for v in of)
    }
    return [slab._replace(material=_replaced(slab.material, changed)) for slab in slabs]


def _of_material(of: Sequence[MaterialValue], values: Floats, material: str) -> dict[str, float]:
    """Quantities of a material by kind."""
    return {
        known.kind: known.quantity(value)
        for known, value in zip(of, values, strict=True)
        if known.material == material
    }


def _dielectric(
    known: Dielectric, quantities: Mapping[str, float], frequency_hz: float
) -> Dielectric:
    """Return a material with other quantities at a frequency, by the law it has there."""
    law = law_of(known, quantities, frequency_hz)
    return Dielectric.of_law(known.name, **law)


def law_of(
    known: Dielectric, quantities: Mapping[str, float], frequency_hz: float
) -> dict[str, float]:
    """Constants a, b, c, d of a law that has some quantities at a frequency."""
    f_ghz = frequency_hz * 1e-9
    row = next(r for r in known.rows if r.low_ghz <= f_ghz <= r.high_ghz)
    a, c = row.a, row.c
    if PERMITTIVITY in quantities:
        a = quantities[PERMITTIVITY] / f_ghz**row.b
    if CONDUCTIVITY in quantities:
        c = quantities[CONDUCTIVITY] / f_ghz**row.d
    return {"a": a, "b": row.b, "c": c, "d": row.d}


def _replaced(material: Material, changed: Mapping[str, Dielectric]) -> Material:
    if isinstance(material, Layered):
        layers = tuple(
            layer._replace(material=changed.get(layer.material.name, layer.material))
            for layer in material.layers
        )
        return replace(material, layers=layers)
    return changed.get(material.name, material)


def plan_with(
    plan: FloorPlan,
    slabs: Sequence[Slab],
    of: Sequence[MaterialValue],
    values: Floats,
    frequency_hz: float,
) -> FloorPlan:
    """Return a plan with other values of its materials; built-in ones become the plan's own."""
    known = dielectrics_in(slabs)
    laws = {
        name: law_of(known[name], _of_material(of, values, name), frequency_hz)
        for name in dict.fromkeys(v.material for v in of)
    }
    renamed = {name: name + SUFFIX for name in laws if name in MATERIALS}
    own = tuple(_own(material, laws, renamed) for material in plan.materials)
    new = tuple(replace(PlanMaterial(renamed[name]), **laws[name]) for name in renamed)

    def of_name(name: str) -> str:
        return renamed.get(name, name)

    walls = tuple(
        replace(
            wall,
            material=of_name(wall.material),
            openings=tuple(
                replace(o, material=None if o.material is None else of_name(o.material))
                for o in wall.openings
            ),
        )
        for wall in plan.walls
    )
    return replace(
        plan,
        walls=walls,
        floor_material=of_name(plan.floor_material),
        ceiling_material=of_name(plan.ceiling_material),
        materials=own + new,
    )


def _own(
    material: PlanMaterial, laws: Mapping[str, Mapping[str, float]], renamed: Mapping[str, str]
) -> PlanMaterial:
    """Return a plan's own material with its new law, or with layers of new names."""
    if material.layers:
        layers = tuple(
            MaterialLayer(renamed.get(layer.material, layer.material), layer.thickness_m)
            for layer in material.layers
        )
        return replace(material, layers=layers)
    return replace(material, **laws[material.name]) if material.name in laws else material
