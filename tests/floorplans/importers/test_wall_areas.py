"""Wall areas become centre lines with the measured thickness."""

import numpy as np
import pytest
import shapely
from shapely import affinity
from shapely.geometry import LineString, Point, box

from floorplans.importers.centrelines.areas import walls_of_area

CROSS = [box(0, 0, 10, 0.3), box(0, 0, 0.3, 6), box(9.7, 0, 10, 6), box(0, 5.7, 10, 6)]
CROSS += [box(4, 0, 4.2, 6), box(0, 3, 10, 3.2)]


@pytest.mark.parametrize("angle", [0, 17, 45, 90])
def test_area_of_wall_becomes_centre_lines_with_the_measured_thickness(angle: float) -> None:
    area = affinity.rotate(shapely.union_all(CROSS), angle, origin=(0, 0))
    walls = walls_of_area(area, 0.02)
    back = [affinity.rotate(LineString([w.start, w.end]), -angle, origin=(0, 0)) for w in walls]
    ends = sorted(sorted(map(tuple, np.round(line.coords, 3).tolist())) for line in back)
    assert ends == [
        [(0.15, 0.15), (0.15, 5.85)],
        [(0.15, 0.15), (9.85, 0.15)],
        [(0.15, 3.1), (9.85, 3.1)],
        [(0.15, 5.85), (9.85, 5.85)],
        [(4.1, 0.15), (4.1, 5.85)],
        [(9.85, 0.15), (9.85, 5.85)],
    ]
    assert sorted(round(wall.thickness_m, 3) for wall in walls) == [0.2, 0.2, 0.3, 0.3, 0.3, 0.3]


@pytest.mark.parametrize("length_m", [0.79, 0.8, 0.81, 1.0])
@pytest.mark.parametrize("angle", [0, 30, 90])
def test_a_column_of_one_to_two_is_a_pillar_where_no_wall_goes_on(length_m, angle) -> None:
    hall = box(0, 0, 12, 9) - box(0.3, 0.3, 11.7, 8.7)
    column = box(6, 4, 6 + length_m, 4.4)
    in_line = box(0.1, 4, 5, 4.4) | box(8, 4, 11.9, 4.4)
    for walls, n_sides in ((hall, 4), (hall | in_line, 0)):
        area = affinity.rotate(walls | column, angle, origin=(0, 0))
        around = affinity.rotate(column.buffer(0.01), angle, origin=(0, 0))
        found = [LineString([w.start, w.end]) for w in walls_of_area(area, 0.02)]
        on = [line for line in found if around.covers(line)]
        assert len(on) == n_sides or (n_sides == 0 and len(on) == 1)


def test_a_pillar_is_a_ring_of_half_its_width() -> None:
    walls = walls_of_area(box(2, 2, 2.5, 2.6), 0.02)
    assert len(walls) == 4
    assert {round(wall.thickness_m, 6) for wall in walls} == {0.25}
    assert shapely.polygonize([LineString([w.start, w.end]) for w in walls]).area == pytest.approx(
        0.3
    )


@pytest.mark.parametrize("angle", [0, 31])
def test_a_heavy_wall_is_a_wall_and_a_thick_block_a_ring(angle: float) -> None:
    storey = box(0, 0, 22, 14) - box(1.6, 1.6, 20.4, 12.4) | box(9, 1, 9.6, 13)
    block = box(14, 6, 15.8, 7.8)
    area = affinity.rotate(storey | block, angle, origin=(0, 0))
    walls = walls_of_area(area, 0.02)
    assert sorted(round(wall.thickness_m, 2) for wall in walls) == [0.5] * 4 + [0.6] + [1.6] * 4
    faces = shapely.polygonize([LineString([w.start, w.end]) for w in walls])
    sizes = sorted(face.area for face in faces.geoms)
    assert sizes[0] == pytest.approx(1.8**2, rel=0.01)
    outer = shapely.union_all([LineString([w.start, w.end]) for w in walls]).convex_hull
    assert outer.area == pytest.approx(20.4 * 12.4, rel=0.01)


@pytest.mark.parametrize("angle", [0, 23])
def test_a_wall_goes_on_beyond_niches_within_it(angle: float) -> None:
    niches = [box(x, 0.1, x + 0.8, 0.5) for x in (2, 5, 8)]
    whole = box(0, 0, 12, 0.6) - shapely.union_all(niches)
    area = affinity.rotate(whole, angle, origin=(0, 0))
    walls = walls_of_area(area, 0.02)
    back = [
        (affinity.rotate(LineString([w.start, w.end]), -angle, origin=(0, 0)), w.thickness_m)
        for w in walls
    ]
    thick = sorted(line.bounds for line, thickness_m in back if thickness_m == pytest.approx(0.6))
    ends = [x for x_min, _, x_max, _ in thick for x in (x_min, x_max)]
    assert ends == pytest.approx([0, 2, 2.8, 5, 5.8, 8, 8.8, 12], abs=0.02)
    assert all(line.centroid.y == pytest.approx(0.3) for line, t in back if t > 0.3)


def test_a_bent_wall_becomes_chords_within_its_body() -> None:
    arc = Point(0, 0).buffer(8, quad_segs=24) - Point(0, 0).buffer(7.7, quad_segs=24)
    walls = walls_of_area(arc & box(0, 0, 9, 9), 0.02)
    chords = shapely.union_all([LineString([w.start, w.end]) for w in walls])
    assert arc.buffer(1e-3).covers(chords)
    assert chords.length == pytest.approx(7.85 * np.pi / 2, rel=0.03)
    assert all(wall.thickness_m == pytest.approx(0.3, abs=0.02) for wall in walls)
