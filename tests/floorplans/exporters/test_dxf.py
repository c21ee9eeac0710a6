"""DXF drawings of plans: what they hold, and that they import as the same walls."""

from dataclasses import replace

import ezdxf
import numpy as np
import pytest
from small_plans import ROOM, box

import floorplans
from floorplans import FloorPlan, Opening, Wall
from floorplans.exporters import export
from floorplans.frame import PlanFrame
from floorplans.importers import ImportOptions, import_plan
from floorplans.transmitters import PlanTransmitter


def reimported(plan: FloorPlan, tmp_path) -> FloorPlan:
    (path,) = export(plan, tmp_path / "plan.dxf")
    return import_plan(path, ImportOptions(height_m=plan.height_m)).plan


def ends(wall, corner):
    return sorted([tuple(np.subtract(wall.start, corner)), tuple(np.subtract(wall.end, corner))])


def middles(wall, plan):
    """Middles and widths of a wall's openings, from the plan's corner, to the millimetre."""
    places = [
        (*np.subtract(wall.point_at(o.offset_m + o.width_m / 2), plan.bounds[:2]), o.width_m)
        for o in wall.openings
    ]
    return sorted(tuple(np.round(place, 3) + 0.0) for place in places)


def matched(plan: FloorPlan, again: FloorPlan):
    """Yield each wall of a plan with the nearest wall of another, and how far their ends are."""
    here, there = plan.bounds[:2], again.bounds[:2]
    for wall in plan.walls:
        off = [np.abs(np.subtract(ends(wall, here), ends(w, there))).max() for w in again.walls]
        nearest = int(np.argmin(off))
        yield wall, again.walls[nearest], off[nearest]


@pytest.mark.parametrize("name", floorplans.builtin_names())
def test_walls_come_back_to_a_millimetre(name: str, tmp_path) -> None:
    plan = floorplans.load(name)
    again = reimported(plan, tmp_path)
    assert len(again.walls) == len(plan.walls)
    for wall, back, off_m in matched(plan, again):
        assert off_m < 1e-3
        assert back.thickness_m == pytest.approx(wall.thickness_m, abs=1e-3)
        if wall.material in ("brick", "concrete", "plasterboard", "glass", "wood", "metal"):
            assert back.material == wall.material
        assert middles(back, again) == middles(wall, plan)


@pytest.mark.parametrize("offset_m", [0.0, 1.0, 3.0, 4.0 - 0.8])
@pytest.mark.parametrize("width_m", [0.8, 1.0])
@pytest.mark.parametrize("side", [1, -1])
def test_a_door_against_a_wall_across_comes_back(tmp_path, offset_m, width_m, side) -> None:
    """Its leaf would swing into that wall, where it cannot be told from the opening."""
    ends = [(3.0, 0.0), (3.0, 4.0)][::side]
    door = Opening(min(offset_m, 4.0 - width_m), width_m, 0.0, 2.1, "door")
    partition = Wall(*ends, "brick", 0.1, 3.0, (door,))
    plan = box((partition,))
    again = reimported(plan, tmp_path)
    for wall, back, off_m in matched(plan, again):
        assert off_m < 1e-3
        assert middles(back, again) == middles(wall, plan)


def test_layers_and_blocks_name_what_they_are(tmp_path) -> None:
    (path,) = export(floorplans.load("flat"), tmp_path / "plan.dxf")
    document = ezdxf.readfile(path)
    space = document.modelspace()
    assert document.units == ezdxf.units.M
    layers = {entity.dxf.layer for entity in space}
    assert layers == {
        "WALL-BRICK", "WALL-PLASTERBOARD", "WALL-CHIPBOARD", "AXIS", "DOOR", "DOOR-PASSAGE",
        "WINDOW", "SOURCE", "START",
    }  # fmt: skip
    inserts = [insert.dxf.name for insert in space.query("INSERT")]
    kinds = [o.kind for w in floorplans.load("flat").walls for o in w.openings]
    assert inserts.count("WINDOW") == kinds.count("window")
    assert inserts.count("DOOR") == kinds.count("door")
    bodies = space.query('LWPOLYLINE[layer=="WALL-CHIPBOARD"]')
    assert [body.dxf.thickness for body in bodies] == [1.0]
    assert document.audit().errors == []


def test_names_from_everywhere_are_written(tmp_path) -> None:
    plan = replace(floorplans.load("flat"), name="Büro 東京")
    assert reimported(plan, tmp_path).outline.area == pytest.approx(plan.outline.area, rel=1e-3)


def test_window_over_whole_chords_of_a_curved_wall_comes_back(tmp_path) -> None:
    arc = 'points = [[6, 4], [0, 4]]\narc = [3, 5]\nmaterial = "brick"\nthickness_m = 0.2\n'
    glass = 'openings = [{ kind = "window", offset_m = 1.2, width_m = 4, sill_m = 0.9, head_m = 2, '
    straight, rest = "[6, 4], [0, 4], [0, 0]]", "[0, 4], [0, 0], [6, 0], [6, 4]]"
    text = ROOM.replace(f"points = [[0, 0], [6, 0], {straight}", f"points = [{rest}")
    text = text.partition("[[walls]]\npoints = [[3, 0]")[0]
    plan = floorplans.loads(f'{text}[[walls]]\n{arc}{glass}material = "glass" }}]\n')
    (path,) = export(plan, tmp_path / "bow.dxf")
    again = import_plan(path).plan
    assert again.outline.symmetric_difference(plan.outline).area < 0.02
    widths = [sum(o.width_m for w in p.walls for o in w.openings) for p in (plan, again)]
    assert widths[0] == pytest.approx(4.0)
    assert widths[1] == pytest.approx(4.0, abs=0.1)


def test_no_layer_of_a_drawing_is_unknown_when_it_is_imported(tmp_path) -> None:
    export(floorplans.load("flat"), tmp_path / "flat.dxf")
    layers = import_plan(tmp_path / "flat.dxf").layers
    assert {"SOURCE", "START", "AXIS"} <= {layer.name for layer in layers}
    assert not [layer.name for layer in layers if layer.is_unknown]


@pytest.mark.parametrize(
    "frame", [None, PlanFrame(512.25, -80.5, 0.0), PlanFrame(-3.5, 40.25, 11.0)]
)
def test_source_start_and_transmitters_come_back_to_their_places(frame, tmp_path) -> None:
    radios = tuple(PlanTransmitter(f"tx{k}", (3.0 * k, 1.6, 2.25)) for k in (1, 2))
    plan = replace(floorplans.load("flat"), transmitters=radios, frame=frame)
    (path,) = export(plan, tmp_path / "plan.dxf")
    result = import_plan(path, ImportOptions(height_m=plan.height_m))
    again = result.plan
    assert again.source == pytest.approx(plan.source, abs=1e-3)
    assert again.start == pytest.approx(plan.start, abs=1e-3)
    assert [t.id for t in again.transmitters] == ["tx1", "tx2"]
    for radio, back in zip(radios, again.transmitters, strict=True):
        assert back.position == pytest.approx(radio.position, abs=1e-3)
    assert not {"source", "start"} & {a.key for a in result.assumed}
    assert FloorPlan.of(floorplans.loads(result.toml())) == again


def test_a_source_on_the_ground_and_points_in_drawings_of_others_are_no_source(tmp_path) -> None:
    (path,) = export(floorplans.load("flat"), tmp_path / "plan.dxf")
    document = ezdxf.readfile(path)
    (point,) = document.modelspace().query('POINT[layer=="SOURCE"]')
    point.dxf.location = (-5.0, 2.0, 1.5)
    document.saveas(tmp_path / "outside.dxf")
    outside = import_plan(tmp_path / "outside.dxf")
    assert "source" in {a.key for a in outside.assumed}
    assert any("the source of the drawing" in note for note in outside.notes)
    document.layers.remove("TRANSMITTER")
    point.dxf.location = (2.2, 2.2, 1.5)
    document.saveas(tmp_path / "others.dxf")
    others = import_plan(tmp_path / "others.dxf")
    assert {"source", "start"} <= {a.key for a in others.assumed}
