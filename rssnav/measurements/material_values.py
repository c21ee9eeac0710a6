"""The properties of a plan's materials that are fitted: values, priors, and plans made of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from floorplans import FloorPlan, PlanMaterial
from floorplans.materials import MATERIALS, MaterialLayer
from raytrace.arrays import Floats
from raytrace.constants import TWO_PI, VACUUM_PERMITTIVITY
from raytrace.radio.materials import Dielectric, Layered, Material, Slab, dielectrics_of
from rssnav.measurements.survey import SurveyError

PERMITTIVITY, CONDUCTIVITY, LOSS = "permittivity", "conductivity", "loss"
UNITS = {PERMITTIVITY: "", CONDUCTIVITY: "S/m", LOSS: "dB"}
LEAST_LOSS_DB = 0.1
"""Loss beyond reflection that a material with less has as its prior [dB]."""

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
        "permittivity", for log(permittivity - 1), "conductivity", for log(conductivity), or "loss",
        for the logarithm of a sheet's measured loss beyond that by reflection alone.
    prior, spread
        Mean and standard deviation of its prior.
    least
        What the quantity exceeds: 1 for a permittivity, the loss by reflection for a loss [dB].
    loss_frequency_hz
        Frequency of a loss [Hz].
    """

    material: str
    kind: str
    prior: float
    spread: float
    least: float = 0.0
    loss_frequency_hz: float = 0.0

    def quantity(self, value: float) -> float:
        """Return the relative permittivity, the conductivity [S/m] or the loss [dB] of a value."""
        return float(np.exp(value) + self.least)

    @property
    def unit(self) -> str:
        """Unit of the quantity; empty for a permittivity."""
        return UNITS[self.kind]


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
    of_loss: Mapping[str, PlanMaterial] | None = None,
) -> tuple[MaterialValue, ...]:
    """List the properties that can be fitted.

    Parameters
    ----------
    slabs
        Of the scene.
    frequency_hz
        Frequency of the survey [Hz].
    names
        Materials; by default all of the slabs but those of a measured loss.
    of_loss
        The plan's materials of a measured loss by name.

    Raises
    ------
    SurveyError
        For a name that no slab has.
    """
    losses = of_loss or {}
    known, spread = dielectrics_in(slabs), spreads(frequency_hz)
    found: list[MaterialValue] = []
    for name in names or [name for name in known if name not in losses]:
        if name not in known:
            raise SurveyError(
                f"no wall, floor or ceiling is made of {name!r} as a dielectric: "
                f"known: {', '.join(known)}"
            )
        if name in losses:
            found.append(_loss_value(slabs, losses[name], spread[CONDUCTIVITY]))
            continue
        priors = _logarithms(known[name].complex_permittivity(frequency_hz), frequency_hz)
        found.append(MaterialValue(name, PERMITTIVITY, priors[0], spread[PERMITTIVITY], 1.0))
        found.append(MaterialValue(name, CONDUCTIVITY, priors[1], spread[CONDUCTIVITY]))
    return tuple(found)


def _loss_value(slabs: Sequence[Slab], material: PlanMaterial, spread: float) -> MaterialValue:
    """Return the loss of a material as a property.

    Beyond reflection, it grows with the conductivity: their logarithms have the same spread.
    """
    loss_db, frequency_hz = material.loss_db, material.loss_frequency_hz
    assert loss_db is not None
    assert frequency_hz is not None
    lossless = Dielectric.of_law(material.name, material.a)
    through = (
        lossless.coefficients(slab.thickness_m, frequency_hz, np.ones(1)).t_te[0]
        for slab in slabs
        if slab.material.name == material.name
    )
    least = max(-20.0 * float(np.log10(abs(t))) for t in through)
    prior = float(np.log(max(loss_db - least, LEAST_LOSS_DB)))
    return MaterialValue(material.name, LOSS, prior, spread, least, frequency_hz)


def plan_values(of: Sequence[MaterialValue]) -> Floats:
    """Return what the plan says of some properties (n_values,)."""
    return np.array([value.prior for value in of])


def slabs_with(
    slabs: Sequence[Slab], of: Sequence[MaterialValue], values: Floats, frequency_hz: float
) -> list[Slab]:
    """Return slabs with other values of their materials."""
    losses = {v.material: (v, x) for v, x in zip(of, values, strict=True) if v.kind == LOSS}
    changed = {
        name: _dielectric(known, _of_material(of, values, name), frequency_hz)
        for name, known in dielectrics_in(slabs).items()
        if name not in losses and any(v.material == name for v in of)
    }

    def material_of(slab: Slab) -> Material:
        if slab.material.name in losses:
            return _lossy(slab, *losses[slab.material.name])
        return _replaced(slab.material, changed)

    return [slab._replace(material=material_of(slab)) for slab in slabs]


def _lossy(slab: Slab, loss: MaterialValue, value: float) -> Dielectric:
    """Return a slab's material with another loss."""
    material, frequency_hz = slab.material, loss.loss_frequency_hz
    assert isinstance(material, Dielectric)
    permittivity = material.rows[0].a
    loss_db = loss.quantity(value)
    return Dielectric.of_loss(material.name, permittivity, loss_db, frequency_hz, slab.thickness_m)


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
    laws: dict[str, dict[str, float]] = {}
    for name in dict.fromkeys(v.material for v in of):
        quantities = _of_material(of, values, name)
        if LOSS in quantities:
            laws[name] = {"loss_db": quantities[LOSS]}
        else:
            laws[name] = law_of(known[name], quantities, frequency_hz)
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
