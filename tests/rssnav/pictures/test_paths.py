"""``rssnav paths``: its pictures from above and in 3D, its choice of paths, its CSV."""

import csv
import json
from io import StringIO
from pathlib import Path

import numpy as np
import pytest
import trimesh
from cli_plans import QUICK, ROOM, run
from matplotlib.colors import to_hex

import floorplans
from raytrace import Paths, TraceConfig, Transmitter, trace_paths
from rssnav.pictures.paths import path_lines, paths_figure, power_scale, save_paths_picture
from rssnav.scenes import scene_of
from rssnav.transmitters import POWER_DBM

PLAN = floorplans.loads(ROOM)
RECEIVER = (2.5, 3.0, 1.8)


@pytest.fixture(scope="module")
def paths() -> Paths:
    receivers = np.array([RECEIVER])
    return trace_paths(scene_of(PLAN), Transmitter(PLAN.source), receivers, TraceConfig(2, 1))


@pytest.fixture(scope="module")
def room(tmp_path_factory) -> Path:
    path = tmp_path_factory.mktemp("paths") / "room.toml"
    path.write_text(ROOM, encoding="utf-8")
    return path


def by_gid(figure, gid: str):
    (artist,) = [a for a in figure.axes[0].get_children() if a.get_gid() == gid]
    return artist


def test_lines_are_the_paths_vertices_and_the_strongest_is_drawn_last(paths: Paths) -> None:
    figure = paths_figure(PLAN, paths, POWER_DBM, "title")
    lines = by_gid(figure, "paths")
    drawn = list(lines.get_segments())
    assert len(drawn) == len(paths)
    for segment, line in zip(drawn[::-1], path_lines(paths), strict=True):
        np.testing.assert_allclose(segment, line[:, :2])
    np.testing.assert_allclose(lines.get_array()[::-1], POWER_DBM + paths.gain_db)
    (bar,) = [ax for ax in figure.axes if ax.get_label() == "<colorbar>"]
    assert bar.get_ylabel() == "power of the path [dBm]"


def test_marks_stand_where_paths_turn(paths: Paths) -> None:
    marks = by_gid(paths_figure(PLAN, paths, POWER_DBM, "title"), "reflection").get_offsets()
    assert len(marks) == (paths.interactions == 1).sum()
    x_min, y_min, x_max, y_max = PLAN.bounds
    assert (marks >= (x_min - 1e-9, y_min - 1e-9)).all()
    assert (marks <= (x_max + 1e-9, y_max + 1e-9)).all()


def test_receiver_stands_where_it_was_asked_for(paths: Paths) -> None:
    mark = by_gid(paths_figure(PLAN, paths, POWER_DBM, "title"), "receiver")
    np.testing.assert_allclose(mark.get_xydata(), [RECEIVER[:2]])


@pytest.mark.parametrize("powers", [[-50.0], [-50.0, -np.inf], [], [-70.0, -50.0]])
def test_scale_always_spans_at_least_a_decibel(powers: list[float]) -> None:
    scale = power_scale(np.array(powers))
    assert scale.vmax - scale.vmin >= 1.0
    assert np.isfinite([scale.vmin, scale.vmax]).all()


def test_glb_holds_plan_receiver_and_paths_in_their_colours(paths: Paths, tmp_path: Path) -> None:
    save_paths_picture(PLAN, paths, POWER_DBM, "title", tmp_path / "paths.glb")
    scene = trimesh.load_scene(tmp_path / "paths.glb")
    assert {"paths", "receiver", "source", "walls:concrete"} <= set(scene.geometry)
    low, high = scene.geometry["paths"].bounds
    assert (low >= -0.05).all()
    assert (high - low)[2] <= PLAN.height_m + 0.1
    assert list(tmp_path.iterdir()) == [tmp_path / "paths.glb"]


def test_page_holds_title_and_colour_bar_and_asks_for_nothing(paths: Paths, tmp_path: Path) -> None:
    save_paths_picture(PLAN, paths, POWER_DBM, "a <title>", tmp_path / "paths.html")
    page = (tmp_path / "paths.html").read_text(encoding="utf-8")
    assert "a &lt;title&gt;" in page
    bar = page[page.index('id="colour-bar"') :][:900]
    assert "power of the path [dBm]" in bar
    assert f"{POWER_DBM + paths.gain_db[0]:.1f}" in bar
    strongest = to_hex("#0d0887")
    assert f"rgb({int(strongest[1:3], 16)},{int(strongest[3:5], 16)}," in bar
    assert 'src="http' not in page


@pytest.mark.parametrize("suffix", [".png", ".svg", ".pdf", ".html", ".glb"])
def test_command_draws_every_format(room: Path, tmp_path: Path, suffix: str) -> None:
    target = tmp_path / f"paths{suffix}"
    result = run("paths", room, "--to", "2.5,3", "--picture", target, *QUICK)
    assert result.exit_code == 0
    assert target.stat().st_size > 1000


def test_only_and_top_choose_paths_but_sums_stay_those_of_all(room: Path) -> None:
    whole = json.loads(run("paths", room, "--to", "2.5,3", "--json", *QUICK).stdout)
    some = json.loads(
        run("paths", room, "--to", "2.5,3", "--only", "r", "--top", 2, "--json", *QUICK).stdout
    )
    assert {path["interactions"] for path in some["strongest"]} == {"R"}
    assert len(some["strongest"]) == 2
    for key in ("paths", "rss_dbm", "delay_spread_s", "k_factor_db"):
        assert some[key] == whole[key]


def test_csv_has_a_line_a_path(room: Path) -> None:
    text = run("paths", room, "--to", "2.5,3", "--top", 3, "--csv", *QUICK).stdout
    rows = list(csv.DictReader(StringIO(text)))
    assert [row["path"] for row in rows] == ["1", "2", "3"]
    ends = [row["vertices_m"].split("; ")[-1] for row in rows]
    assert ends == ["2.5 3 2"] * 3


def test_nothing_to_draw_is_said(room: Path, tmp_path: Path) -> None:
    target = tmp_path / "none.png"
    result = run("paths", room, "--to", "2.5,3", "--only", "D", "--picture", target, *QUICK)
    assert result.exit_code == 0
    assert "no path to draw" in result.stderr
    assert not target.exists()


@pytest.mark.parametrize(
    ("options", "message"),
    [(("--json", "--csv"), "--csv"), (("--picture", "paths.txt"), "--picture")],
)
def test_wrong_usage(room: Path, options: tuple[str, ...], message: str) -> None:
    result = run("paths", room, "--to", "2.5,3", *options)
    assert result.exit_code == 2
    assert message in result.stderr
