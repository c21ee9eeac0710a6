"""A session that is saved and opened again, also one that a stranger has written."""

from __future__ import annotations

import json
import time
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

import floorplans
from floorplans import PlanError
from rssnav.explorer.antenna_choice import AntennaChoice
from rssnav.explorer.import_worker import read_session
from rssnav.explorer.limits import Limits
from rssnav.explorer.map_settings import MapSettings
from rssnav.explorer.session import Session
from rssnav.explorer.session_file import SavedSession
from rssnav.explorer.survey_layer import example
from rssnav.explorer.tracing import MapCache
from rssnav.explorer.training import TrainingSettings
from rssnav.explorer.uploads import read_upload
from rssnav.learning_parameters import QLearning

FLAT = floorplans.load("flat")
CACHE = MapCache()
PATIENCE_S = 60.0
COARSE = MapSettings(cell_size_m=1.5, max_reflections=1)
FULL = SavedSession(
    floorplans.dumps(FLAT),
    replace(
        COARSE,
        max_transmissions=None,
        frequency_hz=5.2e9,
        transmit_antenna=AntennaChoice("patch", 30.0, -10.0),
    ),
    (2.25, 3.75),
    TrainingSettings("location", 2, 300, 7, learning=QLearning(gamma=0.9, initial_q=5.0)),
    "tx,x,y,z,rss_dbm\n",
)


def wait_for(condition) -> None:
    ends_s = time.monotonic() + PATIENCE_S
    while not condition():
        assert time.monotonic() < ends_s, "waited in vain"
        time.sleep(0.005)


@pytest.fixture
def session() -> Iterator[Session]:
    opened = Session(FLAT, cache=CACHE)
    opened.change_settings(COARSE)
    wait_for(lambda: opened.complete_map is not None)
    yield opened
    opened.close()


def opened_again(content: bytes) -> Session:
    """A new session into which a file is dropped, once its map is complete."""
    fresh = Session(FLAT, cache=CACHE)
    fresh.upload("mine.rssnav", content)
    wait_for(fresh.take_upload)
    return fresh


@pytest.mark.parametrize(
    "saved", [FULL, SavedSession(FULL.plan, MapSettings().with_preset("building"))]
)
def test_what_is_written_is_read(saved) -> None:
    assert SavedSession.loads(saved.dumps()) == saved


def test_a_session_goes_on_where_it_was(session) -> None:
    session.change(replace(COARSE, power_dbm=20.0), (3.0, 7.0, 1.0), (9.75, 2.25))
    assert session.problem == ""
    wait_for(lambda: session.complete_map is not None)
    session.choose_cell(6.1, 4.4)
    session.train(TrainingSettings(episodes=60, seed=5, goal_rss_dbm=-45.0))
    session.training.join(PATIENCE_S)
    again = opened_again(session.saved().dumps().encode())
    assert again.problem == ""
    assert (again.plan, again.settings) == (session.plan, session.settings)
    wait_for(lambda: again.resume() or again.training is not None)
    again.training.join(PATIENCE_S)
    assert again.cell == session.cell
    np.testing.assert_array_equal(again.training.steps, session.training.steps)
    for flown, before in zip(again.training.flights, session.training.flights, strict=True):
        np.testing.assert_array_equal(flown.position, before.position)
    assert again.saved() == session.saved()
    again.close()


def test_a_change_before_the_map_is_there_cancels_what_would_follow(session) -> None:
    again = opened_again(replace(FULL, settings=COARSE, survey=None).dumps().encode())
    again.change_settings(replace(again.settings, power_dbm=3.0))
    wait_for(lambda: again.complete_map is not None)
    again.resume()
    assert again.training is None
    assert again.cell is None
    again.close()


def test_a_survey_is_saved_with_its_session() -> None:
    plan, file = example()
    saved = SavedSession(floorplans.dumps(plan), replace(COARSE, cell_size_m=2.0), None, None)
    fresh = opened_again(replace(saved, survey=file.text).dumps().encode())
    assert fresh.problem == ""
    assert len(fresh.survey.survey) == 660
    assert fresh.saved().survey == file.text
    fresh.close()


def leaves(value: object, path: tuple[str, ...] = ()) -> Iterator[tuple[str, ...]]:
    """Keys that lead to every value of a file, tables included."""
    if path:
        yield path
    if isinstance(value, dict):
        for key, part in value.items():
            yield from leaves(part, (*path, key))


WRONG = (
    True, "x", -1e9, 1e308, 10**40, 0.5, [], {}, [1], "\0" * 100, "\ud800", 10**5000, "../flat",
)  # fmt: skip
PATHS = list(leaves(json.loads(FULL.dumps())))


@pytest.mark.parametrize("path", PATHS, ids=".".join)
def test_a_wrong_value_is_refused_by_its_key_or_within_the_ranges(path) -> None:
    for value in (*WRONG, None, ...):
        table = json.loads(FULL.dumps())
        inner = table
        for key in path[:-1]:
            inner = inner[key]
        if value is ...:
            del inner[path[-1]]
        else:
            inner[path[-1]] = value
        try:
            read = SavedSession.loads(json.dumps(table))
        except ValueError as error:
            told = str(error)
        else:
            told = f"{path[0]} is accepted as it is" * (SavedSession.loads(read.dumps()) == read)
        assert path[0] in told or "digits" in told
        assert len(told) < 300


REFUSED = {
    "empty": (b"", "not valid JSON"),
    "deep": (b"[" * 100_000, "recursion|JSON"),
    "no text": (b"\xff\xfe", "utf-8"),
    "a list": (b"[1, 2]", "expected a table"),
    "another format": (b'{"format": "another"}', "format: 'another' must be"),
    "not a number": (FULL.dumps().replace("5.2", "NaN").encode(), "NaN is no number"),
    "unknown key": (FULL.dumps().replace('"x_m"', '"z_m": 1, "x_m"').encode(), "'cell.z_m'"),
    "no plan": (replace(FULL, plan="name = ").dumps().encode(), "Invalid value"),
    "a file to follow": (
        replace(FULL, plan='include = "/etc/hostname"\n' + FULL.plan).dumps().encode(), "include",
    ),
    "large": (b" " * 5_000_000, "at most 4000000"),
}  # fmt: skip


@pytest.mark.parametrize(("content", "says"), REFUSED.values(), ids=REFUSED)
def test_the_process_that_reads_uploads_refuses(content, says, tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "evil.rssnav").write_bytes(content)
    with pytest.raises((ValueError, RecursionError), match=says):
        read_session(tmp_path / "evil.rssnav", Limits())


@pytest.mark.parametrize(
    ("saved", "says"),
    [
        (replace(FULL, plan="name = "), "evil.rssnav: not valid TOML"),
        (replace(FULL, survey="tx,x\n"), "has no [[transmitters]]"),
    ],
    ids=["plan", "survey"],
)
def test_a_file_that_is_refused_leaves_the_session(session, saved, says) -> None:
    before = session.plan, session.settings, session.maps.latest
    session.upload("evil.rssnav", saved.dumps().encode())
    wait_for(session.take_upload)
    assert says in session.problem
    assert (session.plan, session.settings, session.maps.latest) == before


@pytest.mark.parametrize(
    ("settings", "says"),
    [
        (replace(COARSE, cell_size_m=0.05), "cells of at least"),
        (replace(COARSE, height_m=500.0), "the ceiling's"),
        (replace(COARSE, server="nobody"), "map.transmitter"),
    ],
)
def test_settings_that_do_not_fit_the_plan_leave_the_session(session, settings, says) -> None:
    before = session.plan, session.settings, session.maps.latest
    with pytest.raises(PlanError, match=says):
        session.open_saved(SavedSession(FULL.plan, settings), FLAT)
    assert (session.plan, session.settings, session.maps.latest) == before


def test_a_plan_in_a_session_has_the_limits_of_any_upload() -> None:
    corners = [[k % 7, k] for k in range(20_000)]
    enormous = f"name = 'x'\nheight_m = 3\noutline = {corners}\n"
    for name, content in (
        ("outline.toml", enormous),
        ("outline.rssnav", replace(FULL, plan=enormous).dumps()),
    ):
        with pytest.raises(PlanError, match="20000 corners of the outline"):
            read_upload(name, content.encode(), Limits())
