"""A plan's own materials in TOML: the tables ``[materials.NAME]``."""

from collections.abc import Iterator, Sequence

from floorplans.errors import PlanError
from floorplans.materials import MaterialLayer, PlanMaterial
from floorplans.toml.table import Table, as_table
from floorplans.toml.values import toml_number, toml_text

SIMPLE_KEYS = ("relative_permittivity", "conductivity")
LAW_KEYS = ("a", "b", "c", "d")
LOSS_KEYS = ("loss_db", "loss_frequency_hz")
MATERIAL_KEYS = (*SIMPLE_KEYS, *LOSS_KEYS, *LAW_KEYS, "layers", "colour")
LAYER_KEYS = ("material", "thickness_m")


def read_materials(plan: Table) -> tuple[PlanMaterial, ...]:
    """Read the own materials of a plan's top-level table, in the order of the file."""
    tables = as_table(plan.data.get("materials", {}), None, ("materials",))
    return tuple(_read(tables.table(name, MATERIAL_KEYS), name) for name in tables.known)


def _read(table: Table, name: str) -> PlanMaterial:
    colour = table.optional_text("colour")
    simple, law, loss = (
        any(key in table.data for key in keys) for keys in (SIMPLE_KEYS, LAW_KEYS, LOSS_KEYS)
    )
    if [simple, law, "layers" in table.data].count(True) != 1 or (loss and not simple):
        raise PlanError(
            "expected one of: relative_permittivity and conductivity [S/m] or loss_db; a, b, c, d; "
            "or layers",
            table.place,
        )
    if simple:
        a, c = table.number("relative_permittivity"), table.number("conductivity", 0.0)
        if loss and "conductivity" in table.data:
            raise PlanError(
                "loss_db takes its place; leave one out", (*table.place, "conductivity")
            )
        measured = (table.number(key) if loss else None for key in LOSS_KEYS)
        return PlanMaterial(name, a, 0.0, c, 0.0, (), colour, *measured)
    if law:
        a, b = table.number("a"), table.number("b", 0.0)
        c, d = table.number("c", 0.0), table.number("d", 0.0)
        return PlanMaterial(name, a, b, c, d, colour=colour)
    rows = table.tables("layers", LAYER_KEYS)
    if not rows:
        raise PlanError("expected at least one layer", (*table.place, "layers"))
    layers = tuple(MaterialLayer(row.text("material"), row.number("thickness_m")) for row in rows)
    return PlanMaterial(name, layers=layers, colour=colour)


def write_materials(materials: Sequence[PlanMaterial]) -> Iterator[str]:
    """Yield a block of TOML for each material."""
    for material in materials:
        yield "\n".join([f"[materials.{material.name}]", *_lines(material)])


def _lines(material: PlanMaterial) -> Iterator[str]:
    if material.layers:
        yield "layers = ["
        for name, thickness_m in material.layers:
            thickness = toml_number(thickness_m)
            yield f"  {{ material = {toml_text(name)}, thickness_m = {thickness} }},"
        yield "]"
    elif material.b or material.d:
        yield from (f"{key} = {toml_number(getattr(material, key))}" for key in LAW_KEYS)
    elif material.loss_db is not None and material.loss_frequency_hz is not None:
        yield f"relative_permittivity = {toml_number(material.a)}"
        yield f"loss_db = {toml_number(material.loss_db)}"
        yield f"loss_frequency_hz = {toml_number(material.loss_frequency_hz)}"
    else:
        yield f"relative_permittivity = {toml_number(material.a)}"
        yield f"conductivity = {toml_number(material.c)}"
    if material.colour is not None:
        yield f"colour = {toml_text(material.colour)}"
