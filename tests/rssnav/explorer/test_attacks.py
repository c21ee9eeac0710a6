"""A script attacks the explorer over HTTP and its websocket; other tabs and the server live on."""

from __future__ import annotations

import json
import signal
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from urllib.error import HTTPError

import pytest

pytest.importorskip("panel")
pytest.importorskip("tornado")

from explorer_client import WITH_FEW_PAGES, Client, Server, clients, running_server
from tornado.httpclient import HTTPClientError

import floorplans

Make = Callable[[], Client]
HUGE = 10**4000
NOT_A_NUMBER = {"type": "number", "value": "nan"}
INFINITE = {"type": "number", "value": "+inf"}


@pytest.fixture(scope="module")
def server(tmp_path_factory) -> Iterator[Server]:
    with running_server(tmp_path_factory.mktemp("server") / "log.txt") as running:
        yield running
        log = running.log.read_text(encoding="utf-8")
        assert "Traceback" not in log, log


@pytest.fixture
def make(server) -> Iterator[Make]:
    with clients(server) as function:
        yield function


@pytest.fixture(scope="module")
def tab(server) -> Iterator[Client]:
    """A tab that tests share: nothing that they send ends it."""
    with clients(server) as function:
        yield function().open().wait_for_map()


def test_pages_without_a_browser_trace_nothing_and_are_forgotten(server) -> None:
    server.get()
    time.sleep(4.0)
    threads, memory_bytes = server.n_threads, server.memory_bytes
    for _ in range(100):
        server.get()
    assert server.n_threads <= threads
    time.sleep(4.0)
    assert server.memory_bytes < memory_bytes + 30_000_000


@pytest.mark.parametrize(
    ("label", "value", "says"),
    [
        ("Reflections", 20, "0 to 8"),
        ("Reflections", -1, "0 to 8"),
        ("Reflections", HUGE, "0 to 8"),
        ("Cell size [m]", 1e-9, "0.05 to 1000"),
        ("Cell size [m]", 0.05, "cells of at least"),
        ("Receiver height [m]", -1.0, "0.01 to 1000"),
        ("Receiver height [m]", 2.6, "below 2.6 m"),
        ("Source x [m]", 1e300, "-1e+06 to 1e+06"),
        ("Source y [m]", 8000.0, "outside the outline"),
        ("Source z [m]", -1e300, "0.01 to 1000"),
        ("Start x [m]", INFINITE, "-1e+06 to 1e+06"),
        ("Transmit azimuth [\u00b0]", 1e9, "-180 to 360"),
        ("Receive elevation [\u00b0]", -91.0, "-90 to 90"),
        ("Power [dBm]", INFINITE, "-50 to 60"),
        ("Frequency [GHz]", 1e308, "1 to 100"),
    ],
)
def test_numbers_out_of_range_are_refused(tab, label, value, says) -> None:
    before = tab.models[tab.input(label)]["value"]
    tab.change(tab.input(label), "value", value)
    tab.until(lambda: says in tab.texts)
    tab.change(tab.input(label), "value", before)
    tab.until(lambda: says not in tab.texts)


def test_values_of_other_types_change_nothing(tab) -> None:
    empty_map = {"type": "map", "entries": []}
    for label in ("Reflections", "Cell size [m]", "Power [dBm]"):
        before = tab.models[tab.input(label)]["value"]
        for value in ("8", True, [1], empty_map, "x" * 50_000, NOT_A_NUMBER):
            tab.change(tab.input(label), "value", value)
        tab.change(tab.input(label), "value", before)
    tab.still_works()


def test_a_widget_with_changed_limits_is_refused_all_the_same(tab) -> None:
    reflections = tab.input("Reflections")
    tab.change(reflections, "end", 50)
    tab.change(reflections, "value", 20)
    tab.until(lambda: "0 to 8" in tab.texts)
    tab.change(reflections, "value", 3)
    tab.until(lambda: "0 to 8" not in tab.texts)


def test_unknown_options_of_a_select_change_nothing(tab) -> None:
    for value in ("no such plan", "/etc/passwd", "../flat", 7, None, ["flat"]):
        tab.change(tab.input("Floor plan"), "value", value)
    tab.still_works()


def test_taps_and_drags_to_nowhere_change_nothing(tab) -> None:
    plot = tab.plan_figure
    for value in (HUGE, NOT_A_NUMBER, INFINITE, "x", None, [], 1e300):
        for name in ("panstart", "pan", "panend", "tap"):
            tab.event(name, {"model": {"id": plot}, "x": value, "y": value, "sx": 1, "sy": 1})
        for model_id, model in list(tab.models.items()):
            if "marker" in str(model.get("data", "")):
                tab.change(model_id, "data", {"type": "map", "entries": [["x", [value, value]]]})
    tab.still_works()


def test_players_and_buttons_take_anything(make) -> None:
    tab = make().open().wait_for_map()
    for value in (HUGE, -5, NOT_A_NUMBER, "x", None):
        send_to_players_and_buttons(tab, value)
    tab.still_works()


def send_to_players_and_buttons(tab: Client, value: object) -> None:
    for kind in ("Player", "Slider", "RadioButtonGroup", "Tabs", "FileDownload"):
        for model_id, model in list(tab.models.items()):
            if model.get("type", "").endswith(kind):
                for attribute in ("value", "active", "clicks"):
                    tab.change(model_id, attribute, value)
    tab.receive(0.3)


def clicks(model_id: str, count: int) -> dict[str, object]:
    """Content of a message with many clicks of a button."""
    values = {"type": "map", "entries": [["model", {"id": model_id}]]}
    data = {"type": "event", "name": "button_click", "values": values}
    click = {"kind": "MessageSent", "msg_type": "bokeh_event", "msg_data": data}
    return {"events": [click] * count}


def test_thousands_of_events_leave_other_tabs_their_turn(server, tab, make) -> None:
    attacker = make().open().wait_for_map()
    threads, memory_bytes = server.n_threads, server.memory_bytes
    train, keys = attacker.find("Button", "label", "Train"), attacker.find("", "name", "keys")
    plot = attacker.plan_figure
    for number in range(10):
        attacker.send("PATCH-DOC", clicks(train, 100))
        for k in range(50):
            place = {"x": k % 12 + 0.5, "y": number % 9 + 0.5, "sx": 1, "sy": 1}
            attacker.event("tap", {"model": {"id": plot}, **place})
            steps = [["right", [k % 3 - 1]], ["up", [1]], ["count", [k]]]
            attacker.change(keys, "data", {"type": "map", "entries": steps})
        tab.still_works()
    assert server.n_threads < threads + 50  # of 1 500 events
    assert server.memory_bytes < memory_bytes + 100_000_000


def test_a_click_right_after_a_change_finds_the_page_locked(server, make) -> None:
    """As of somebody who is quick; the log has no change that failed."""
    quick = make().open().wait_for_map()
    plot = quick.plan_figure
    tabs = next(k for k, m in quick.models.items() if m.get("type", "").endswith("Tabs"))
    quick.event("tap", {"model": {"id": plot}, "x": 6.5, "y": 4.5, "sx": 1, "sy": 1})
    quick.until(lambda: "(6.5, 4.5, 2) m" in quick.texts)
    turned = {"kind": "ModelChanged", "model": {"id": tabs}, "attr": "active", "new": 2}
    click = clicks(quick.find("Button", "label", "Train"), 1)["events"]
    for _ in range(3):
        quick.send("PATCH-DOC", {"events": [turned, *click]})
        quick.receive(0.5)
    quick.still_works()
    assert "document lock" not in server.log.read_text(encoding="utf-8")


def test_a_message_of_too_many_events_ends_its_tab_only(tab, make) -> None:
    attacker = make().open()
    attacker.send("PATCH-DOC", clicks(attacker.find("Button", "label", "Train"), 300))
    with pytest.raises(AssertionError, match="closed"):
        attacker.until(lambda: False)
    tab.still_works()


def test_keys_that_the_page_does_not_send_change_nothing(tab) -> None:
    keys = tab.find("", "name", "keys")
    for value in (HUGE, NOT_A_NUMBER, "x", None, [], 2, -1.0, True, [[1]]):
        for columns in ([["right", [value]], ["up", [value]]], [["right", value]], []):
            tab.change(keys, "data", {"type": "map", "entries": columns})
    tab.still_works()


def _patch(**event: object) -> list[str]:
    return ["{}", json.dumps({"events": [event]})]


MALFORMED = {
    "no JSON": ["{", "{}", "{}"],
    "binary": [b"\xff\x00"],
    "no header": ["[]", "{}", "{}"],
    "unknown kind": ['{"msgid": "1", "msgtype": "NONSENSE"}', "{}", "{}"],
    "a document": ['{"msgid": "1", "msgtype": "PUSH-DOC"}', "{}", '{"doc": {"roots": []}}'],
    "deep": ['{"msgid": "1", "msgtype": "PATCH-DOC"}', "{}", "[" * 50_000],
    "no events": ['{"msgid": "1", "msgtype": "PATCH-DOC"}', "{}", "{}"],
    "events of another type": ['{"msgid": "1", "msgtype": "PATCH-DOC"}', "{}", '{"events": 7}'],
    "a new root": [
        '{"msgid": "1", "msgtype": "PATCH-DOC"}',
        *_patch(kind="RootAdded", model={"type": "object", "name": "Div", "id": "z"}),
    ],
    "a stream": [
        '{"msgid": "1", "msgtype": "PATCH-DOC"}',
        *_patch(kind="ColumnsStreamed", model={"id": "p1"}, attr="data", data={}, rollover=None),
    ],
    "another property": [
        '{"msgid": "1", "msgtype": "PATCH-DOC"}',
        *_patch(kind="ModelChanged", model={"id": "p1"}, attr="stylesheets", new=[]),
    ],
    "a large property": [
        '{"msgid": "1", "msgtype": "PATCH-DOC"}',
        *_patch(kind="ModelChanged", model={"id": "p1"}, attr="value", new="x" * 100_000),
    ],
    "endless buffers": [
        '{"msgid": "1", "msgtype": "PATCH-DOC", "num_buffers": 1000000}',
        *_patch(kind="MessageSent", msg_type="bokeh_event", msg_data={}),
        *(part for _ in range(12) for part in ('{"id": "a"}', bytes(1_000_000))),
    ],
    "one large fragment": ["x" * 12_000_000],
}


def test_malformed_messages_end_no_other_tab(tab, make) -> None:
    for fragments in MALFORMED.values():
        attacker = make()
        attacker.connect()
        attacker.pull()
        attacker.send_until_closed(fragments)
        attacker.until(lambda attacker=attacker: attacker.closed or attacker.errors)
    tab.still_works()


def test_a_bad_token_opens_nothing(tab, make) -> None:
    for token in ("x", "a.b", "e30", "x" * 10_000):
        attacker = make()
        with pytest.raises(AssertionError, match="closed"):
            attacker.connect(token)
    tab.still_works()


@pytest.mark.parametrize(
    "origin",
    [
        "http://elsewhere.example",
        "null",
        "http://127.0.0.1:1",
        "http://127.0.0.1.elsewhere.example",
    ],
)
def test_websockets_of_other_pages_are_refused(make, origin) -> None:
    with pytest.raises(HTTPClientError, match="403"):
        make().connect(Origin=origin)


def test_a_slow_browser_finds_its_page(server, make) -> None:
    token = server.token()
    time.sleep(5.0)
    slow = make().open(token).wait_for_map()
    assert "https:" not in json.dumps(slow.models, default=str)  # no style sheet from elsewhere


WHOLE_TRACE_S = 40.0
"""Processor time at least of the trace that a tab leaves behind."""


def test_work_ends_with_its_tab(server, make) -> None:
    attacker = make().open().wait_for_map()
    attacker.change(attacker.input("Floor plan"), "value", "scenario2")
    attacker.change(attacker.input("Reflections"), "value", 8)
    attacker.change(attacker.input("Cell size [m]"), "value", 0.25)
    attacker.receive(1.0)
    attacker.close()
    closed_s = server.processor_s
    for _ in range(30):
        before_s = server.processor_s
        time.sleep(2.0)
        if server.processor_s - before_s < 0.5:
            break
    assert server.processor_s - closed_s < WHOLE_TRACE_S / 2.0


def test_a_tab_gets_its_turn_beside_greedy_ones(make) -> None:
    for _ in range(3):
        greedy = make().open()
        greedy.change(greedy.input("Floor plan"), "value", "scenario2")
    make().open().wait_for_map()


HOSTILE = ("NaN", "[" * 2000, "1" * 5000)


def test_hostile_sessions_are_refused_with_a_line(tab, make) -> None:
    attacker = make().open()
    for value in HOSTILE:
        text = f'{{"format": "rssnav explorer session", "version": 1, "plan": "", "map": {value}}}'
        attacker.upload("evil.rssnav", text.encode())
    attacker.until(lambda: "evil.rssnav" in attacker.texts)
    tab.still_works()


ENORMOUS = ", ".join(f"[{k % 7}, {k}]" for k in range(200_000))
UPLOADS = {
    "enormous outline": f"name = 'x'\nheight_m = 3\noutline = [{ENORMOUS}]\n".encode(),
    "courtyards": f"name = 'x'\nholes = [{', '.join(['[[0, 0], [1, 0]]'] * 100_000)}]".encode(),
    "dotted key": b"a" + b".a" * 3_000_000 + b" = 1",
    "deep": b"a = " + b"[" * 100_000,
    "many openings": (
        floorplans.dumps(floorplans.load("flat")).replace("[[walls]]", "", 1)
        + "\n[[walls]]\npoints = [[0, 0], [1, 0]]\nopenings = ["
        + '{ kind = "door", offset_m = 0, width_m = 1 }, ' * 5000
        + "]"
    ).encode(),
    "zeros": bytes(8_000_000),
}


def test_hostile_uploads_stop_nobody(tab, make) -> None:
    attacker = make().open()
    for content in UPLOADS.values():
        attacker.upload("evil.toml", content)
        tab.still_works()
    attacker.until(lambda: "evil.toml" in attacker.texts)


def refusal(server: Server) -> str:
    """Why the server refuses a page for now; empty where it does not."""
    try:
        server.get()
    except HTTPError as error:
        with error:
            return f"{error.code} {error.read().decode()}"
    return ""


def test_too_many_pages_and_connections_are_refused_for_a_while(tmp_path) -> None:
    with running_server(tmp_path / "log.txt", WITH_FEW_PAGES) as server, clients(server) as make:
        with ThreadPoolExecutor(20) as pool:
            refused = [text for text in pool.map(lambda _: refusal(server), range(20)) if text]
        assert refused
        assert all(text.startswith("503") and "then reload" in text for text in refused)
        time.sleep(5.0)  # until unused pages are forgotten
        token = server.token()
        for _ in range(5):
            make().connect(token)
        with pytest.raises(HTTPClientError, match="503"):
            make().connect(token)


@pytest.mark.parametrize("sent", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_the_server_at_once_with_one_line(sent: signal.Signals, tmp_path) -> None:
    with running_server(tmp_path / "log.txt") as server, clients(server) as make:
        make().open()  # its map is being traced
        server.process.send_signal(sent)
        sent_s = time.monotonic()
        assert server.process.wait(timeout=20.0) == 128 + sent
        assert time.monotonic() - sent_s < 5.0
        _, line = server.log.read_text(encoding="utf-8").splitlines()
        assert line.startswith("rssnav: interrupted")
