"""IFC storeys come in with their walls, layers, openings, slabs and units, or with a clear no."""

from __future__ import annotations

import random
import re
from contextlib import suppress
from itertools import pairwise
from math import asin, hypot, pi
from zipfile import ZIP_DEFLATED, ZipFile

import pytest
from ifc_models import HOUSE, Model, Point, house
from ifcopenshell.api.owner import settings
from shapely.geometry import Polygon

from floorplans import PlanError, loads
from floorplans.importers import ImportOptions, import_plan
from floorplans.importers.ifc import file as ifc_file

HALL: list[Point] = [(0.0, 0.0), (6.0, 0.0), (6.0, 4.0), (0.0, 4.0)]


def openings_of(plan):
    """All openings as (kind, width, sill, head), sorted."""
    found = [o for wall in plan.walls for o in wall.openings]
    return sorted((o.kind, round(o.width_m, 6), o.sill_m, round(o.head_m, 6)) for o in found)


def message_of(path, **options) -> str:
    with pytest.raises(PlanError) as caught:
        import_plan(path, ImportOptions(**options))
    return str(caught.value)


@pytest.fixture(scope="module")
def house_file(tmp_path_factory):
    """The house in a file; not to be changed."""
    return house().write(tmp_path_factory.mktemp("ifc") / "house.ifc")


def two_storeys(tmp_path, upper: str = "First floor"):
    model = Model()
    model.add_storey("Ground floor")
    model.add_ring(HALL, thickness_m=0.3)
    model.add_storey(upper, 3.2)
    model.add_ring(HOUSE, thickness_m=0.2)
    return model.write(tmp_path / "two.ifc")


def test_house_has_its_walls_layers_and_openings(house_file) -> None:
    plan = import_plan(house_file).plan
    assert plan.bounds == pytest.approx((0.0, 0.0, 8.0, 5.0))
    assert plan.height_m == pytest.approx(2.7)
    assert sorted({(w.material, round(w.thickness_m, 6)) for w in plan.walls}) == [
        ("plasterboard", 0.1),
        ("plasterboard_brick_concrete_300", 0.3),
    ]
    assert openings_of(plan) == [
        ("door", 0.9, 0.0, 2.05),
        ("door", 1.0, 0.0, 2.1),
        ("window", 1.5, 0.9, 2.2),
    ]
    assert (plan.floor_material, plan.ceiling_material) == ("concrete", "concrete")


def test_openings_lie_where_they_were_cut(house_file) -> None:
    plan = import_plan(house_file).plan
    centres = {
        (o.kind, *(round(c, 4) for c in wall.point_at(o.offset_m + o.width_m / 2)))
        for wall in plan.walls
        for o in wall.openings
    }
    assert centres == {("door", 5.0, 0.0), ("door", 3.0, 2.45), ("window", 6.25, 5.0)}


def test_unit_of_the_file_changes_nothing(house_file, tmp_path) -> None:
    in_metres = house(prefix=None).write(tmp_path / "house.ifc")
    assert import_plan(in_metres).plan == import_plan(house_file).plan


def test_older_schema_changes_nothing(house_file, tmp_path, monkeypatch) -> None:
    def user(file):
        return file.createIfcPersonAndOrganization(
            file.createIfcPerson(FamilyName="Doe"), file.createIfcOrganization(Name="Doe")
        )

    def application(file):
        return file.createIfcApplication(file.createIfcOrganization(Name="Doe"), "1", "test", "t")

    monkeypatch.setattr(settings, "get_user", user)
    monkeypatch.setattr(settings, "get_application", application)
    older = house(schema="IFC2X3").write(tmp_path / "house.ifc")
    assert "IFC2X3" in older.read_text()
    assert import_plan(older).plan == import_plan(house_file).plan


@pytest.mark.parametrize("schema", ["IFC4", "IFC4X3"])
def test_wall_of_faces_is_read_like_others(tmp_path, schema) -> None:
    model = Model(schema=schema)
    model.add_storey("Hall")
    model.add_ring(HALL)
    model.add_wall_of_faces((2.0, 0.0), (2.0, 2.5), 0.15, 2.7)
    plan = import_plan(model.write(tmp_path / "hall.ifc")).plan
    spur = next(wall for wall in plan.walls if wall.length_m < 3.0)
    assert sorted((spur.start, spur.end)) == [
        pytest.approx((2.0, 0.0)),
        pytest.approx((2.0, 2.5)),
    ]
    assert spur.thickness_m == pytest.approx(0.15)


def test_written_plan_reads_back_and_states_what_was_assumed(house_file) -> None:
    imported = import_plan(house_file)
    text = imported.toml()
    assert loads(text) == imported.plan
    assert "assumed: the file states no source" in text
    assert any('material "Cement render" = concrete' in line for line in imported.report)
    assert any(line == "layer IfcWall (5): walls" for line in imported.report)


def test_user_says_what_a_material_is(house_file) -> None:
    options = ImportOptions(layers={"gips*": "wall:wood"})
    materials = {wall.material for wall in import_plan(house_file, options).plan.walls}
    assert materials == {"plasterboard_brick_concrete_300", "wood"}


def partitioned(tmp_path, describe):
    """Import a hall whose partition `describe(model, wall)` gives a material."""
    model = Model()
    model.add_storey("Ground floor")
    model.add_ring(HALL, thickness_m=0.3)
    describe(model, model.add_wall((3.0, 0.0), (3.0, 4.0), 0.124))
    imported = import_plan(model.write(tmp_path / "hall.ifc"))
    (wall,) = (w for w in imported.plan.walls if w.start[0] == w.end[0] == 3.0)
    layers = {m.name: tuple(m.layers) for m in imported.plan.materials}
    return imported, wall, layers.get(wall.material)


STUDS = (("Plasterboard", 0.016), ("Metal - Stud Layer", 0.092), ("Plasterboard", 0.016))


def as_layers(model, wall) -> None:
    model.set_layers(wall, *STUDS)


def as_constituents(model, wall) -> None:
    model.set_constituents(wall, *STUDS)


@pytest.mark.parametrize("describe", [as_layers, as_constituents])
def test_studs_are_a_cavity_between_boards(tmp_path, describe) -> None:
    imported, wall, layers = partitioned(tmp_path, describe)
    assert layers == (("plasterboard", 0.016), ("air", 0.092), ("plasterboard", 0.016))
    assert wall.thickness_m == pytest.approx(0.124)
    assert wall.material == "plasterboard_air_plasterboard_124"
    assert loads(imported.toml()) == imported.plan
    (assumed,) = (a for a in imported.assumed if a.key == 'material "Metal - Stud Layer"')
    assert (assumed.value, assumed.why) == (
        "air",
        "a cavity: studs, insulation or air; 1 layer of walls",
    )


def test_brick_insulation_and_air_are_brick_and_one_cavity(tmp_path) -> None:
    def cavity_wall(model, wall) -> None:
        model.set_layers(wall, ("Masonry - Brick", 0.09), ("Mineralwolle WLG 035", 0.06),
                         ("Luftschicht", 0.04), ("Mauerwerk (innen)", 0.115))  # fmt: skip

    _, wall, layers = partitioned(tmp_path, cavity_wall)
    assert layers == (("brick", 0.09), ("air", 0.1), ("brick", 0.115))
    assert wall.thickness_m == pytest.approx(0.305)


def test_one_material_in_several_layers_is_one_wall(tmp_path) -> None:
    _, wall, layers = partitioned(
        tmp_path, lambda model, wall: model.set_layers(wall, ("Beton", 0.1), ("Concrete", 0.02))
    )
    assert (wall.material, layers, wall.thickness_m) == ("concrete", None, pytest.approx(0.12))


def test_reversed_layers_are_one_material(tmp_path) -> None:
    model = Model()
    model.add_storey("Ground floor")
    for k, wall in enumerate(model.add_ring(HALL, thickness_m=0.3)):
        layers = (("Brick", 0.2), ("Rigid insulation", 0.08), ("Gypsum board", 0.02))
        model.set_layers(wall, *layers[:: (1, -1)[k % 2]])
    plan = import_plan(model.write(tmp_path / "hall.ifc")).plan
    assert {wall.material for wall in plan.walls} == {"brick_air_plasterboard_300"}


def test_unknown_layers_are_assumed_and_reported_by_name(tmp_path) -> None:
    imported, _, layers = partitioned(
        tmp_path,
        lambda model, wall: model.set_layers(
            wall, ("Frobnicate", 0.05), ("Air", 0.05), ("Membrane X", 0.001), ("Brick", 0.1)
        ),
    )
    assert layers == (("plasterboard", 0.05), ("air", 0.051), ("brick", 0.1))
    whys = {a.key: a.why for a in imported.assumed}
    assert "an unknown name" in whys['material "Frobnicate"']
    assert "a thin film" in whys['material "Membrane X"']


def test_walls_of_unknown_layers_keep_their_cavities(tmp_path) -> None:
    rows = (("Foo", 0.013), ("Air", 0.05), ("Bar", 0.24), ("Film", 0.001), ("Foo", 0.013))
    imported, _, layers = partitioned(tmp_path, lambda model, wall: model.set_layers(wall, *rows))
    solid = ("plasterboard", 0.013)
    assert layers == (solid, ("air", 0.05), ("brick", 0.24), ("air", 0.001), solid)
    assumed = {a.key: a.value for a in imported.assumed}
    assert assumed['material "Foo"'] == "plasterboard"
    assert assumed['material "Bar"'] == "brick"


@pytest.mark.parametrize("rows", [[("Foo", 0.1), ("Bar", 0.024)], [("Air", 0.1), ("Film", 0.001)]])
def test_walls_without_a_known_layer_or_a_solid_one_get_the_default(tmp_path, rows) -> None:
    _, wall, layers = partitioned(tmp_path, lambda model, wall: model.set_layers(wall, *rows))
    assert (wall.material, layers) == ("plasterboard", None)


def test_a_name_of_the_users_that_fits_no_material_is_reported(house_file) -> None:
    notes = import_plan(house_file, ImportOptions(layers={"gipskartan": "wall:wood"})).notes
    assert 'nothing in the file is called "gipskartan"; did you mean "Gipskarton"?' in notes


def test_storeys_are_named_by_their_name(tmp_path) -> None:
    model = Model()
    for name, z in (("OG1", 3.2), ("EG", 0.0)):
        model.add_storey(name, z)
        model.storey.LongName = "Storey of " + name
        model.add_ring(HALL, thickness_m=0.3)
    file = model.write(tmp_path / "two.ifc")
    assert "0: 'EG' at 0.00 m with 4 walls; 1: 'OG1'" in message_of(file)
    assert import_plan(file, ImportOptions(level="eg")).plan.name == "two EG"
    assert import_plan(file, ImportOptions(level="Storey of EG")).plan.name == "two EG"


@pytest.mark.parametrize("level", ["Ground floor", "ground FLOOR", "0", "0.0"])
def test_lower_storey_is_chosen(tmp_path, level) -> None:
    plan = import_plan(two_storeys(tmp_path), ImportOptions(level=level)).plan
    assert plan.bounds == pytest.approx((0.0, 0.0, 6.0, 4.0))


@pytest.mark.parametrize("level", ["First floor", "1", "3.2"])
def test_upper_storey_is_chosen(tmp_path, level) -> None:
    plan = import_plan(two_storeys(tmp_path), ImportOptions(level=level)).plan
    assert plan.bounds == pytest.approx((0.0, 0.0, 8.0, 5.0))
    assert plan.height_m == pytest.approx(2.7)


def test_storeys_are_listed_where_one_must_be_chosen(tmp_path) -> None:
    path = two_storeys(tmp_path)
    assert "choose a storey; there are 0: 'Ground floor' at 0.00 m" in message_of(path)
    assert "1: 'First floor' at 3.20 m with 4 walls" in message_of(path, level="attic")
    same = two_storeys(tmp_path, "Ground floor")
    assert "2 storeys of that name" in message_of(same, level="Ground floor")


def test_curved_wall_comes_as_chords(tmp_path) -> None:
    model = Model()
    model.add_storey("Apse")
    model.add_wall((-3.0, 0.0), (-3.0, -4.0))
    model.add_wall((-3.0, -4.0), (3.0, -4.0))
    model.add_wall((3.0, -4.0), (3.0, 0.0))
    model.add_curved_wall((0.0, 0.0), 3.0, 0.2, 2.7)
    plan = import_plan(model.write(tmp_path / "apse.ifc"), ImportOptions(tolerance_m=0.01)).plan
    assert len(plan.walls) > 10
    assert plan.outline.area == pytest.approx(24.0 + pi * 9.0 / 2, rel=0.01)
    assert {round(wall.thickness_m, 2) for wall in plan.walls} == {0.2}


def test_wall_at_any_angle(tmp_path) -> None:
    model = Model()
    model.add_storey("Hut")
    corners = [(1.0, 0.0), (6.0, 2.0), (4.5, 6.5), (-1.0, 4.0)]
    model.add_ring(corners, thickness_m=0.25)
    plan = import_plan(model.write(tmp_path / "hut.ifc")).plan
    lengths = [hypot(c[0] - a[0], c[1] - a[1]) for a, c in pairwise(corners)]
    assert sorted(round(w.length_m, 3) for w in plan.walls)[1:] == pytest.approx(
        sorted([*lengths, hypot(2.0, 4.0)])[1:], abs=1e-3
    )


def test_low_wall_keeps_its_height_and_hole_without_filling_is_a_passage(tmp_path) -> None:
    model = Model()
    model.add_storey("Hall")
    model.add_ring(HALL)
    model.add_wall((2.0, 0.0), (2.0, 2.5), height_m=1.1)
    inner = model.add_wall((4.0, 0.0), (4.0, 4.0))
    model.add_hole(inner, 1.0, 1.2, 0.0, 2.3)
    plan = import_plan(model.write(tmp_path / "hall.ifc")).plan
    assert sorted({round(wall.height_m, 6) for wall in plan.walls}) == [1.1, 2.7]
    assert openings_of(plan) == [("passage", 1.2, 0.0, 2.3)]


def test_window_in_a_curved_wall_covers_several_chords(tmp_path) -> None:
    model = Model()
    model.add_storey("Ground floor")
    model.add_wall((-4.0, 0.0), (4.0, 0.0), 0.2)
    bow = model.add_curved_wall((0.0, 0.0), 4.0, 0.2, 2.7)
    model.add_hole_across(bow, (0.0, 4.0), 5.0, 0.9, 2.1)
    plan = import_plan(model.write(tmp_path / "bow.ifc")).plan
    panes = [(wall, o) for wall in plan.walls for o in wall.openings]
    assert {o.kind for _, o in panes} == {"window"}
    assert len(panes) > 3
    ends = [p for wall, o in panes for p in (wall.point_at(o.offset_m), wall.point_at(o.end_m))]
    across = sorted(x - min(x for x, _ in (w.start for w in plan.walls)) - 4.0 for x, _ in ends)
    assert (across[0], across[-1]) == pytest.approx((-2.5, 2.5), abs=0.02)
    arc_m = 2 * 4.0 * asin(2.5 / 4.0)
    assert sum(o.width_m for _, o in panes) == pytest.approx(arc_m, abs=0.05)


def test_columns_are_solid_rings_unless_they_are_part_of_a_wall(tmp_path) -> None:
    model = Model()
    model.add_storey("Hall")
    model.add_ring(HALL, thickness_m=0.3)
    standing = model.add_column((2.0, 2.0), 0.4)
    model.set_material(standing, "Stahlbeton C30/37")
    model.add_column((4.0, 2.0), 0.08)
    model.add_column((6.0, 2.0), 0.4)
    imported = import_plan(model.write(tmp_path / "hall.ifc"))
    ring = [w for w in imported.plan.walls if w.length_m == pytest.approx(0.4)]
    assert {(w.material, w.thickness_m) for w in ring} == {("concrete", 0.2)}
    centre_x, centre_y = (sum(w.start[k] for w in ring) / 4 for k in (0, 1))
    assert (centre_x, centre_y) == pytest.approx((2.0, 2.0))
    assert len(ring) == 4
    (use,) = (use for use in imported.layers if use.name == "IfcColumn")
    assert use.became == (
        "columns; 1 thin, or without a readable shape on this floor, left out; "
        "1 part of walls, left out"
    )
    assert len(imported.plan.walls) == 8


def test_round_column_is_as_wide_as_it_is(tmp_path) -> None:
    model = Model("MILLI")
    model.add_storey("Hall")
    model.add_ring(HALL)
    model.add_column((3.0, 2.0), 0.6, is_round=True)
    plan = import_plan(model.write(tmp_path / "hall.ifc")).plan
    ring = [w for w in plan.walls if w.length_m < 0.5]
    area = Polygon([w.start for w in ring]).convex_hull.area
    assert area == pytest.approx(pi * 0.3**2, rel=0.1)


def test_mullions_of_a_curtain_wall_are_part_of_it(tmp_path) -> None:
    model = Model()
    model.add_storey("Ground floor")
    for start, end in pairwise([(9.0, 0.0), (9.0, 6.0), (0.0, 6.0), (0.0, 0.0)]):
        model.add_wall(start, end, 0.3)
    model.add_curtain_wall(9.0, 1.5)
    imported = import_plan(model.write(tmp_path / "front.ifc"))
    glass = [wall for wall in imported.plan.walls if wall.material == "glass"]
    assert sum(wall.length_m for wall in glass) == pytest.approx(9.0, abs=0.05)
    assert {wall.start[1] for wall in glass} | {wall.end[1] for wall in glass} == {0.0}
    assert not [change for change in imported.changes if change.kind == "dropped"]
    became = {use.name: use.became for use in imported.layers}
    assert became["IfcPlate"] == became["IfcMember"] == "parts of curtain walls"


@pytest.mark.parametrize("rises_m", [1.0, 2.9])
def test_walls_of_a_lower_storey_that_rise_through_this_one_are_part_of_it(
    tmp_path, rises_m: float
) -> None:
    model = Model()
    model.add_storey("Ground floor")
    ring = model.add_ring(HOUSE, thickness_m=0.3, height_m=3.0 + rises_m)
    model.add_filling(model.add_hole(ring[0], 2.0, 1.0, 0.0, 2.1), "IfcDoor")
    model.add_filling(model.add_hole(ring[0], 5.0, 1.2, 3.9, 5.1), "IfcWindow")
    model.add_storey("First floor", 3.0)
    inner: list[Point] = [(1.0, 1.0), (5.0, 1.0), (5.0, 4.0), (1.0, 4.0)]
    model.add_ring(inner, thickness_m=0.1, height_m=2.9)
    imported = import_plan(model.write(tmp_path / "high.ifc"), ImportOptions(level="First floor"))
    if rises_m < 1.8:  # a parapet
        assert imported.plan.outline.area == pytest.approx(12.0)
        assert imported.notes == ()
        return
    assert imported.plan.outline.area == pytest.approx(40.0)
    assert openings_of(imported.plan) == [("window", 1.2, pytest.approx(0.9), 2.1)]
    assert imported.notes[0].startswith("4 walls and columns of lower storeys rise through")


def test_curtain_wall_without_material_is_glass(tmp_path) -> None:
    model = Model()
    model.add_storey("Hall")
    model.add_ring(HALL)
    model.add_wall((3.0, 0.0), (3.0, 4.0), 0.05, ifc_class="IfcCurtainWall")
    plan = import_plan(model.write(tmp_path / "hall.ifc")).plan
    assert [(w.material, w.thickness_m) for w in plan.walls if w.material == "glass"] == [
        ("glass", 0.02)
    ]


def test_rooms_with_different_ceilings_are_rejected_with_the_reason(tmp_path) -> None:
    model = house()
    for top, (low, high) in ((2.42, (0.0, 3.0)), (2.82, (3.0, 8.0))):
        corners = [(low, 0.0), (high, 0.0), (high, 5.0), (low, 5.0)]
        model.add_slab(corners, top, 0.02, ifc_class="IfcCovering", predefined_type="CEILING")
    path = model.write(tmp_path / "house.ifc")
    message = message_of(path)
    assert "rooms have ceilings at 2.40 m to 2.80 m, and a plan has one flat ceiling" in message
    assert import_plan(path, ImportOptions(height_m=2.6)).plan.height_m == 2.6


def test_model_without_unit_needs_one(tmp_path) -> None:
    model = house()
    model.units.Units = ()
    for wanted in ("does not state its unit of length", "give it: mm"):
        assert wanted in message_of(model.write(tmp_path / "house.ifc"))
    plan = import_plan(tmp_path / "house.ifc", ImportOptions(unit="mm")).plan
    assert plan.bounds == pytest.approx((0.0, 0.0, 8.0, 5.0))


def test_model_in_a_wrong_unit_is_no_building(house_file) -> None:
    assert "more than any building" in message_of(house_file, unit="m")


def test_model_without_storeys(tmp_path) -> None:
    model = Model()
    model.add_ring(HALL)
    assert "no IfcBuildingStorey" in message_of(model.write(tmp_path / "loose.ifc"))


def test_storey_without_walls(tmp_path) -> None:
    model = Model()
    model.add_storey("Roof")
    assert "no storey of the model has walls" in message_of(model.write(tmp_path / "roof.ifc"))


def test_files_that_are_no_model(tmp_path, house_file) -> None:
    path = tmp_path / "plan.ifc"
    path.write_bytes(b"PK\x03\x04 zipped")
    assert "does not begin like an IFC model" in message_of(path)
    path.write_text("ISO-10303-21;\nHEADER;\nENDSEC;\nEND-ISO-10303-21;\n")
    assert "not a readable IFC model" in message_of(path)
    text = house_file.read_text()
    path.write_text(text[: len(text) // 2])
    assert "the file is cut off" in message_of(path)
    path.write_text(text.replace("IFC4", "IFC9"))
    assert "Unsupported schema: IFC9; save the model as" in message_of(path)


def test_mutated_models_never_crash(tmp_path, house_file) -> None:
    text = house_file.read_bytes()
    body, end = text[:-30], text[-30:]
    path = tmp_path / "mutated.ifc"
    for seed in range(60):
        rng = random.Random(seed)
        changed = bytearray(body)
        for _ in range(rng.choice((1, 2, 5))):
            at = rng.randrange(300, len(changed) - 20)
            if rng.random() < 0.6:  # another reference or number
                changed[at : at + 1] = rng.choice((b"1", b"9", b"0", b"#", b"$", b"-", b"E"))
            else:
                del changed[at : at + rng.randrange(1, 9)]
        path.write_bytes(bytes(changed) + end)
        with suppress(PlanError):
            import_plan(path)


@pytest.mark.parametrize(
    "schema",
    [
        "FILE_SCHEMA((1e308));", "FILE_SCHEMA();", "FILE_SCHEMA('IFC4');", "FILE_SCHEMA((#1));", "",
        "FILE_SCHEMA((('IFC4')));", "FILE_SCHEMA((1));FILE_SCHEMA(('IFC4'));", "FILE_SCHEMA(/*",
        "/*FILE_SCHEMA(('IFC4'))*/FILE_SCHEMA(($));", "FILE_SCHEMA" + "/**/" * 9999, "/*" * 99999,
        "FILE_NAME('FILE_SCHEMA((''IFC4''))');FILE_SCHEMA((.T.));", "FILE_SCHEMA(('IFC4')0);",
        "FILE_SCHEMA(('IFC4',0));", "FILE_SCHEMA(('IFC4'",
    ],
)  # fmt: skip
def test_a_header_without_the_name_of_a_schema_is_refused(house_file, tmp_path, schema) -> None:
    text, path = house_file.read_text(), tmp_path / "house.ifc"
    path.write_text(re.sub(r"FILE_SCHEMA.*", lambda _: schema, text))
    assert "expected FILE_SCHEMA with a name" in message_of(path)


def test_comments_around_the_name_of_a_schema_are_read(house_file, tmp_path) -> None:
    text, path = house_file.read_text(), tmp_path / "house.ifc"
    path.write_text(text.replace("FILE_SCHEMA((", "FILE_SCHEMA /* ' */ (/**/("))
    assert import_plan(path).plan == import_plan(house_file).plan


def zipped(folder, *files):
    path = folder / "house.ifczip"
    with ZipFile(path, "w", ZIP_DEFLATED) as archive:
        for name, content in files:
            archive.writestr(name, content)
    return path


def test_zipped_model_is_read_as_it_is(house_file, tmp_path) -> None:
    path = zipped(tmp_path, ("house.ifc", house_file.read_bytes()), ("notes.txt", b"hello"))
    assert import_plan(path).plan == import_plan(house_file).plan


def test_zipped_models_that_cannot_be_read(house_file, tmp_path, monkeypatch) -> None:
    data = house_file.read_bytes()
    assert "holds 0 files *.ifc" in message_of(zipped(tmp_path, ("a.txt", b"")))
    assert "holds 2 files *.ifc" in message_of(zipped(tmp_path, ("a.ifc", data), ("b.ifc", data)))
    assert "cut off" in message_of(zipped(tmp_path, ("a.ifc", data[:-30])))
    whole = zipped(tmp_path, ("a.ifc", data))
    cut = bytearray(whole.read_bytes())
    cut[80:400] = bytes(320)
    (tmp_path / "cut.ifczip").write_bytes(cut)
    assert "cannot be unpacked" in message_of(tmp_path / "cut.ifczip")
    monkeypatch.setattr(ifc_file, "MAX_BYTES", len(data) - 1)
    assert "more than the" in message_of(whole)


def test_old_schemas_say_what_to_do(house_file, tmp_path) -> None:
    old = tmp_path / "old.ifc"
    old.write_text(house_file.read_text().replace("('IFC4')", "('IFC2X_FINAL')"))
    message = message_of(old)
    assert "IFC2X_FINAL; save the model as IFC2x3 or IFC4" in message


def test_a_storey_that_is_a_part_of_its_own_part_comes_in(tmp_path) -> None:
    """Relations that run in a circle end: the walls are those of the storey, each once."""
    model = house()
    whole = import_plan(model.write(tmp_path / "house.ifc")).plan
    relation = model.file.create_entity(
        "IfcRelAggregates",
        GlobalId="0" * 22,
        RelatingObject=model.file.by_type("IfcWall")[0],
        RelatedObjects=[model.storey],
    )
    assert relation.RelatedObjects == (model.storey,)
    circle = import_plan(model.write(tmp_path / "circle.ifc")).plan
    assert len(circle.walls) == len(whole.walls)
