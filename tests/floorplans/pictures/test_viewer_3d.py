"""The view in three dimensions holds the plan, and its page needs no network."""

from __future__ import annotations

import re
import shutil
import subprocess

import numpy as np
import pytest
import trimesh
from PIL import Image
from small_plans import box, box_around_courtyard

import floorplans
from floorplans.pictures.viewer_3d import add_lines, add_points, plan_scene, save_scene, scene_html

CHROMIUM = shutil.which("chromium")
FLAGS = (
    "--headless", "--no-sandbox", "--disable-quic", "--no-first-run", "--disable-sync",
    "--disable-background-networking", "--disable-component-update", "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader", "--virtual-time-budget=4000", "--window-size=500,350",
)  # fmt: skip


def test_scene_has_walls_by_material_floor_and_markers() -> None:
    scene = plan_scene(floorplans.load("flat"))
    assert list(scene.geometry) == [
        "walls:brick", "walls:glass", "walls:wood", "walls:plasterboard", "walls:chipboard",
        "floor", "source", "start",
    ]  # fmt: skip
    assert "ceiling" in plan_scene(floorplans.load("flat"), ceiling=True).geometry


def test_floor_leaves_the_courtyard_out() -> None:
    plan = box_around_courtyard()
    assert plan_scene(plan).geometry["floor"].area == pytest.approx(plan.outline.area)


def test_lines_are_tubes_around_their_segments() -> None:
    scene = plan_scene(box())
    start, end = np.array([1.0, 1.0, 1.0]), np.array([4.0, 3.0, 2.0])
    add_lines(scene, "paths", [[start, end]], "#ff0000", radius_m=0.05)
    corners = scene.geometry["paths"].vertices
    along = (end - start) / np.linalg.norm(end - start)
    s = (corners - start) @ along
    distance = np.linalg.norm(corners - start - s[:, None] * along, axis=1)
    assert distance == pytest.approx(0.05, abs=1e-9)
    assert set(np.round(s, 9)) == {0.0, round(float(np.linalg.norm(end - start)), 9)}


def test_line_has_a_tube_for_each_segment() -> None:
    scene = plan_scene(box())
    for name, n_points in (("one", 2), ("three", 4)):
        add_lines(scene, name, [np.arange(3.0 * n_points).reshape(-1, 3)], "red")
    assert len(scene.geometry["three"].faces) == 3 * len(scene.geometry["one"].faces)


def test_glb_keeps_names_colours_and_lines(tmp_path) -> None:
    scene = plan_scene(box())
    add_lines(scene, "paths", [[(1, 1, 1), (2, 2, 2)], [(1, 1, 1), (3, 2, 1)]], ["red", "lime"])
    add_points(scene, "receiver", [(2.0, 2.0, 2.0)], "black")
    save_scene(scene, tmp_path / "box.glb")
    read = trimesh.load_scene(tmp_path / "box.glb")
    assert {"walls:concrete", "paths", "receiver"} <= set(read.geometry)
    colours = read.geometry["paths"].visual.vertex_attributes["color"][:, :3]
    assert {tuple(colour) for colour in colours.tolist()} == {(255, 0, 0), (0, 255, 0)}


def test_nothing_to_add_is_no_error() -> None:
    scene = plan_scene(box())
    before = list(scene.geometry)
    add_lines(scene, "paths", [], "red")
    add_points(scene, "receivers", [], "red")
    assert list(scene.geometry) == before


def test_page_loads_nothing_and_escapes_the_title() -> None:
    page = scene_html(plan_scene(box()), "<b> & co")
    assert not re.search(r"(src|href)\s*=\s*[\"']?(https?:)?//", page)
    assert "<title>&lt;b&gt; &amp; co</title>" in page
    assert "AmbientLight" in page.rpartition("function init")[2]


def test_unknown_suffix_is_rejected(tmp_path) -> None:
    with pytest.raises(ValueError, match=r"expected a name that ends in \.glb or \.html"):
        save_scene(plan_scene(box()), tmp_path / "box.png")


@pytest.mark.skipif(CHROMIUM is None, reason="no browser")
def test_browser_draws_the_walls(tmp_path) -> None:
    save_scene(plan_scene(floorplans.load("flat")), tmp_path / "flat.html", "flat")
    picture = tmp_path / "flat.png"
    command = [str(CHROMIUM), *FLAGS, f"--screenshot={picture}", f"file://{tmp_path}/flat.html"]
    subprocess.run(command, check=True, capture_output=True, timeout=120)
    pixels = np.asarray(Image.open(picture).convert("RGB"), dtype=int)
    red = (pixels[:, :, 0] > 120) & (pixels[:, :, 1] < 110) & (pixels[:, :, 2] < 90)
    yellow = (pixels[:, :, 0] > 180) & (pixels[:, :, 1] > 120) & (pixels[:, :, 2] < 110)
    assert red.mean() > 0.02  # brick
    assert yellow.mean() > 0.02  # plasterboard
