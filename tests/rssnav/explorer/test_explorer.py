"""What a tab of the explorer does, without a browser."""

from __future__ import annotations

import asyncio
import socket
import sys
import time
from collections.abc import Iterator
from contextlib import closing
from dataclasses import replace
from itertools import pairwise
from threading import Event, get_ident
from types import SimpleNamespace

import numpy as np
import pytest
from bokeh.models import HoverTool, Image
from cli_plans import run
from shapely.geometry import Polygon

import floorplans
import rssnav
from floorplans import FloorPlan, PlanError, PlanTransmitter, Wall
from floorplans.exporters.formats import export
from floorplans.geojson_plan import dumps_geojson
from floorplans.transmitters import ALL
from raytrace import Paths, RadioMap, TraceConfig
from rssnav.explorer.background import FileMaker, NewestOnly, SupersededError, TooManyError
from rssnav.explorer.cell_panel import _summary
from rssnav.explorer.cell_paths import CellPaths, path_colours, strongest
from rssnav.explorer.downloads import figure_file, map_file, plan_file
from rssnav.explorer.fair_turns import FairTurns, TabTurns
from rssnav.explorer.file_names import file_name
from rssnav.explorer.flight_player import FRAMES, FlightPlayer, first_frames, flight_at
from rssnav.explorer.limits import Limits
from rssnav.explorer.map_figure import MapFigure
from rssnav.explorer.map_settings import MapSettings
from rssnav.explorer.page import Changes, Page
from rssnav.explorer.server import host_names, with_port
from rssnav.explorer.session import Session
from rssnav.explorer.space_view import page_3d
from rssnav.explorer.styles import survey_words
from rssnav.explorer.tracing import MapCache
from rssnav.explorer.training import (
    Flight,
    LiveTraining,
    TrainingSettings,
    kept_episodes,
    suggested_goal_dbm,
)
from rssnav.explorer.training_panel import running_mean
from rssnav.explorer.uploads import read_upload
from rssnav.maps import make_map
from rssnav.presets import PRESETS
from rssnav.transmitters import SOURCE, Sending

FLAT = floorplans.load("flat")
TOML = floorplans.dumps(FLAT)
COARSE = MapSettings(cell_size_m=1.5, max_reflections=2)
PATIENCE_S = 60.0
CACHE = MapCache(size=8)


def wait_for(condition) -> None:
    """Wait until a condition holds; fail where it does not in time."""
    ends_s = time.monotonic() + PATIENCE_S
    while not condition():
        assert time.monotonic() < ends_s, "waited in vain"
        time.sleep(0.005)


def wait_for_map(session: Session) -> None:
    wait_for(lambda: session.complete_map is not None and session.maps.progress is None)


@pytest.fixture
def session() -> Iterator[Session]:
    """A session of the flat with coarse cells, its map complete."""
    opened = Session(FLAT, cache=CACHE)
    opened.change_settings(COARSE)
    wait_for_map(opened)
    yield opened
    opened.close()


def test_newest_job_takes_the_flight_at_older_ones() -> None:
    done, begun, thread = [], Event(), NewestOnly("test", TabTurns(FairTurns(1)))

    def endless(ticket) -> None:
        begun.set()
        while True:
            ticket.check()

    thread.submit(endless)
    begun.wait(PATIENCE_S)
    for number in range(3):
        thread.submit(lambda _ticket, number=number: done.append(number))
    wait_for(lambda: done and done[-1] == 2)
    thread.close()
    thread.submit(lambda _ticket: done.append("late"))
    thread.join(PATIENCE_S)
    assert done[-1] == 2


def test_a_job_that_fails_is_logged_and_ends_no_other(caplog) -> None:
    done, thread = Event(), NewestOnly("test", TabTurns(FairTurns(1)))

    def failing(_ticket) -> None:
        raise ZeroDivisionError

    thread.submit(failing)
    wait_for(lambda: "a job of test failed" in caplog.text)
    thread.submit(lambda _ticket: done.set())
    assert done.wait(PATIENCE_S)
    thread.close()


def test_a_cancelled_ticket_stops_a_map() -> None:
    """The tracer gives up its threads when its progress is answered by an error."""

    def progress(done: int, _total: int) -> None:
        if done == 1:
            raise SupersededError

    with pytest.raises(SupersededError):
        make_map(FLAT, cell_size_m=3.0, config=TraceConfig(1, 1), progress=progress)


def test_map_is_the_one_that_the_command_line_makes(session) -> None:
    traced = session.complete_map
    made = make_map(session.plan, cell_size_m=1.5, config=TraceConfig(2, 1))
    assert traced.radio_map.plan_sha256 == session.plan.sha256
    np.testing.assert_array_equal(traced.radio_map.rss_dbm, made.rss_dbm)
    np.testing.assert_array_equal(traced.radio_map.path_count, made.path_count)


def test_last_map_stays_until_the_new_one_is_there(session) -> None:
    before = session.maps.latest
    session.move_source(7.3, 2.2)
    assert session.complete_map is None
    seen = [before]
    while session.complete_map is None:
        assert session.maps.latest is not None
        seen += [session.maps.latest] if session.maps.latest is not seen[-1] else []
    assert [traced.complete for traced in seen[:2]] == [True, False]
    assert session.complete_map.radio_map.transmitter.position == (7.3, 2.2, FLAT.source[2])


def test_map_and_paths_of_a_moved_source_share_one_scene(session, monkeypatch) -> None:
    session.move_source(7.4, 2.3)  # its map is in no cache, so the scene is built
    wait_for_map(session)
    built: list[FloorPlan] = []
    monkeypatch.setattr("rssnav.explorer.tracing.PlanScene.of", built.append)
    session.move_source(7.3, 2.2)
    session.choose_cell(5.2, 2.2)
    wait_for_map(session)
    wait_for(lambda: not session.paths.busy)
    assert session.paths.latest is not None
    assert built == []


def test_a_preview_has_reflections_only_and_is_no_complete_map(session) -> None:
    session.preview_source(6.0, 2.0)
    wait_for(lambda: not session.maps.latest.complete)
    assert session.maps.latest.radio_map.config.max_diffractions == 0
    assert session.plan.source == FLAT.source
    session.preview_source(-6.0, 2.0)
    session.move_source(*FLAT.source[:2])
    wait_for_map(session)


def test_start_snaps_to_a_cell_centre_and_keeps_the_map(session) -> None:
    before = session.maps.latest
    session.move_start(5.1, 7.2)
    assert session.plan.start == (5.25, 6.75)
    assert session.maps.latest is before
    assert session.complete_map.radio_map.plan_sha256 == session.plan.sha256


@pytest.mark.parametrize(("x", "y"), [(-3.0, 2.0), (5.0, 4.0)], ids=["outside", "in a wall"])
def test_source_stays_where_it_was_when_it_cannot_be_there(session, x, y) -> None:
    session.move_source(x, y)
    assert "source" in session.problem
    assert session.plan.source == FLAT.source
    wait_for_map(session)


def test_paths_of_a_cell_add_up_to_the_map(session) -> None:
    session.choose_cell(9.6, 1.4)
    wait_for(lambda: session.paths.latest is not None)
    found, radio_map = session.paths.latest, session.complete_map.radio_map
    i_y, i_x = session.cell
    assert found.receiver[:2] == (radio_map.grid.x[i_x], radio_map.grid.y[i_y])
    assert abs(found.receiver[0] - 9.6) <= 0.75
    assert found.statistics.path_count[0] == radio_map.path_count[i_y, i_x]
    assert found.statistics.rss_dbm[0] == pytest.approx(radio_map.rss_dbm[i_y, i_x], abs=1e-9)
    assert 0.0 < found.statistics.delay_spread_s[0] <= np.ptp(found.paths.delay_s)
    for line in strongest(found):
        assert line[-1] == pytest.approx(found.receiver)
    session.choose_cell(-5.0, 0.0)
    assert session.cell is None
    assert session.paths.latest is None


def test_tabs_share_maps_and_nothing_else(session) -> None:
    cache = MapCache()
    one, two = Session(FLAT, cache=cache), Session(FLAT, cache=cache)
    for opened in (one, two):
        opened.change_settings(COARSE)
        wait_for_map(opened)
    assert one.maps.latest is two.maps.latest
    one.move_source(6.0, 2.0)
    assert two.plan.source == FLAT.source
    assert two.complete_map is not None
    for opened in (one, two):
        opened.close()


def test_cache_forgets_the_oldest() -> None:
    cache, plan = MapCache(size=2), FLAT
    traced = [replace_settings(plan, reflections) for reflections in range(3)]
    for item in traced:
        cache.put(item)
    assert cache.get(plan, traced[0].settings) is None
    assert cache.get(plan, traced[2].settings) is traced[2]


def replace_settings(plan, reflections):
    """Stand-in for a map, told apart by its reflections."""
    from rssnav.explorer.tracing import TracedMap

    return TracedMap(plan, MapSettings(max_reflections=reflections), None, True)


def test_limits_name_what_would_be_right(session) -> None:
    before = session.settings
    session.change_settings(replace(before, cell_size_m=0.05))
    assert "cells of at least" in session.problem
    assert session.settings == before
    session.change_settings(replace(before, height_m=3.0))
    assert "below 2.6 m" in session.problem
    with pytest.raises(PlanError, match="at most 2"):
        Session(FLAT, Limits(walls=2))


def test_a_map_that_takes_too_long_is_given_up() -> None:
    opened = Session(FLAT, Limits(map_s=0.0))
    wait_for(lambda: opened.maps.problem)
    assert "takes longer than 0 s" in opened.maps.problem
    opened.close()


def test_uploaded_plan_is_opened(session) -> None:
    session.upload("mine.toml", TOML.replace('"flat"', '"my flat"').encode())
    wait_for(session.take_upload)
    assert session.plan.name == "my flat"
    wait_for_map(session)


BAD_UPLOADS = {
    "another kind": ("plan.exe", b"MZ", "ends in"),
    "a map that names a picture": ("map.yaml", b"image: /etc/hostname", "ends in"),
    "no text": ("a.toml", b"\xff\xfe\x00", "UTF-8"),
    "no TOML": ("a.toml", b"name = ", "TOML"),
    "too deep": ("a.toml", b"a = " + b"[" * 50_000, "TOML|deep"),
    "a file to follow": ("a.toml", b'include = "/etc/hostname"\n' + TOML.encode(), "include"),
    "too large": ("a.toml", b"#" * 9_000_000, "at most"),
    "folders in the name": ("../../a.exe", b"", "^a.exe"),
    "broken drawing": ("a.dxf", b"no drawing", "dxf"),
}


@pytest.mark.parametrize(("name", "content", "says"), BAD_UPLOADS.values(), ids=BAD_UPLOADS)
def test_upload_that_is_refused(name, content, says) -> None:
    with pytest.raises(PlanError, match=says):
        read_upload(name, content)


def test_a_file_of_another_program_is_read() -> None:
    assert read_upload("flat.geojson", dumps_geojson(FLAT).encode()).plan == FLAT


@pytest.mark.filterwarnings("ignore::PendingDeprecationWarning")
def test_an_uploaded_drawing_keeps_its_name_and_shows_its_report(session, tmp_path) -> None:
    page, panel = (made := Page(session)), made._plan_panel
    assert panel._report.object == ""
    (drawing,) = export(FLAT, tmp_path / "flat.dxf")
    session.upload("My <flat>, büro.dxf", drawing.read_bytes())
    wait_for(lambda: session._uploaded is not None)
    page.refresh()
    assert session.plan.name == "My <flat>, büro"
    shown = panel._report.object
    assert "layer WINDOW (5): 5 blocks of doors and windows" in shown
    assert "assumed height_m = 3" in shown
    session.open_builtin("flat")
    page.refresh()
    assert panel._report.object == ""


@pytest.mark.filterwarnings("ignore::PendingDeprecationWarning")
def test_a_flight_begins_with_the_values_that_it_is_flown_with(session) -> None:
    page, panel = (made := Page(session)), made._map_panel
    x, frequency = panel._places["source_x_m"], panel._numbers["frequency_ghz"]
    x.value = 99.0
    frequency.value = 5.0
    page.refresh()
    assert "outside the outline" in session.problem
    assert x.value == 99.0  # another coordinate may still make it valid
    session.train(TrainingSettings("rss", episodes=1, goal_rss_dbm=-45.0))
    page.refresh()
    assert session.problem == ""
    assert x.value == FLAT.source[0]
    assert frequency.value == session.settings.frequency_hz / 1e9 == 2.4


def test_a_reader_gets_no_more_than_its_time_and_memory() -> None:
    content = dumps_geojson(FLAT).encode()
    with pytest.raises(PlanError, match=r"not read within 0\.01 s"):
        read_upload("flat.geojson", content, Limits(import_s=0.01))
    large = content.replace(
        b"{", b'{"comment": "' + bytes(5_000_000).replace(b"\0", b"-") + b'", ', 1
    )
    assert read_upload("flat.geojson", large).plan == FLAT
    with pytest.raises(PlanError):
        read_upload("flat.geojson", large, Limits(import_bytes=30_000_000))


def test_walls_of_an_upload_are_counted_before_they_are_checked() -> None:
    rows = "".join(f"[{x}, 0], " for x in range(3000))
    text = TOML + f'\n[[walls]]\npoints = [{rows}]\nmaterial = "nonsense"\n'
    with pytest.raises(PlanError, match="at most 1500"):
        read_upload("a.toml", text.encode())


def test_refused_upload_leaves_the_plan(session) -> None:
    session.upload("a.toml", b"name = ")
    wait_for(session.take_upload)
    assert "TOML" in session.problem
    assert session.plan.name == "flat"


@pytest.mark.parametrize("agent", ["rss", "location"])
def test_training_is_the_one_that_train_makes(session, agent) -> None:
    traced = session.complete_map
    settings = TrainingSettings(agent, episodes=300, seed=4, goal_rss_dbm=-45.0)
    live = LiveTraining(traced, settings)
    live.start()
    live.join(PATIENCE_S)
    assert not live.problem
    world = rssnav.GridWorld.from_map(session.plan, traced.radio_map, 1)
    result = rssnav.train(world, settings.agent_itself(), runs=1, episodes=300, seed=4)
    np.testing.assert_array_equal(live.steps, result.steps[0])
    assert (live.converged_episode or -1) == result.converged_episode[0]
    *flown, learned = live.flights
    assert learned.learned
    np.testing.assert_array_equal(learned.position, result.trajectory_m(0))
    assert [flight.episode for flight in flown] == kept_episodes(300).tolist()
    for flight in flown:
        assert flight.steps == result.steps[0, flight.episode - 1]
        assert tuple(flight.position[0]) == session.plan.start
        assert flight.reached
        assert np.abs(np.diff(flight.position, axis=0)).max() <= 1.5


def test_training_stops_when_told_and_when_the_source_moves(session) -> None:
    endless = TrainingSettings("location", episodes=20_000, pace=40.0)
    begin_s = time.monotonic()
    session.train(endless)
    first = session.training
    wait_for(lambda: first.steps.size > 0)
    session.stop_training()
    first.join(PATIENCE_S)
    assert 0 < first.steps.size <= 40.0 * (time.monotonic() - begin_s) + 4
    session.train(endless)
    second = session.training
    session.move_source(6.0, 2.0)
    second.join(PATIENCE_S)
    assert session.training is None
    session.train(endless)
    assert "not complete" in session.problem


def test_training_says_why_it_cannot_begin(session) -> None:
    session.train(TrainingSettings(goal_rss_dbm=20.0))
    session.training.join(PATIENCE_S)
    assert "RSS > 20 dBm" in session.training.problem


def test_downloads_are_what_the_page_shows(session, tmp_path) -> None:
    session.move_start(5.1, 7.2)
    traced = session.complete_map
    (tmp_path / "map.h5").write_bytes(map_file(traced))
    loaded = RadioMap.load(tmp_path / "map.h5")
    assert loaded.plan_sha256 == session.plan.sha256
    np.testing.assert_array_equal(loaded.rss_dbm, traced.radio_map.rss_dbm)
    assert floorplans.loads(plan_file(session).decode()) == session.plan
    assert figure_file(traced, ".png").startswith(b"\x89PNG")
    assert b"<svg" in figure_file(traced, ".svg")


def test_files_are_made_one_by_one_beside_the_page() -> None:
    files, threads = FileMaker(TabTurns(FairTurns(1))), list[int]()
    go = Event()

    def content() -> bytes:
        assert go.wait(PATIENCE_S)
        threads.append(get_ident())
        return b"file"

    async def clicks() -> list[object]:
        made = asyncio.gather(
            *(files.make(content) for _ in range(FileMaker.MOST + 1)), return_exceptions=True
        )
        await asyncio.sleep(0)  # the page answers while they wait
        go.set()
        return await made

    with closing(asyncio.new_event_loop()) as loop:
        *made, last = loop.run_until_complete(clicks())
        files.close()
        with pytest.raises(SupersededError):
            loop.run_until_complete(files.make(content))
    assert made == [b"file"] * FileMaker.MOST
    assert isinstance(last, TooManyError)
    assert set(threads) == {threads[0]}
    assert threads[0] != get_ident()


@pytest.mark.filterwarnings("ignore::PendingDeprecationWarning")
def test_the_learned_flight_is_shown_at_the_end_even_while_others_are_played() -> None:
    shown: list[Flight] = []
    player = FlightPlayer(lambda flight, _step: shown.append(flight))
    flights = [Flight(k, np.zeros((4 + k, 2)), True) for k in (1, 2, 3)]
    training = SimpleNamespace(flights=flights, settings=TrainingSettings(episodes=3))
    player.follow(training)
    player._player.direction = 1
    player._player.value = 0
    assert shown[-1] is flights[0]
    flights.append(Flight(3, np.zeros((4, 2)), True, learned=True))
    player.follow(training)
    assert shown[-1] is flights[-1]
    assert player._player.direction == 0
    player.show(True)
    assert player.view.visible


def test_a_cell_has_one_number_of_paths() -> None:
    halves = Paths(
        receiver=np.zeros(3, np.int64),
        interactions=np.zeros((3, 0), np.int8),
        vertices=np.zeros((3, 2, 3)),
        length_m=np.ones(3),
        gain=np.full(3, 1e-3 + 0j),
        weight=np.array([1.0, 0.5, 0.5]),
    )
    found = CellPaths(FLAT, MapSettings(), (1.0, 1.0, 1.0), halves)
    assert "<dt>paths</dt><dd>2</dd>" in _summary(found)


@pytest.mark.filterwarnings("ignore::PendingDeprecationWarning")
def test_a_read_upload_leaves_an_empty_dropper(session) -> None:
    page = Page(session)
    before = page._plan_panel._upload[0]
    session.upload("bad.toml", b"name = ")
    wait_for(lambda: session._uploaded is not None)
    page.refresh()
    assert "bad.toml" in session.problem
    assert page._plan_panel._upload[0] is not before
    session.problem = ""


@pytest.mark.parametrize(
    ("plan_name", "expected"),
    [("flat", "flat.h5"), ("../a b/ü", "a-b.h5"), ("///", "plan.h5")],
)
def test_names_of_downloads_are_harmless(plan_name, expected) -> None:
    assert file_name(plan_name, ".h5") == expected


def test_view_in_space_runs_scripts_without_the_page(session) -> None:
    session.choose_cell(9.6, 1.4)
    wait_for(lambda: session.paths.latest is not None)
    html = page_3d(session.plan, session.paths.latest)
    assert html.startswith('<iframe title="3D" sandbox="allow-scripts" srcdoc="')
    assert html.count("<") == 2  # everything else is escaped


def test_kept_episodes_begin_densely_and_end_with_the_last() -> None:
    assert kept_episodes(7).tolist() == [1, 2, 3, 4, 5, 6, 7]
    many = kept_episodes(20_000)
    assert many[:5].tolist() == [1, 2, 3, 4, 5]
    assert many[-1] == 20_000
    assert many.size <= 200
    assert np.all(np.diff(many) > 0)


def test_frames_lead_through_every_flight() -> None:
    steps = [0, 3, 500]
    first = first_frames(steps)
    assert first.tolist() == [0, 1, 5, 5 + FRAMES]
    places = [flight_at(first, frame) for frame in range(first[-1])]
    assert [index for index, _ in places] == [0, *[1] * 4, *[2] * FRAMES]
    shown = [round(fraction * steps[index]) for index, fraction in places]
    assert shown[:5] == [0, 0, 1, 2, 3]
    assert shown[5] == 0
    assert shown[-1] == 500


def test_running_mean_is_the_mean_of_the_latest() -> None:
    values = np.arange(40, dtype=np.int32) ** 2
    expected = [values[max(0, k - 24) : k + 1].mean() for k in range(40)]
    np.testing.assert_allclose(running_mean(values, 25), expected)
    assert running_mean(np.empty(0, np.int32), 25).size == 0


def test_path_colours_darken_with_power() -> None:
    strong, weak, weaker = path_colours(np.array([-40.0, -70.0, -170.0]))
    assert weak == weaker
    brightness = [sum(bytes.fromhex(colour[1:])) for colour in (strong, weak)]
    assert brightness[0] < brightness[1]
    assert path_colours(np.empty(0)) == []


def test_goal_suits_the_map(session) -> None:
    radio_map = session.complete_map.radio_map
    strongest_dbm = radio_map.rss_dbm.max()
    assert suggested_goal_dbm(radio_map, strongest_dbm - 5.0) == strongest_dbm - 5.0
    assert strongest_dbm - 2.0 < suggested_goal_dbm(radio_map, 0.0) < strongest_dbm


def test_what_a_map_carries_shows_under_the_pointer(session) -> None:
    with_spread = session.complete_map.radio_map
    without = replace(with_spread, delay_spread_s=None)
    shown = MapFigure(FLAT, 2.0, on_move=print, on_drag=print, on_tap=print, on_step=print)
    hover = next(tool for tool in shown.model.select(HoverTool) if not tool.tooltips)
    for drawn, names in (
        (without, ["RSS", "paths", "at"]),
        (with_spread, ["RSS", "paths", "delay spread", "at"]),
    ):
        shown.show_map(drawn)
        assert [name for name, _ in hover.tooltips] == names


def test_the_tooltip_tells_outside_from_without_a_path() -> None:
    corners = [(0, 0), (6, 0), (6, 2), (3, 2), (3, 4), (0, 4), (0, 0)]
    walls = [Wall(a, b, "concrete", 0.2, FLAT.height_m) for a, b in pairwise(corners)]
    plan = replace(
        FLAT, outline=Polygon(corners), walls=tuple(walls), source=(1, 1, 1.5), start=(0.5, 3.5)
    )
    radio_map = make_map(plan, cell_size_m=1.0, config=TraceConfig(max_reflections=0))
    dark = np.where(radio_map.grid.x < 1, -np.inf, radio_map.rss_dbm)
    shown = MapFigure(plan, 2.0, on_move=print, on_drag=print, on_tap=print, on_step=print)
    shown.show_map(replace(radio_map, rss_dbm=dark))
    images = (r for r in shown.model.renderers if isinstance(r.glyph, Image))
    (picture,) = (r for r in images if "rss" in r.data_source.data)
    values = picture.data_source.data["rss"][0]
    outside = (radio_map.grid.x > 3) & (radio_map.grid.y[:, None] > 2)
    assert (np.isnan(values) == outside).all()
    assert (np.isneginf(values) == np.isneginf(dark) & ~outside).all()
    (hover,) = (tool for tool in shown.model.select(HoverTool) if "@rss" in tool.formatters)
    code = hover.formatters["@rss"].code
    assert code.index("'outside'") < code.index("'no path'")


def test_a_mark_tells_where_it_was_dropped_and_comes_back_when_deleted() -> None:
    told = []
    shown = MapFigure(
        FLAT,
        2.0,
        on_move=lambda *place: told.append(place),
        on_drag=print,
        on_tap=print,
        on_step=print,
    )
    marks = shown.model.renderers[-1].data_source
    marks.data = {**marks.data, "x": [3.0, FLAT.start[0]]}
    assert told == [("source", 3.0, FLAT.source[1])]
    marks.data = {name: values[:1] for name, values in marks.data.items()}
    assert marks.data["x"] == [FLAT.source[0], FLAT.start[0]]
    assert len(told) == 1


def test_changes_are_those_since_the_last_update() -> None:
    changes = Changes()
    assert changes.of("a", 1, None)
    assert not changes.of("a", 1, None)
    assert changes.of("a", 2, None)
    assert changes.of("b", 2, None)


@pytest.mark.parametrize(
    ("address", "names"),
    [
        ("127.0.0.1", ("127.0.0.1", "localhost")),
        ("localhost", ("127.0.0.1", "localhost")),
        ("192.0.2.7", ("192.0.2.7",)),
        ("0.0.0.0", (socket.gethostname(), "127.0.0.1", "localhost")),
    ],
)
def test_only_known_names_are_let_in(address, names) -> None:
    assert host_names(address) == names


def test_allowed_names_get_the_port() -> None:
    assert with_port(["lab", "lab:80"], 5006) == ["lab:5006", "lab:80"]


def test_command_names_the_missing_extra(monkeypatch) -> None:
    for name in [name for name in sys.modules if name.startswith("rssnav.explorer")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "panel", None)
    result = run("explore", "--no-browser")
    assert result.exit_code == 1
    assert 'pip install "rssnav[explore]"' in result.stderr


def test_command_refuses_a_port_in_use() -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        result = run("explore", "flat", "--no-browser", "--port", str(taken.getsockname()[1]))
    assert result.exit_code == 1
    assert "--port" in result.stderr


@pytest.mark.parametrize("address", ["x" * 300, "a..b", "256.1.1.1"])
def test_command_refuses_an_address_that_is_none(address) -> None:
    result = run("explore", "flat", "--no-browser", "--address", address)
    assert result.exit_code == 1
    assert result.stderr.startswith(f"rssnav: cannot listen on {address[:200]}")


def test_command_refuses_an_origin_with_a_scheme() -> None:
    result = run("explore", "flat", "--no-browser", "--allow-origin", "http://lab")
    assert result.exit_code == 2
    assert "HOST:PORT" in result.output + result.stderr


TWO_ROOMS = replace(
    FLAT,
    name="two transmitters",
    transmitters=(
        PlanTransmitter("east", (9.6, 1.4, 1.5), power_dbm=20.0, antenna="dipole"),
        PlanTransmitter("west", (1.2, 7.9, 1.5), frequency_hz=5e9),
    ),
)
READINGS = "tx,x,y,z,rss_dbm\n" + "".join(
    f"{tx},{x:g},{y:g},1.2,{-40 - 3 * k}\n"
    for k, (x, y) in enumerate([(9.0, 2.0), (8.0, 2.5), (2.0, 7.0), (3.0, 7.5), (2.5, 6.5)])
    for tx in ("east", "west")
)


@pytest.fixture
def with_transmitters() -> Iterator[Session]:
    session = Session(TWO_ROOMS, cache=CACHE)
    session.change_settings(replace(COARSE.with_preset("building"), max_reflections=2))
    wait_for_map(session)
    yield session
    session.close()


def test_plans_of_ones_own_let_waves_through_and_built_in_ones_do_not() -> None:
    for plan, preset in ((FLAT, "paper"), (replace(FLAT, walls=FLAT.walls[:-1]), "building")):
        session = Session(plan, cache=CACHE)
        assert session.settings.preset == preset
        assert session.settings.max_reflections == PRESETS[preset].config.max_reflections
        session.close()


def test_a_transmitter_of_the_plan_is_mapped_as_the_command_does(with_transmitters) -> None:
    session = with_transmitters
    session.choose_server("east")
    wait_for_map(session)
    traced = session.complete_map.radio_map
    sent = Sending(default_antenna=session.settings.receive_antenna.antenna).transmitter(
        TWO_ROOMS.transmitters[0]
    )
    made = make_map(
        TWO_ROOMS, transmitter=sent, cell_size_m=1.5,
        config=replace(PRESETS["building"].config, max_reflections=2),
        receive_antenna=session.settings.receive_antenna.antenna,
    )  # fmt: skip
    np.testing.assert_array_equal(traced.rss_dbm, made.rss_dbm)
    assert session.plan.source == TWO_ROOMS.transmitters[0].position
    session.choose_server("west")
    assert session.settings.transmitter(session.plan).frequency_hz == 5e9
    session.move_source(2.0, 7.0)
    assert session.settings.server == SOURCE


def test_the_best_transmitter_serves_each_cell(with_transmitters) -> None:
    session = with_transmitters
    maps = []
    for name in ("east", "west"):
        session.choose_server(name)
        wait_for_map(session)
        maps.append(session.complete_map.radio_map.rss_dbm)
    session.choose_server(ALL)
    wait_for(lambda: session.maps.latest.servers and session.maps.latest.complete)
    traced = session.maps.latest
    assert traced.servers == ("east", "west")
    np.testing.assert_allclose(traced.radio_map.rss_dbm, np.max(maps, axis=0))
    assert session.complete_map is None
    heard = traced.best_server >= 0
    assert {0, 1} == set(traced.best_server[heard])
    np.testing.assert_array_equal(traced.best_server[heard], np.argmax(maps, axis=0)[heard])
    session.choose_cell(9.0, 2.0)
    wait_for(lambda: session.paths.latest is not None)
    i_y, i_x = session.cell
    power = session.paths.latest.statistics.rss_dbm[0]
    assert power == pytest.approx(traced.radio_map.rss_dbm[i_y, i_x], abs=1e-6)
    session.train(TrainingSettings())
    assert "not complete" in session.problem or session.training is None


def test_a_survey_is_compared_with_what_is_traced(with_transmitters) -> None:
    session = with_transmitters
    session.upload("readings.csv", READINGS.encode())
    wait_for(session.take_upload)
    assert session.problem == ""
    wait_for(lambda: session.survey.latest is not None)
    found = session.survey.latest
    assert len(found.survey) == 10
    assert found.residual_db.mean() == pytest.approx(0.0, abs=1e-9)
    assert found.sigma_db == pytest.approx(found.residual_db.std())
    assert "10 readings" in survey_words(found)
    shown = MapFigure(FLAT, 1.2, on_move=print, on_drag=print, on_tap=print, on_step=print)
    (readings,) = [r for r in shown.model.renderers if "residual" in r.data_source.column_names]
    for server, names in ((SOURCE, {"east", "west"}), ("east", {"east"})):
        shown.show_survey(found, server)
        assert set(readings.data_source.data["tx"]) == names
    shown.show_survey(None, SOURCE)
    assert readings.data_source.data["x"] == []
    session.open_builtin("flat")
    assert session.survey.survey is None


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (READINGS.replace("west", "north"), "north"),
        (READINGS.replace("9,2,1.2", "nan,2,1.2"), "row 2"),
        ("hello", "survey.csv"),
    ],
)
def test_a_wrong_survey_is_refused(with_transmitters, text, says) -> None:
    session = with_transmitters
    session.upload("survey.csv", text.encode())
    wait_for(session.take_upload)
    assert says in session.problem
    assert "/" not in session.problem.replace(" / ", "")
    assert session.survey.survey is None


def test_a_survey_needs_a_plan_with_transmitters(session) -> None:
    session.upload("survey.csv", READINGS.encode())
    wait_for(session.take_upload)
    assert "has no [[transmitters]]" in session.problem


def test_an_uploaded_plan_reads_no_pattern_of_the_server(tmp_path) -> None:
    secret = tmp_path / "pattern.csv"
    secret.write_text("secret")
    transmitter = PlanTransmitter("x", (9.6, 1.4, 1.5), antenna=str(secret))
    session = Session(replace(FLAT, name="own", transmitters=(transmitter,)), cache=CACHE)
    session.change_settings(replace(COARSE.with_preset("building"), max_reflections=2))
    session.choose_server("x")
    wait_for_map(session)
    assert (
        session.complete_map.radio_map.transmitter.antenna
        == session.settings.receive_antenna.antenna
    )
    session.close()


def test_the_example_opens_with_its_survey() -> None:
    session = Session(FLAT, cache=CACHE)
    session.settings = replace(COARSE, cell_size_m=2.0)
    session.open_example()
    assert session.settings.preset == "building"
    assert len(session.survey.survey) == 660
    session.close()
