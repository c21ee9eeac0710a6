"""A plan's own materials: read, written back, refused with the place and the remedy."""

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

import floorplans
from floorplans import FloorPlan, MaterialLayer, PlanError, PlanMaterial

FLAT = floorplans.load("flat")
TEXT = floorplans.dumps(FLAT)
BOARD = '[materials.board]\nrelative_permittivity = 2.1\nconductivity = 0.01\ncolour = "#aa8800"\n'
LAYERS = ", ".join(
    f'{{ material = "{name}", thickness_m = {d} }}'
    for name, d in (("board", 0.0125), ("air", 0.075), ("board", 0.0125))
)
STUDS = f"[materials.studs]\nlayers = [{LAYERS}]\n"


def with_materials(*tables: str, text: str = TEXT) -> str:
    head, walls = text.split("\n[[walls]]", 1)
    return "\n".join([head, *tables, "\n[[walls]]" + walls])


def rewalled(**changes: object) -> FloorPlan:
    inner = replace(FLAT.walls[-1], openings=(), **changes)
    return replace(FLAT, walls=(*FLAT.walls[:-1], inner), materials=OWN)


OWN = floorplans.loads(with_materials(BOARD, STUDS)).materials


def test_own_materials_are_read() -> None:
    board, studs = OWN
    assert board == PlanMaterial("board", 2.1, c=0.01, colour="#aa8800")
    assert studs.layers[1] == MaterialLayer("air", 0.075)
    assert studs.thickness_m == pytest.approx(0.1)


def test_law_is_read() -> None:
    law = "[materials.tile]\na = 3\nb = -0.1\nc = 0.005\nd = 0.8\n"
    assert floorplans.loads(with_materials(law)).materials == (
        PlanMaterial("tile", 3.0, -0.1, 0.005, 0.8),
    )


def test_sheets_of_layers_are_as_thick_as_the_layers() -> None:
    text = with_materials(BOARD, STUDS).replace(
        'floor_material = "concrete"\nfloor_thickness_m = 0.2', 'floor_material = "studs"'
    )
    assert floorplans.loads(text).floor_thickness_m == pytest.approx(0.1)


def test_own_colours_are_those_of_the_mesh() -> None:
    plan = rewalled(material="board", thickness_m=0.02)
    walls = plan.to_mesh()
    number = [m.name for m in walls.materials].index("board")
    face = int((walls.face_material == number).argmax())
    assert tuple(walls.mesh.visual.face_colors[face][:3]) == (0xAA, 0x88, 0x00)
    assert plan.colour_of("studs") == floorplans.materials.OWN_COLOUR


laws = st.builds(
    PlanMaterial,
    name=st.sampled_from(["one", "two_2"]),
    a=st.floats(1.0, 90.0),
    b=st.floats(-1.0, 1.0),
    c=st.floats(0.0, 1e7),
    d=st.floats(-2.0, 4.0),
    colour=st.sampled_from([None, "#12ab9F"]),
)
layers = st.builds(MaterialLayer, st.sampled_from(["glass", "air", "vacuum"]), st.floats(1e-4, 0.5))
stacks = st.builds(
    PlanMaterial, name=st.just("stack"), layers=st.lists(layers, min_size=1).map(tuple)
)


@given(law=laws, stack=stacks, edition=st.sampled_from([None, *floorplans.MATERIAL_EDITIONS]))
def test_materials_come_back_from_toml(
    law: PlanMaterial, stack: PlanMaterial, edition: str | None
) -> None:
    plan = replace(FLAT, materials=(law, stack), material_edition=edition)
    assert floorplans.loads(floorplans.dumps(plan)) == plan


def test_plans_without_own_materials_keep_their_text_and_hash() -> None:
    assert "materials" not in TEXT
    assert floorplans.loads(TEXT).sha256 == FLAT.sha256


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ("[materials.board]\ncolour = '#112233'\n", "materials.board: expected one of"),
        ("[materials.board]\nlayers = []\n", "materials.board.layers: expected at least one"),
        ("[materials.glass]\na = 2\n", "materials.glass: expected a name of letters"),
        (
            "[materials.board]\na = 0.5\n",
            "materials.board.a = 0.5: expected a finite number from 1",
        ),
        ("[materials.board]\na = 2\nsigma = 1\n", "materials.board.sigma: unknown key"),
        ("[materials.board]\na = 2\ncolour = 'red'\n", 'colour = "red": expected #rrggbb'),
        (
            "[materials.x]\nlayers = [{ material = 'glas', thickness_m = 1 }]\n",
            'materials.x.layers[0].material = "glas": unknown material of a layer; did you mean',
        ),
        (
            "[materials.x]\nlayers = [{ material = 'glass', thickness_m = 0 }]\n",
            "materials.x.layers[0].thickness_m = 0.0: expected a finite number from 1e-09",
        ),
        ('material_edition = "P.2040-9"\n', 'material_edition = "P.2040-9": unknown edition'),
    ],
)
def test_wrong_materials_are_rejected(table: str, message: str) -> None:
    with pytest.raises(PlanError) as caught:
        floorplans.loads(with_materials(table), origin="plan.toml")
    assert f"plan.toml: {message}" in str(caught.value) or message in str(caught.value)


def test_a_thickness_that_is_not_that_of_the_layers_is_rejected() -> None:
    with pytest.raises(PlanError, match=r"thickness_m = 0.2: the layers of studs are 0.1 m thick"):
        rewalled(material="studs", thickness_m=0.2)


def test_sides_of_floors_and_walls_may_differ() -> None:
    tiled = PlanMaterial(
        "tiled", layers=(MaterialLayer("marble", 0.02), MaterialLayer("concrete", 0.18))
    )
    wall = replace(FLAT.walls[-1], material="tiled", thickness_m=0.2)
    plan = replace(
        FLAT,
        materials=(tiled,),
        floor_material="tiled",
        floor_thickness_m=0.2,
        walls=(*FLAT.walls[:-1], wall),
    )
    assert floorplans.loads(floorplans.dumps(plan)) == plan
