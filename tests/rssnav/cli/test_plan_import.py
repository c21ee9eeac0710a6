"""``rssnav plan import``: a plan and a report, or one line and no file."""

from __future__ import annotations

import json
import shlex
from pathlib import Path

import ezdxf
import numpy as np
import pytest
from cli_plans import ESCAPE, done, fault, run
from PIL import Image

import floorplans


@pytest.fixture
def drawing(tmp_path: Path) -> Path:
    """A hall of 12 m x 8 m in millimetres, of lines on the layer WALLS, with a table in it."""
    doc = ezdxf.new()
    doc.header["$INSUNITS"] = 4
    space = doc.modelspace()
    for layer, (x0, y0, x1, y1) in {
        "WALLS": (0, 0, 12000, 8000), "table": (3000, 3000, 4000, 4000)
    }.items():  # fmt: skip
        corners = [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]
        space.add_lwpolyline(corners, close=True, dxfattribs={"layer": layer})
    path = tmp_path / "hall.dxf"
    doc.saveas(path)
    return path


def test_a_plan_is_written_and_told(drawing: Path, tmp_path: Path):
    output = tmp_path / "hall.toml"
    text = done("plan", "import", drawing, "-o", output)
    assert floorplans.load(output).bounds == (0, 0, 12, 8)
    rows = [line.split() for line in text.splitlines()]
    assert ["WALLS", "1", "walls"] in rows
    assert any(row[:4] == ["table", "1", "left", "out"] for row in rows)
    assert any(row[:2] == ["height_m", "3"] for row in rows)
    assert text.endswith(f"wrote {output}; view it with: rssnav plan show {output}\n")
    assert not ESCAPE.search(text)


def test_the_imported_plan_passes_the_check(drawing: Path, tmp_path: Path):
    output = tmp_path / "hall.toml"
    done("plan", "import", drawing, "-o", output)
    assert "is valid" in done("plan", "check", output)


def test_meanings_of_layers_are_saved_and_used_again(drawing: Path, tmp_path: Path):
    first, second, saved = (tmp_path / name for name in ("a.toml", "b.toml", "layers.toml"))
    wooden = ("--layer", "W*=wall:wood", "--layer", "ta*=ignore")
    done("plan", "import", drawing, "-o", first, *wooden, "--save-layers", saved)
    text = saved.read_text()
    assert '[layers]\n"W*" = "wall:wood"\n"ta*" = "ignore"\n' in text
    assert '# "WALLS": 1 objects: walls of wood' in text
    done("plan", "import", drawing, "-o", second, "--layers", saved)
    assert floorplans.load(second) == floorplans.load(first)
    done(
        "plan", "import", drawing, "-o", second, "--layers", saved, "--layer", "WALLS=wall:brick",
        "--force",
    )  # fmt: skip
    assert {wall.material for wall in floorplans.load(second).walls} == {"brick"}


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("layers = 3", "layers.toml: layers = 3: expected a table"),
        ("[layers]\nA = 1", "layers.toml: layers.A = 1: expected a string"),
        ("[layer]\nA = 'wall'", 'layers.toml: layer: unknown key; did you mean "layers"?'),
        ("[layers", "layers.toml: not valid TOML"),
        ("[layers]\nWALLS = 'wal'", 'layers.WALLS = "wal": unknown kind of layer; did you mean'),
        ("", "layers.toml: layers"),
    ],
)
def test_damaged_files_of_layers_are_refused(
    text: str, message: str, drawing: Path, tmp_path: Path
):
    file = tmp_path / "layers.toml"
    file.write_text(text)
    assert message in fault("plan", "import", drawing, "-o", tmp_path / "a.toml", "--layers", file)


def test_options_go_into_the_plan(drawing: Path, tmp_path: Path):
    output = tmp_path / "hall.toml"
    done(
        "plan", "import", drawing, "-o", output, "--name", "Hall 3", "--height", 4.5,
        "--wall-thickness", 0.25, "--wall-material", "wood", "--floor-material", "metal",
        "--ceiling-material", "glass", "--source", "2,3,1", "--start", "10.5,6.5",
        "--layer", "t*=wall:brick", "--unit", "mm",
    )  # fmt: skip
    plan = floorplans.load(output)
    assert (plan.name, plan.height_m, plan.source, plan.start) == (
        "Hall 3", 4.5, (2, 3, 1), (10.5, 6.5)
    )  # fmt: skip
    assert (plan.floor_material, plan.ceiling_material) == ("metal", "glass")
    assert {(w.material, w.thickness_m) for w in plan.walls} >= {("wood", 0.25)}
    assert "brick" in {wall.material for wall in plan.walls}
    assert "assumed" not in output.read_text().replace("# assumed: wall", "")


def test_json_tells_everything(drawing: Path, tmp_path: Path):
    told = json.loads(done("plan", "import", drawing, "-o", tmp_path / "h.toml", "--json"))
    assert told["bounds_m"] == [0, 0, 12, 8]
    layer = {"name": "WALLS", "n_objects": 1, "became": "walls", "is_unknown": False}
    assert layer in told["layers"]
    assert "height_m" in {assumption["key"] for assumption in told["assumed"]}
    assert told["origin"] == {"x": 0, "y": 0, "frame": "the file, in metres"}


def test_a_file_that_is_there_is_replaced_only_by_force(drawing: Path, tmp_path: Path):
    output = tmp_path / "hall.toml"
    output.write_text("mine")
    assert "use --force to overwrite" in fault("plan", "import", drawing, "-o", output)
    assert output.read_text() == "mine"
    done("plan", "import", drawing, "-o", output, "--force")
    assert output.read_text() != "mine"


@pytest.fixture
def open_drawing(tmp_path: Path) -> Path:
    """A hall of 30 m x 20 m whose lower side is open from x = 8 to 22."""
    doc = ezdxf.new()
    doc.header["$INSUNITS"] = 6
    corners = [(8, 0), (0, 0), (0, 20), (30, 20), (30, 0), (22, 0)]
    doc.modelspace().add_lwpolyline(corners, dxfattribs={"layer": "WALLS"})
    path = tmp_path / "hall.dxf"
    doc.saveas(path)
    return path


def test_an_open_building_is_a_draft_with_a_picture_of_its_gaps(open_drawing: Path, tmp_path: Path):
    output, draft = tmp_path / "hall.toml", tmp_path / "hall.draft.toml"
    line = fault("plan", "import", open_drawing, "-o", output)
    assert "the building is open: 14.00 m from (8, 0) to (22, 0)" in line
    assert line.endswith("close gaps of up to 14.1 m; use --close-gaps M")
    assert not output.exists()
    assert "the outline is open from" in fault("plan", "show", draft, "-o", tmp_path / "a.png")
    picture = np.asarray(Image.open(tmp_path / "hall.draft.png").convert("RGB")).astype(int)
    assert ((picture[..., 0] > 200) & (picture[..., 1:].max(axis=-1) < 60)).sum() > 200
    draft.write_text("corrected by hand")
    fault("plan", "import", open_drawing, "-o", output)
    assert draft.read_text() == "corrected by hand"
    fault("plan", "import", open_drawing, "-o", output, "--force")
    assert draft.read_text().startswith("# DRAFT")


def test_a_report_page_is_written_for_a_plan_and_for_a_draft(
    drawing: Path, open_drawing: Path, tmp_path: Path
):
    page = tmp_path / "page.html"
    for file in (open_drawing, drawing):
        run("plan", "import", file, "-o", tmp_path / "a.toml", "--report", page, "--force")
        text = page.read_text()
        assert "<svg" in text
        assert ("cannot be traced until" in text) == (file == open_drawing)
        page.unlink()
    assert run("plan", "import", drawing, "-o", "a.toml", "--report", "a.pdf").exit_code == 2


def test_wider_gaps_are_closed_on_request(open_drawing: Path, tmp_path: Path):
    output = tmp_path / "hall.toml"
    text = done("plan", "import", open_drawing, "-o", output, "--close-gaps", 14.1)
    assert "gap of 14.00 m in the outline closed" in text
    assert floorplans.load(output).outline.area == pytest.approx(600)


def test_a_draft_is_a_plan_once_its_gaps_have_walls(open_drawing: Path, tmp_path: Path):
    output, draft = tmp_path / "hall.toml", tmp_path / "hall.draft.toml"
    fault("plan", "import", open_drawing, "-o", output)
    wall = '[[walls]]\npoints = [[8, 0], [21.97, 0]]\nmaterial = "brick"\nthickness_m = 0.2\n'
    draft.write_text(draft.read_text() + wall)
    done("plan", "check", draft, "--fix", "-o", output)
    assert floorplans.load(output).outline.area == pytest.approx(600, rel=0.01)


@pytest.mark.parametrize(
    ("name", "content", "said"),
    [
        ("plan.dxf", b"\x89PNG\r\n\x1a\n", "does not begin like a DXF drawing"),
        ("plan.dxf", b"", "the file is empty"),
        ("plan.dxf", b"  0\nSECTION\n  2\nnonsense", "plan.dxf: "),
        ("plan.dwg", b"AC1032", "a DWG drawing; save it as DXF"),
        ("plan.geojson", b"  0\nSECTION", "does not begin like a GeoJSON"),
    ],
)
def test_bad_files_end_with_one_line_and_nothing_written(
    name: str, content: bytes, said: str, tmp_path: Path
):
    path, output = tmp_path / name, tmp_path / "out" / "plan.toml"
    path.write_bytes(content)
    line = fault("plan", "import", path, "-o", output)
    assert str(path) in line
    assert said in line
    assert not output.parent.exists()


def test_a_wrong_unit_is_told_with_the_right_one(drawing: Path, tmp_path: Path):
    line = fault("plan", "import", drawing, "-o", tmp_path / "x.toml", "--unit", "m")
    assert "12 km x 8 km" in line
    assert "give the unit: mm for 12 m x 8 m" in line
    assert line.endswith("use --unit UNIT")


@pytest.mark.parametrize(
    "wrong",
    [
        ("--source", "1,2"),
        ("--start", "a,b"),
        ("--layer", "walls"),
        ("--height", "tall"),
        ("-o", "plan.dxf"),
    ],
)
def test_wrong_usage_ends_with_2(wrong: tuple[str, str], drawing: Path, tmp_path: Path):
    arguments = ["plan", "import", str(drawing), "-o", str(tmp_path / "x.toml"), *wrong]
    result = run(*arguments)
    assert result.exit_code == 2
    assert not (tmp_path / "x.toml").exists()


def test_help_has_examples_that_work(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.chdir(tmp_path)
    text = ESCAPE.sub("", done("plan", "import", "--help"))
    commands = [
        line.strip() for line in text.splitlines() if line.strip().startswith("rssnav plan")
    ]
    assert len(commands) == 3
    for command in commands:
        done(*shlex.split(command)[1:])
