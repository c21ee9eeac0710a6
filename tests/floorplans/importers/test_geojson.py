"""GeoJSON and IMDF become plans: walls of areas, lines and rooms, openings, levels, places."""

import json
import random
from zipfile import ZIP_DEFLATED, ZipFile

import numpy as np
import pytest
import shapely
from shapely import affinity
from shapely.geometry import LineString, Point, box, mapping

from floorplans import FloorPlan, GeoOrigin, PlanError
from floorplans.importers import ImportOptions, import_plan
from floorplans.importers.geojson import files as geojson_files
from floorplans.importers.geojson.features import classify

ORIGIN = GeoOrigin(8.55, 47.37)

# A house of 10 m x 6 m over all: outer walls of 0.3 m, one of 0.2 m across it at x = 4 to 4.2,
# a door of 1 m in that, a window of 2 m in the south wall
OUTER = box(0, 0, 10, 6) - box(0.3, 0.3, 9.7, 5.7)
DOOR = box(4, 2, 4.2, 3)
WINDOW = box(6, 0.1, 8, 0.2)
WALLS = (OUTER | box(4, 0, 4.2, 6)) - DOOR - box(6, 0, 8, 0.3)


def feature(geometry, **properties):
    return {"type": "Feature", "properties": properties, "geometry": mapping(geometry)}


def collection(*features, **members):
    return {"type": "FeatureCollection", **members, "features": list(features)}


def house(place=lambda geometry: geometry):
    parts = [feature(place(part), type="wall") for part in shapely.get_parts(WALLS)]
    return collection(
        *parts,
        feature(place(DOOR), type="door"),
        feature(place(WINDOW), type="window"),
        feature(place(box(1, 1, 2, 2)), type="sofa"),
    )


def in_degrees(geometry):
    return shapely.transform(geometry, ORIGIN.to_degrees)


@pytest.fixture
def imported(tmp_path):
    def run(data, **options) -> FloorPlan:
        path = tmp_path / "house.geojson"
        path.write_text(data if isinstance(data, str) else json.dumps(data))
        return import_plan(path, ImportOptions(**options)).plan

    return run


def lines_of(walls):
    return sorted(
        tuple(sorted((tuple(np.round(w.start, 3) + 0.0), tuple(np.round(w.end, 3) + 0.0))))
        for w in walls
    )


def test_house_in_degrees_is_a_house_in_metres_at_its_place(imported) -> None:
    plan = imported(house(in_degrees))
    assert plan.origin.longitude_deg == pytest.approx(ORIGIN.longitude_deg, abs=1e-6)
    x_min, y_min, x_max, y_max = plan.bounds
    assert (x_max - x_min, y_max - y_min) == pytest.approx((9.7, 5.7), abs=2e-3)
    assert sorted({round(w.thickness_m, 2) for w in plan.walls}) == [0.2, 0.3]
    by_kind = {o.kind: (w, o) for w in plan.walls for o in w.openings}
    assert set(by_kind) == {"door", "window"}
    wall, door = by_kind["door"]
    assert door.width_m == pytest.approx(1.0, abs=2e-3)
    assert door.material is None
    assert wall.thickness_m == pytest.approx(0.2, abs=2e-3)
    middle = wall.point_at(door.offset_m + door.width_m / 2)
    lon_lat = plan.origin.to_degrees(np.array([middle]))
    assert ORIGIN.to_plan(lon_lat)[0] == pytest.approx([4.1, 2.5], abs=5e-3)
    assert by_kind["window"][1].width_m == pytest.approx(2.0, abs=2e-3)


def test_house_in_metres(imported) -> None:
    shift = lambda geometry: affinity.translate(geometry, 1000, 2000)  # noqa: E731
    plan = imported(house(shift))
    assert plan.origin is None
    assert plan.bounds == pytest.approx((0, 0, 9.7, 5.7), abs=1e-3)
    millimetres = lambda geometry: affinity.scale(geometry, 1000, 1000, origin=(0, 0))  # noqa: E731
    assert imported(house(millimetres), unit="mm").bounds == pytest.approx(
        (0, 0, 9.7, 5.7), abs=1e-3
    )


@pytest.mark.parametrize("crs", ["EPSG:3857", "urn:ogc:def:crs:EPSG::25832"])
def test_projected_coordinates_give_true_metres(imported, crs: str) -> None:
    from pyproj import Transformer

    project = Transformer.from_crs("OGC:CRS84", crs, always_xy=True)

    def place(geometry):
        degrees = in_degrees(geometry)
        return shapely.transform(degrees, lambda p: np.column_stack(project.transform(*p.T)))

    data = house(place) | {"crs": {"type": "name", "properties": {"name": crs}}}
    x_min, y_min, x_max, y_max = imported(data).bounds
    assert (x_max - x_min, y_max - y_min) == pytest.approx((9.7, 5.7), abs=0.01)


def test_walls_as_lines_keep_their_properties(imported) -> None:
    ring = LineString([(0, 0), (10, 0), (10, 6), (0, 6), (0, 0)])
    across = LineString([(4, 0), (4, 6)])
    plan = imported(
        collection(
            feature(ring, indoor="wall", material="brick", thickness="0.25 m"),
            feature(across, indoor="wall", height=2.0),
            feature(Point(4, 3), door="hinged", width="1.1"),
            crs=None,
        )
    )
    partition = next(w for w in plan.walls if w.openings)
    assert (partition.height_m, partition.openings[0].width_m) == (2.0, pytest.approx(1.1))
    outer = {(w.material, w.thickness_m) for w in plan.walls if w is not partition}
    assert outer == {("brick", 0.25)}


@pytest.mark.parametrize("kind", ["floor_opening", "roof-opening", "ShaftOpening", "void"])
def test_openings_in_floors_and_roofs_are_left_out_and_reported(tmp_path, kind: str) -> None:
    data = house()
    data["features"].append(feature(box(1, 0.05, 3, 0.25), type=kind))
    path = tmp_path / "house.geojson"
    path.write_text(json.dumps(data | {"crs": None}))
    result = import_plan(path)
    kinds = sorted(o.kind for wall in result.plan.walls for o in wall.openings)
    assert kinds == ["door", "window"]
    (use,) = (use for use in result.layers if use.name == kind)
    assert use.became == "left out (in a floor or roof, not in a wall)"
    assert not use.is_unknown


@pytest.mark.parametrize(
    ("category", "material"),
    [("concrete", "concrete"), ("drywall", "plasterboard"), ("glass", "glass"), ("column", None)],
)
def test_solid_units_of_imdf_are_walls_of_their_material(category: str, material: str) -> None:
    unit = {"feature_type": "unit", "properties": {"category": category}}
    what = classify(unit, ImportOptions())
    assert (what.kind, what.material) == ("wall", material)


def test_materials_are_known_in_other_words(imported) -> None:
    ring = LineString([(0, 0), (10, 0), (10, 6), (0, 6), (0, 0)])
    plan = imported(collection(feature(ring, type="Mauer", material="Ziegel"), crs=None))
    assert {wall.material for wall in plan.walls} == {"brick"}


ROOMS = [box(0, 0, 4, 6), box(4, 0, 10, 3), box(4, 3, 10, 6)]


@pytest.mark.parametrize("kind", ["Wohnzimmer", "Büro", "pièce", "dormitorio", "stanza", "kitchen"])
def test_rooms_are_known_in_other_languages(kind: str) -> None:
    assert classify(feature(OUTER, type=kind), ImportOptions()).kind == "room"


def test_rooms_that_touch_have_walls_around_and_between(imported) -> None:
    plan = imported(collection(*(feature(room, indoor="room") for room in ROOMS), crs=None))
    assert lines_of(plan.walls) == [
        ((0, 0), (0, 6)),
        ((0, 0), (10, 0)),
        ((0, 6), (10, 6)),
        ((4, 0), (4, 6)),
        ((4, 3), (10, 3)),
        ((10, 0), (10, 6)),
    ]


@pytest.mark.parametrize("order", [1, -1])
def test_rooms_within_a_hall_have_walls_whichever_comes_first(imported, order: int) -> None:
    rooms = [(box(0, 0, 20, 10), "walkway"), (box(0, 0, 4, 10), "restroom"),
             (box(12, 4, 14, 6), "elevator")]  # fmt: skip
    units = [feature(room, feature_type="unit", category=what) for room, what in rooms[::order]]
    plan = imported(collection(*units, crs=None))
    inner = [w for w in plan.walls if 0 < w.point_at(w.length_m / 2)[0] < 20]
    inner = [w for w in inner if 0 < w.point_at(w.length_m / 2)[1] < 10]
    assert sum(w.length_m for w in inner) == pytest.approx(10 + 8, abs=0.1)


def test_rooms_with_gaps_have_walls_as_thick_as_the_gaps(imported) -> None:
    rooms = [box(0, 0, 4, 6), box(4.2, 0, 10, 6)]
    plan = imported(collection(*(feature(room, indoor="room") for room in rooms), crs=None))
    assert plan.bounds == pytest.approx((0, 0, 10, 6), abs=1e-3)
    between = [w for w in plan.walls if 1 < w.start[0] < 9 and 1 < w.end[0] < 9]
    assert [round(w.thickness_m, 3) for w in between] == [0.2]
    assert between[0].start[0] == pytest.approx(4.1, abs=1e-3)


def imdf_files():
    def unit(shape, level, category="room"):
        return feature(in_degrees(shape), category=category, level_id=level) | {
            "feature_type": "unit"
        }

    def opening(line, level):
        return feature(in_degrees(line), category="pedestrian", level_id=level) | {
            "feature_type": "opening"
        }

    def level(key, name, ordinal):
        return feature(in_degrees(box(0, 0, 10, 6)), name={"en": name}, ordinal=ordinal) | {
            "id": key,
            "feature_type": "level",
        }

    return {
        "level.geojson": collection(level("L-1", "Ground", 0), level("L-2", "Upper", 1)),
        "unit.geojson": collection(
            *(unit(room, "L-1") for room in ROOMS),
            unit(box(0, 0, 10, 6), "L-2"),
        ),
        "opening.geojson": collection(
            opening(LineString([(4, 1), (4, 2)]), "L-1"),
            opening(LineString([(0, 1), (0, 2)]), "L-2"),
        ),
        "manifest.json": {"version": "1.0.0"},
    }


def imdf_archive(path, files):
    with ZipFile(path, "w", ZIP_DEFLATED) as archive:
        for name, data in files.items():
            archive.writestr(name, json.dumps(data))
    return path


def test_imdf_archive_has_levels_to_choose_from(tmp_path) -> None:
    path = imdf_archive(tmp_path / "venue.zip", imdf_files())
    with pytest.raises(PlanError, match=r"several levels.*L-1 \(Ground, 0\), L-2 \(Upper, 1\)"):
        import_plan(path)
    with pytest.raises(PlanError, match=r"no such level.*L-1"):
        import_plan(path, ImportOptions(level="Cellar"))
    plan = import_plan(path, ImportOptions(level="ground")).plan
    (door,) = [o for w in plan.walls for o in w.openings]
    assert (door.kind, round(door.width_m, 3)) == ("door", 1.0)
    assert len(plan.walls) == 6
    assert import_plan(path, ImportOptions(level="1")).plan.outline.area == pytest.approx(
        60, rel=1e-3
    )


def test_imdf_folder_is_read_as_its_archive(tmp_path) -> None:
    folder = tmp_path / "venue"
    folder.mkdir()
    for name, data in imdf_files().items():
        (folder / name).write_text(json.dumps(data))
    archive = imdf_archive(tmp_path / "venue.imdf", imdf_files())
    options = ImportOptions(level="Ground")
    assert import_plan(folder, options).plan == import_plan(archive, options).plan


def test_open_street_map_levels_are_lists_and_ranges(imported) -> None:
    data = collection(
        feature(box(0, 0, 10, 6), indoor="room", level="0-1"),
        feature(box(10, 0, 20, 6), indoor="room", level="1;2"),
        crs=None,
    )
    assert imported(data, level="0").outline.area == pytest.approx(60)
    assert imported(data, level="1").outline.area == pytest.approx(120)


def test_layers_name_what_the_file_calls_otherwise(imported) -> None:
    data = house()
    for part in data["features"][:-3]:
        part["properties"]["type"] = "Bauteil 7"
    with pytest.raises(PlanError, match=r"no wall and no room .*Bauteil 7"):
        imported(data | {"features": data["features"][:-3]}, unit="m")
    plan = imported(data, unit="m", layers={"bauteil*": "wall:brick"})
    assert {wall.material for wall in plan.walls} == {"brick"}


HUGE = collection(feature(box(0, 0, 30_000, 20_000), indoor="room"), crs=None)
BAD = {
    "empty collection": (collection(), "no feature"),
    "not a collection": ({"type": "Polygon"}, "FeatureCollection"),
    "features no list": ({"type": "FeatureCollection", "features": {}}, "list of features"),
    "feature no object": (collection(7), "expected a feature"),
    "no geometry": (
        collection(feature(ROOMS[0], indoor="room") | {"geometry": None}),
        "coordinates",
    ),
    "no coordinates": (
        collection({"properties": {"indoor": "room"}, "geometry": {"type": "Polygon"}}),
        r"features\[0\].geometry",
    ),
    "unknown geometry": (
        collection(
            {"properties": {"indoor": "room"}, "geometry": {"type": "Blob", "coordinates": []}}
        ),
        "not a geometry",
    ),
    "mixed systems": (
        collection(
            feature(ROOMS[0], indoor="room")
            | {"crs": {"type": "name", "properties": {"name": "EPSG:3857"}}},
            crs={"type": "name", "properties": {"name": "EPSG:4326"}},
        ),
        "different coordinate systems",
    ),
    "unknown system": (
        collection(
            feature(ROOMS[0], indoor="room"),
            crs={"type": "name", "properties": {"name": "EPSG:99999999"}},
        ),
        "unknown reference system",
    ),
    "30 km": (HUGE, r"30 km x 20 km.*give the unit: mm"),
    "metres taken as degrees": (
        collection(feature(box(0, 0, 12, 9), indoor="room")),
        r"km.*give the unit m",
    ),
    "nothing of ours": (collection(feature(ROOMS[0], type="sofa")), r"no wall.*sofa \(1\)"),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_files_say_what_is_wrong(imported, name: str) -> None:
    data, message = BAD[name]
    with pytest.raises(PlanError, match=message):
        imported(data)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('{"type": "FeatureCollection", "features": [', "not valid JSON"),
        ("{" * 100_000, "not valid JSON|nested"),
        ('{"a":' + "[" * 200_000, "nested too deep|not valid JSON"),
        (json.dumps(house()).replace("10.0", "NaN"), "not a finite number"),
        (json.dumps(house()).replace("10.0", "1e999"), "not a finite number"),
    ],
)
def test_broken_text_says_what_is_wrong(imported, text: str, message: str) -> None:
    with pytest.raises(PlanError, match=message):
        imported(text, unit="m")


def test_too_many_features_are_rejected_at_once(imported, monkeypatch) -> None:
    monkeypatch.setattr(geojson_files, "MAX_FEATURES", 3)
    with pytest.raises(PlanError, match="4 features, at most 3"):
        imported(house())


def test_too_long_files_and_zip_bombs_are_rejected_unread(tmp_path, monkeypatch) -> None:
    bomb = tmp_path / "bomb.zip"
    with ZipFile(bomb, "w", ZIP_DEFLATED) as archive:
        archive.writestr("unit.geojson", b" " * (geojson_files.MAX_BYTES + 1))
    assert bomb.stat().st_size < 1_000_000
    with pytest.raises(PlanError, match="at most 64 MiB"):
        import_plan(bomb)
    monkeypatch.setattr(geojson_files, "MAX_BYTES", 100)
    long = tmp_path / "long.geojson"
    long.write_text(json.dumps(house()))
    with pytest.raises(PlanError, match="MiB"):
        import_plan(long)


def test_archives_that_are_no_venue(tmp_path) -> None:
    other = imdf_archive(tmp_path / "other.zip", {"readme.json": {}})
    with pytest.raises(PlanError, match="no IMDF venue"):
        import_plan(other)
    cut = tmp_path / "cut.zip"
    cut.write_bytes(imdf_archive(tmp_path / "venue.zip", imdf_files()).read_bytes()[:300])
    with pytest.raises(PlanError):
        import_plan(cut)


def mutated(rng: random.Random, value):
    """Change a JSON value at one place."""
    if isinstance(value, dict) and value and rng.random() < 0.9:
        key = rng.choice(list(value))
        return {**value, key: mutated(rng, value[key])} if rng.random() < 0.9 else {}
    if isinstance(value, list) and value and rng.random() < 0.9:
        at = rng.randrange(len(value))
        return [*value[:at], mutated(rng, value[at]), *value[at + 1 :]]
    junk = [
        None,
        -1,
        0,
        1e308,
        float("nan"),
        "",
        "x",
        [],
        {},
        [[]],
        True,
        10**30,
        "wall",
        -value if isinstance(value, float) else 7,
    ]
    return rng.choice(junk)


def test_mutated_files_are_plans_or_plan_errors(imported) -> None:
    rng = random.Random(5)
    for _ in range(60):
        data = house()
        for _ in range(rng.randint(1, 4)):
            data = mutated(rng, data)
        try:
            imported(json.dumps(data), unit="m")
        except PlanError:
            continue


def test_mutated_bytes_are_plans_or_plan_errors(tmp_path) -> None:
    rng = random.Random(6)
    text = json.dumps(house(in_degrees)).encode()
    archive = imdf_archive(tmp_path / "venue.zip", imdf_files()).read_bytes()
    for sample, name in ((text, "a.geojson"), (archive, "a.zip")):
        for _ in range(25):
            data = bytearray(sample)
            for _ in range(rng.randint(1, 6)):
                data[rng.randrange(len(data))] = rng.randrange(256)
            (tmp_path / name).write_bytes(data)
            try:
                import_plan(tmp_path / name, ImportOptions(level="ground"))
            except PlanError:
                continue


def test_a_pillar_among_rooms_does_not_replace_the_walls_between_them(imported) -> None:
    rooms = [box(0, 0, 6, 5), box(6, 0, 12, 5), box(0, 5, 12, 8)]
    plan = imported(
        collection(
            *(feature(in_degrees(room), type="room") for room in rooms),
            feature(in_degrees(box(5, 6, 5.6, 6.6)), type="wall"),
            feature(in_degrees(LineString([(2, 5), (3, 5)])), type="door"),
        )
    )
    assert plan.outline.area == pytest.approx(96, rel=0.01)
    assert sum(len(wall.openings) for wall in plan.walls) == 1
