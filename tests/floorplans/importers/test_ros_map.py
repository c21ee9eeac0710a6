"""Occupancy grids become plans: straight walls, gaps, obstacles, and what the files may say."""

import random
import struct
import zlib
from io import BytesIO

import numpy as np
import pytest
import shapely
from PIL import Image
from shapely.geometry import LineString, Point

from floorplans import FloorPlan, PlanError
from floorplans.importers import ImportOptions, UnusablePlanError, import_plan
from floorplans.importers.ros_map.occupancy_grid import read_grid
from floorplans.importers.ros_map.thinning import polylines, thinned
from floorplans.importers.ros_map.vectorise import walls_of_picture

PIXEL_M = 0.05
YAML = """image: {image}
resolution: 0.05
origin: [-1.0, -2.0, 0.0]
negate: 0
occupied_thresh: 0.65
free_thresh: 0.196
"""


def drawn(area, free, n_x=280, n_y=240) -> np.ndarray:
    """Return values of pixels, the first row the highest: 0 wall, 254 free, 205 unknown."""
    x, y = np.meshgrid((np.arange(n_x) + 0.5) * PIXEL_M, (np.arange(n_y) + 0.5) * PIXEL_M)
    values = np.full((n_y, n_x), 205, dtype=np.uint8)
    values[shapely.contains_xy(free, x, y)] = 254
    values[shapely.contains_xy(area, x, y)] = 0
    return values[::-1]


# A room of 10 m x 7 m with a partition at x = 6 that has a gap of 1 m, and a round pillar
ROOM = shapely.box(1, 1, 11, 8)
LINES = [ROOM.exterior, LineString([(6, 1), (6, 4)]), LineString([(6, 5), (6, 8)])]
PILLAR = Point(3.5, 4.5).buffer(0.3)


def room_values(angle: float = 0.0) -> np.ndarray:
    walls = shapely.union_all(
        [shapely.buffer(line, 0.1, cap_style="flat", join_style="mitre") for line in LINES]
    )

    def turned(area):
        return shapely.affinity.translate(
            shapely.affinity.rotate(area, angle, origin=(6, 4.5)), 1.0, 1.5
        )

    return drawn(turned(walls | PILLAR), turned(ROOM))


def write_map(folder, values, name="room", text=YAML):
    Image.fromarray(values).save(folder / f"{name}.pgm")
    path = folder / f"{name}.yaml"
    path.write_text(text.format(image=f"{name}.pgm"))
    return path


def rings(plan: FloorPlan):
    lines = [LineString([w.start, w.end]) for w in plan.walls]
    return [
        ring for ring in shapely.get_parts(shapely.polygonize(lines)) if ring.area < 1.0
    ]  # fmt: skip


@pytest.mark.parametrize("angle", [0, 12, 30])
def test_room_with_a_gap_and_a_pillar(angle: float, tmp_path) -> None:
    imported = import_plan(write_map(tmp_path, room_values(angle)))
    plan = imported.plan
    assert plan.outline.area == pytest.approx(70.0, rel=0.01)
    (pillar,) = rings(plan)
    assert pillar.area == pytest.approx(np.pi * 0.09, rel=0.2)
    left = angle - (plan.frame.rotation_deg if plan.frame else 0.0)
    long = [w for w in plan.walls if w.length_m > 1.0]
    assert len(long) == 6
    for wall in long:
        turn = np.degrees(np.arctan2(*np.subtract(wall.end, wall.start)[::-1])) - left
        assert abs((turn + 45) % 90 - 45) < 0.4
    assert all(w.thickness_m == pytest.approx(0.2, abs=PIXEL_M / 2) for w in long)
    partitions = sorted(long, key=lambda w: w.length_m)[:2]
    gap = LineString([partitions[0].start, partitions[0].end]).distance(
        LineString([partitions[1].start, partitions[1].end])
    )
    assert gap == pytest.approx(1.0, abs=1.5 * PIXEL_M)
    assert any(note.startswith("of all occupied pixels, 100.0 % lie") for note in imported.notes)
    assert not imported.warnings


def test_coordinates_are_those_of_the_map(tmp_path) -> None:
    origin = import_plan(write_map(tmp_path, room_values())).origin
    assert (origin.x, origin.y) == pytest.approx((1.0, 0.5), abs=0.01)


def test_noise_is_left_out_and_small_gaps_closed(tmp_path) -> None:
    values = room_values().copy()
    rng = np.random.default_rng(3)
    values[rng.integers(0, 240, 30), rng.integers(0, 280, 30)] = 0
    holes = np.argwhere(values == 0)
    values[tuple(holes[rng.integers(0, len(holes), 60)].T)] = 254
    plan = import_plan(write_map(tmp_path, values)).plan
    assert plan.outline.area == pytest.approx(70.0, rel=0.02)
    assert sum(w.length_m for w in plan.walls if w.length_m > 1.0) == pytest.approx(40.0, rel=0.03)


def test_single_pixels_all_over_a_map_are_left_out_and_not_the_map(tmp_path) -> None:
    values = room_values()
    rng = np.random.default_rng(8)
    free = np.argwhere(values == 254)
    values[tuple(free[rng.choice(len(free), 120, replace=False)].T)] = 0
    result = import_plan(write_map(tmp_path, values))
    assert result.plan.outline.area == pytest.approx(
        import_plan(write_map(tmp_path, room_values(), "clean")).plan.outline.area, rel=0.01
    )
    assert any(use.name == "specks" and use.n_objects > 50 for use in result.layers)


def test_modes_thresholds_and_negate_say_which_pixels_are_walls(tmp_path) -> None:
    values = np.array([[0, 80, 120, 205, 254]], dtype=np.uint8)

    def occupied_free(**changes):
        text = YAML + "".join(f"{key}: {value}\n" for key, value in changes.items())
        grid = read_grid(write_map(tmp_path, values, text=text), None)
        return "".join(np.where(grid.occupied[0], "#", np.where(grid.free[0], ".", "?")))

    assert occupied_free() == "##??."
    assert occupied_free(mode="scale") == "##??."
    assert occupied_free(occupied_thresh=0.4) == "###?."
    assert occupied_free(free_thresh=0.2) == "##?.."
    assert occupied_free(negate=1) == ".??##"
    values = np.array([[0, 10, 66, 100, 255]], dtype=np.uint8)
    assert occupied_free(mode="raw") == "..##?"


def test_transparent_pixels_are_unknown(tmp_path) -> None:
    rgba = np.zeros((1, 3, 4), dtype=np.uint8)
    rgba[0, :, 3] = (255, 0, 255)
    rgba[0, 2, :3] = 255
    Image.fromarray(rgba, "RGBA").save(tmp_path / "a.png")
    grid = read_grid(tmp_path / "a.png", 0.1)
    assert (grid.occupied.tolist(), grid.free.tolist()) == (
        [[True, False, False]],
        [[False, False, True]],
    )


@pytest.mark.parametrize("angle", [0.0, 0.3])
def test_the_picture_shown_is_the_known_space_in_its_place(angle: float, tmp_path) -> None:
    values = room_values()
    text = YAML.replace("-2.0, 0.0]", f"-2.0, {angle}]")
    picture = import_plan(write_map(tmp_path, values, text=text)).original.picture
    rows, columns = (np.flatnonzero((values != 205).any(axis=axis)) for axis in (1, 0))
    assert picture.size == (np.ptp(columns) + 1, np.ptp(rows) + 1)
    corners = np.array([[0, 0, 1], [*picture.size, 1]]) @ np.array(picture.to_m).T
    walls = room_values()[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]
    assert (
        np.asarray(Image.open(BytesIO(picture.png))) == np.where(walls == 254, 255, walls)
    ).all()
    across_m = np.hypot(*(corners[1] - corners[0]))
    assert across_m == pytest.approx(PIXEL_M * np.hypot(*picture.size))
    plan = import_plan(write_map(tmp_path, values, text=text)).plan
    assert corners.mean(axis=0) == pytest.approx(plan.outline.centroid.coords[0], abs=0.03)


def test_grey_of_a_map_saver_is_unknown_whatever_its_threshold(tmp_path) -> None:
    text = YAML.replace("free_thresh: 0.196", "free_thresh: 0.25")
    grid = read_grid(write_map(tmp_path, room_values(), text=text), None)
    assert (grid.free == (room_values()[::-1] == 254)).all()
    assert any("pixels of value 205 free" in note for note in grid.notes)
    shaded = room_values()
    shaded[0, 0] = 200  # a scan of another program, whose thresholds hold
    grid = read_grid(write_map(tmp_path, shaded, text=text), None)
    assert (grid.free == (shaded[::-1] >= 200)).all()
    assert grid.notes == ()


def test_a_plain_picture_needs_a_scale(tmp_path) -> None:
    Image.fromarray(np.where(room_values() == 0, 0, 255).astype(np.uint8)).save(tmp_path / "a.png")
    with pytest.raises(PlanError, match=r"no a.yaml beside .*give it, such as 0.05 m"):
        import_plan(tmp_path / "a.png")
    plan = import_plan(tmp_path / "a.png", ImportOptions(scale_m=0.1)).plan
    assert plan.outline.area == pytest.approx(280.0, rel=0.01)


def test_yaml_that_names_another_picture(tmp_path) -> None:
    path = write_map(tmp_path, room_values(), text=YAML.replace("{image}", "map.pgm"))
    with pytest.raises(PlanError, match=r'image = "map.pgm": there is no such file; room.pgm lies'):
        import_plan(path)
    imported = import_plan(tmp_path / "room.pgm")
    assert imported.plan.outline.area == pytest.approx(70.0, rel=0.01)
    assert any("names the picture map.pgm" in note for note in imported.notes)


@pytest.mark.parametrize("image", ["../room.pgm", "/etc/passwd", "..", "room.yaml", "", "a\\0.pgm"])
def test_pictures_otherwise_are_rejected(image: str, tmp_path) -> None:
    folder = tmp_path / "below"
    folder.mkdir()
    Image.fromarray(room_values()).save(tmp_path / "room.pgm")
    path = write_map(folder, room_values(), text=YAML.replace("{image}", f'"{image}"'))
    with pytest.raises(PlanError, match="image"):
        import_plan(path)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("resolution: 0.05", "", "resolution"),
        ("resolution: 0.05", "resolution: 0", "above 0"),
        ("resolution: 0.05", "resolution: .nan", "finite"),
        ("origin: [-1.0, -2.0, 0.0]", "origin: [1, 2]", r"\[x, y, yaw\]"),
        ("origin: [-1.0, -2.0, 0.0]", "origin: [a, b, c]", "finite number"),
        ("negate: 0", "mode: colour", "unknown mode"),
        ("free_thresh: 0.196", "free_thresh: 0.9", "free_thresh <= occupied_thresh"),
        ("image: {image}", "image: [1]", "name of the picture"),
        ("image: {image}", "image: {{", "not a map's YAML"),
        ("image: {image}", "- 1", "not begin like"),
        ("image: {image}", "image: !!python/object/apply:os.getcwd []", "not a map's YAML"),
        ("resolution: 0.05", "resolution: 5", "for a building.*side of a pixel"),
    ],
)
def test_yaml_files_that_are_wrong_say_where(old: str, new: str, message: str, tmp_path) -> None:
    assert old in YAML
    with pytest.raises(PlanError, match=message):
        import_plan(write_map(tmp_path, room_values(), text=YAML.replace(old, new)))


def png_of(width: int, height: int) -> bytes:
    """Return a PNG whose header alone tells that it is large."""

    def chunk(kind: bytes, data: bytes) -> bytes:
        body = kind + data
        return struct.pack(">I", len(data)) + body + struct.pack(">I", zlib.crc32(body))

    header = chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 1, 0, 0, 0, 0))
    return (
        b"\x89PNG\r\n\x1a\n" + header + chunk(b"IDAT", zlib.compress(b"\0")) + chunk(b"IEND", b"")
    )


BAD_PICTURES = {
    "huge header": (b"P5 100000 100000 255\n", "a.pgm", "pixels"),
    "larger header": (b"P5 999999999 999999999 255\n", "a.pgm", "pixels|too large|read"),
    "cut short": (
        b"P5 100 100 255\n" + bytes(50),
        "a.pgm",
        "cannot be read|not a picture|truncated",
    ),
    "no numbers": (b"P5 x y 255\n", "a.pgm", "not a picture"),
    "negative": (b"P5 -5 7 255\n", "a.pgm", "not a picture|pixels"),
    "text": (b"hello", "a.png", "does not begin like"),
    "empty": (b"", "a.pgm", "empty"),
    "bomb": (png_of(30_000, 30_000), "a.png", "pixels|too large"),
    "white": (b"P5 20 20 255\n" + bytes([255]) * 400, "a.pgm", "no pixel is occupied"),
    "a dot": (b"P5 3 3 255\n" + bytes([255] * 4 + [0] + [255] * 4), "a.pgm", "for a building"),
    "dots": (b"P5 100 9 255\n" + (bytes(6) + bytes([255] * 88) + bytes(6)) * 9, "a.pgm", "no line"),
}


@pytest.mark.parametrize("name", BAD_PICTURES)
def test_bad_pictures_say_what_is_wrong(name: str, tmp_path) -> None:
    data, file, message = BAD_PICTURES[name]
    (tmp_path / file).write_bytes(data)
    with pytest.raises(PlanError, match=message):
        import_plan(tmp_path / file, ImportOptions(scale_m=0.05))


def test_mutated_maps_are_plans_or_plan_errors(tmp_path) -> None:
    path = write_map(tmp_path, room_values()[::3, ::3])
    picture = tmp_path / "room.pgm"
    samples = {path: path.read_bytes(), picture: picture.read_bytes()}
    rng = random.Random(7)
    for _ in range(60):
        for file, sample in samples.items():
            data = bytearray(sample)
            for _ in range(rng.randint(0, 8)):
                data[rng.randrange(min(len(data), 400))] = rng.randrange(256)
            file.write_bytes(data)
        try:
            import_plan(path if rng.random() < 0.5 else picture)
        except PlanError:
            continue


def test_thinning_keeps_what_is_connected_and_is_one_pixel_wide() -> None:
    solid = np.zeros((60, 80), dtype=bool)
    solid[10:17, 5:70] = solid[10:50, 30:38] = True
    solid[45:50, 30:75] = True
    thin = thinned(solid)
    assert (thin <= solid).all()
    lines = polylines(thin)
    union = shapely.union_all(lines)
    assert shapely.get_num_geometries(shapely.line_merge(union)) == len(lines)
    assert union.buffer(0.1).geom_type == "Polygon"
    assert (
        shapely.hausdorff_distance(
            union, shapely.MultiLineString([[(5, 13), (69, 13)], [(34, 13), (34, 47), (74, 47)]])
        )
        < 5
    )


def test_an_empty_picture_has_no_walls() -> None:
    assert walls_of_picture(np.zeros((20, 20), dtype=bool), 1.5) == []


def hall(n_x=280, n_y=240):
    """Return walls and free space of the room of 10 m x 7 m, each 0.1 m thick."""
    walls = ROOM.exterior.buffer(0.05, join_style="mitre")
    return walls, ROOM, (n_x, n_y)


@pytest.mark.parametrize("transposed", [False, True])
def test_walls_of_the_pixels_of_one_line_are_in_one_line(transposed: bool) -> None:
    solid = np.zeros((220, 340), dtype=np.bool_)
    solid[[10, 210], 10:311] = solid[10:211, [[10], [310]]] = True
    solid[10, 90:200] = False
    walls = walls_of_picture(solid.T if transposed else solid, 1.5)
    ends = np.array([(wall.start, wall.end) for wall in walls]).reshape(-1, 2)
    for coordinate, sides in zip(ends.T[:: -1 if transposed else 1], (310, 210), strict=True):
        off = np.abs(coordinate[:, None] - 0.5 - [10, sides, 90, 200]).min(axis=1)
        assert np.minimum(off, np.abs(off - 0.5)).max() < 1e-4


@pytest.mark.parametrize("width_m", [1.5, 4.0, 8.0])
def test_the_border_of_known_space_closes_a_bay_door_and_the_report_lists_it(
    width_m: float, tmp_path
) -> None:
    walls, free, size = hall()
    racks = shapely.union_all([shapely.box(x, 1.6, x + 0.5, 4) for x in (2.5, 5.5, 8.5)])
    door = shapely.box(6 - width_m / 2, 0, 6 + width_m / 2, 2)
    area = walls.difference(door) | racks.boundary.buffer(0.04)
    imported = import_plan(write_map(tmp_path, drawn(area, free.difference(racks), *size)))
    assert imported.plan.outline.area == pytest.approx(70.0, rel=0.01)
    (closed,) = (change for change in imported.changes if change.kind == "closed")
    assert np.hypot(*np.subtract(closed.at, closed.to)) == pytest.approx(width_m, abs=0.11)
    assert {round(closed.at[1], 1), round(closed.to[1], 1)} == {0.0}
    told = any("shows no wall on" in sentence for sentence in imported.warnings)
    assert told == (width_m > 0.1 * 34)


def test_openings_wider_than_asked_for_stay_open(tmp_path) -> None:
    walls, free, size = hall()
    path = write_map(tmp_path, drawn(walls.difference(shapely.box(4, 0, 8, 2)), free, *size))
    with pytest.raises(UnusablePlanError, match=r"open: 3\.9\d m|open: 4\.0\d m"):
        import_plan(path, ImportOptions(close_gaps_m=2.0))


def test_free_space_is_inside_however_ragged_its_border_is(tmp_path) -> None:
    """A room half mapped: nothing but free space on its right side, in lobes."""
    lobes = [Point(8, y).buffer(r) for y, r in ((2.5, 1.2), (4.5, 1.8), (6.5, 1.1))]
    free = shapely.union_all([shapely.box(1, 1, 8, 8), *lobes])
    walls = shapely.LineString([(8, 1), (1, 1), (1, 8), (8, 8)]).buffer(0.06, cap_style="flat")
    values = drawn(walls, free)
    imported = import_plan(write_map(tmp_path, values))
    y, x = np.nonzero(values[::-1] == 254)
    shift = (imported.origin.x + 1.0, imported.origin.y + 2.0)  # the map's origin is (-1, -2)
    inside = shapely.contains_xy(
        imported.plan.outline, (x + 0.5) * PIXEL_M - shift[0], (y + 0.5) * PIXEL_M - shift[1]
    )
    assert inside.mean() > 0.98
    assert any("shows no wall on" in sentence for sentence in imported.warnings)


@pytest.mark.parametrize("angle", [0, 17])
def test_thin_walls_in_dashes_are_walls(angle: float, tmp_path) -> None:
    walls = shapely.union_all([shapely.buffer(line, 0.03) for line in LINES])

    def turned(area):
        return shapely.affinity.translate(
            shapely.affinity.rotate(area, angle, origin=(6, 4.5)), 1.0, 1.0
        )

    values = drawn(turned(walls), turned(ROOM))
    y, x = np.nonzero(values == 0)
    along = (np.cos(np.radians(angle)) * x + np.sin(np.radians(angle)) * -y) * PIXEL_M
    across = (np.sin(np.radians(angle)) * -x + np.cos(np.radians(angle)) * -y) * PIXEL_M
    gone = ((along % 1.0) < 0.35) | ((across % 1.0) < 0.35)  # dashes of 0.65 m
    values[y[gone], x[gone]] = 254
    plan = import_plan(write_map(tmp_path, values)).plan
    assert plan.outline.area == pytest.approx(70.0, rel=0.03)
    long = sorted((w.length_m for w in plan.walls if w.length_m > 0.6), reverse=True)
    assert sum(long) == pytest.approx(40.0, rel=0.05)
    assert len(long) <= 10


def test_pillars_beside_a_wall_stay_pillars_and_round_ones_are_round(tmp_path) -> None:
    walls, free, size = hall()
    pillars = [
        shapely.box(1.2, 3, 1.7, 3.5), Point(4, 4).buffer(0.15), Point(6, 4).buffer(0.4)
    ]  # fmt: skip
    hidden = shapely.union_all([pillar.buffer(-0.06) for pillar in pillars[1:]])
    solid = shapely.union_all([walls, pillars[0], *(p.boundary.buffer(0.03) for p in pillars[1:])])
    plan = import_plan(write_map(tmp_path, drawn(solid, free.difference(hidden), *size))).plan
    found = sorted(rings(plan), key=lambda ring: ring.centroid.x)
    assert len(found) == 3
    for ring, pillar in zip(found, pillars, strict=True):
        placed = shapely.affinity.translate(pillar, -1, -1)
        assert ring.hausdorff_distance(placed) <= 1.5 * PIXEL_M + 0.03
        assert ring.area == pytest.approx(pillar.buffer(0.03).area, rel=0.3)


NOISE = {
    "thirds": (0.2, 0.4, 0.4),
    "specks on white": (0.01, 0.0, 0.99),
    "specks on grey": (0.03, 0.97, 0.0),
}


@pytest.mark.parametrize("name", NOISE)
def test_hopeless_maps_are_refused_with_the_reason(name: str, tmp_path) -> None:
    values = np.random.default_rng(1).choice([0, 205, 254], size=(200, 200), p=NOISE[name])
    with pytest.raises(PlanError, match=r"noise|no line of pixels"):
        import_plan(write_map(tmp_path, values.astype(np.uint8)))


def test_free_space_that_no_wall_separates_is_outside_and_counted(tmp_path) -> None:
    walls, free, size = hall()
    other = shapely.box(1.5, 9, 5.5, 11)
    imported = import_plan(write_map(tmp_path, drawn(walls, free | other, *size)))
    (sentence,) = imported.warnings
    assert sentence.startswith("10 % of the map's free pixels (8 m² of 7")


def test_a_name_too_long_for_any_file_is_no_file(tmp_path) -> None:
    (tmp_path / "map.yaml").write_text(
        f"image: {'room' * 500}.png\nresolution: 0.05\norigin: [0, 0, 0]\n"
        "negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.2\n"
    )
    with pytest.raises(PlanError, match="there is no such file"):
        import_plan(tmp_path / "map.yaml")
