"""The page of an import: everything in one file, drawing and plan in the same coordinates."""

from __future__ import annotations

import re
from dataclasses import replace
from html.parser import HTMLParser
from itertools import pairwise
from pathlib import Path

import dxf_drawings as draw
import numpy as np
import pytest
from shapely.geometry import MultiLineString, box

from floorplans.importers import (
    Draft,
    DraftPlan,
    ImportOptions,
    RawOpening,
    RawWall,
    UnusablePlanError,
    assemble,
    import_page,
    import_plan,
)
from floorplans.importers.original import DrawnLayer, Original


class Reader(HTMLParser):
    """Collects the tags with their attributes, and all text."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.text = ""
        self.feed(page)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))

    def handle_data(self, data: str) -> None:
        self.text += data


def points_of(page: Reader, css_class: str | None) -> np.ndarray:
    """All absolute points of the paths of a class (n, 2)."""
    paths = [
        a.get("d") or "" for tag, a in page.tags if tag == "path" and a.get("class") == css_class
    ]
    return np.array(re.findall(r"[ML](-?[\d.]+) (-?[\d.]+)", "".join(paths)), dtype=float)


def ring(x0: float, y0: float, x1: float, y1: float) -> list[RawWall]:
    corners = [(x0, y0), (x1, y0), (x1, y1), (x0, y1), (x0, y0)]
    return [RawWall(a, b, 0.3, "brick") for a, b in pairwise(corners)]


def drawing(name: str = "A-WALL") -> Original:
    lines = MultiLineString([box(100, 50, 112, 58).exterior, [(103, 52), (104, 53)]])
    return Original((DrawnLayer(name, "walls", True, lines),))


def test_the_drawing_lies_under_the_plan():
    draft = Draft("hall", tuple(ring(100, 50, 112, 58)), original=drawing())
    page = Reader(import_page(assemble(draft, ImportOptions(), "hall.dxf")))
    walls = points_of(page, "line")
    assert walls.min(axis=0) == pytest.approx([0, 0])
    assert walls.max(axis=0) == pytest.approx([12, 8])
    drawn = points_of(page, None)
    assert {tuple(p) for p in walls.round(3)} <= {tuple(p) for p in drawn.round(3)}
    assert (3.0, 2.0) in {tuple(p) for p in drawn}


def shown(page: Reader) -> tuple[float, float, float, float]:
    """The part of the plane that is shown first (x_min, y_min, x_max, y_max) [m]."""
    (box_,) = [a["viewbox"] for tag, a in page.tags if tag == "svg"]
    x, top, width, height = map(float, (box_ or "").split())
    return x, -top - height, x + width, -top


@pytest.mark.parametrize(("far_m", "seen_m"), [(40.0, 40.0), (90_000.0, 300.0)])
def test_the_page_shows_the_whole_drawing_but_no_stray_point(far_m: float, seen_m: float):
    fence = DrawnLayer(
        "FENCE", "left out", False, MultiLineString([[(100, 50), (100 + far_m, 70)]])
    )
    original = replace(drawing(), layers=(*drawing().layers, fence))
    draft = Draft("hall", tuple(ring(100, 50, 112, 58)), original=original)
    x0, y0, x1, y1 = shown(Reader(import_page(assemble(draft, ImportOptions(), "hall.dxf"))))
    assert x0 < 0
    assert y0 < 0
    assert y1 > 20
    assert x1 > min(far_m, 12)
    assert x1 < 2 * seen_m


def test_what_was_left_out_assumed_and_closed_is_listed():
    walls = [*ring(0, 0, 12, 8)[1:], RawWall((0, 0), (6, 0)), RawWall((8, 0), (12, 0))]
    door = RawOpening((5, 5), 0.9, "door")
    draft = Draft("hall", (*walls, RawWall((30, 0), (31, 0))), (door,), notes=("so so",))
    page = Reader(import_page(assemble(draft, ImportOptions(), "hall.dxf")))
    text = " ".join(page.text.split())
    for said in (
        "gap of 2.00 m in the outline closed",
        "wall of 1.00 m outside the outline dropped",
        "door that lies in no wall dropped",
        "the file gives no height of the storey",
        "so so",
    ):
        assert said in text
    assert sorted(points_of(page, "closed").tolist()) == [[6, 0], [8, 0]]


def test_the_page_of_a_draft_lists_its_faults_and_marks_its_gaps():
    two = Draft("x", (RawWall((0, 0), (30, 0)), RawWall((0, 20), (30, 20))))
    with pytest.raises(UnusablePlanError) as caught:
        assemble(two, ImportOptions(), "x.dxf")
    assert isinstance(caught.value.draft, DraftPlan)
    page = Reader(import_page(caught.value.draft))
    assert "cannot be traced until" in page.text
    assert "the outline is open" in page.text
    assert len(points_of(page, "gap")) == 4


def test_names_of_a_file_are_text_and_nothing_is_loaded():
    evil = '<script>alert(1)</script>" onload="x'
    draft = Draft(evil, tuple(ring(100, 50, 112, 58)), original=drawing(evil), notes=(evil,))
    html = import_page(assemble(draft, ImportOptions(), "a.dxf"))
    page = Reader(html)
    assert [tag for tag, _ in page.tags].count("script") == 1
    assert not [a for _, a in page.tags if "onload" in a]
    loaded = [a.get(key) for _, a in page.tags for key in ("src", "href") if key in a]
    assert all(url is not None and url.startswith("data:") for url in loaded)
    assert "http" not in html


def test_furniture_of_a_drawing_is_shown_as_left_out(tmp_path: Path):
    doc = draw.flat_of_bodies()
    chair = doc.blocks.new("CHAIR")
    chair.add_circle((0, 0), 250)
    doc.modelspace().add_blockref("CHAIR", (2000, 2000), dxfattribs={"layer": "A-FURN"})
    doc.modelspace().add_lwpolyline([(3000, 3000), (4000, 3000)], dxfattribs={"layer": "A-ANNO"})
    original = import_plan(draw.save(doc, tmp_path)).original
    assert original is not None
    left_out = {layer.name: layer for layer in original.layers if not layer.is_used}
    assert set(left_out) == {"A-FURN", "A-ANNO"}
    x, y = left_out["A-FURN"].geometry.centroid.coords[0]
    assert (x, y) == pytest.approx((2 - 0.15, 2 - 0.15), abs=0.01)
    assert left_out["A-ANNO"].geometry.length == pytest.approx(1.0)
