"""The explorer in a real browser: everything one can do with it, once."""

from __future__ import annotations

import http.client
import re
import socket
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import h5py
import pytest

import floorplans

pytest.importorskip("playwright")
pytest.importorskip("panel")

from explorer_browser import NEEDS_BROWSER, PATIENCE_MS, PHONE, Tab
from playwright.sync_api import Error, expect

SOURCE = (1.2, 7.9)
pytestmark = NEEDS_BROWSER


@pytest.fixture(scope="module")
def opened(browser, address) -> Iterator[Tab]:
    tab = Tab(browser, address)
    yield tab
    tab.context.close()


@pytest.fixture
def tab(opened, address, tmp_path, request) -> Iterator[Tab]:
    """A tab that tests share; each leaves a picture, and must not have asked elsewhere."""
    yield opened
    opened.page.screenshot(path=tmp_path / f"{request.node.name}.png")
    assert opened.errors == []
    local = (address, "blob:", "data:", "about:")
    assert [url for url in opened.requests if not url.startswith(local)] == []


def test_hover_tells_rss_and_paths(tab) -> None:
    x, y = tab.place(10.5, 1.5)
    tab.page.mouse.move(x - 40, y)
    tab.page.mouse.move(x + 30, y)
    tab.page.get_by_text(re.compile(r"^-\d+\.\d dBm$")).wait_for()


def test_drag_source_and_start(tab) -> None:
    start_x = tab.marks()[1]
    tab.drag(SOURCE, (2.5, 2.5))
    tab.wait_for_map()
    tab.wait_for_marks(lambda source, start: abs(source - 2.5) <= 0.1 and start == start_x)
    tab.drag((start_x, 1.5), (9.4, 7.7))
    tab.wait_for_marks(lambda source, start: start == 9.5)  # the cell's centre
    tab.drag((9.5, 7.5), (30.0, 7.5))
    tab.wait_for_marks(lambda source, start: start == 11.5)  # on the floor, however far it went
    tab.drag((2.5, 2.5), SOURCE)
    tab.wait_for_map()


def test_click_a_cell_for_its_paths(tab, tmp_path) -> None:
    tab.page.mouse.click(*tab.place(9.5, 6.5))
    tab.page.get_by_text("(9.5, 6.5, 2) m").wait_for()
    expect(tab.page.get_by_role("row")).to_have_count(13)
    space, plan = (tab.page.get_by_role("button", name=name, exact=True) for name in ("3D", "2D"))
    space.click()
    frame = tab.page.frame_locator("iframe[title='3D']")
    frame.get_by_text("flat: paths to (9.5, 6.5, 2) m").wait_for()
    frame.locator("canvas").wait_for()
    tab.page.wait_for_timeout(500)
    tab.page.screenshot(path=tmp_path / "space.png")
    plan.click()


def test_train_watch_stop_and_play(tab) -> None:
    tab.choose("Training")
    tab.page.get_by_label("Episodes per second").select_option("50")
    tab.page.get_by_role("button", name="Location").click()
    train, stop = (tab.page.get_by_role("button", name=name) for name in ("Train", "Stop"))
    train.click()
    tab.page.get_by_text(re.compile(r"^[1-9]\d* of 1000$")).wait_for()
    stop.click()
    tab.page.get_by_text(re.compile(r"^Episode \d+ of 1000: step")).wait_for()
    expect(train).to_be_enabled()
    before = tab.columns("Line")
    tab.page.locator("button.first:visible").click()
    tab.page.get_by_text(re.compile(r"^Episode 1 of 1000: step 0 of")).wait_for()
    tab.page.locator("button.play:visible").click()
    tab.page.get_by_text(re.compile(r"^Episode 2 of 1000")).wait_for()
    assert tab.columns("Line") != before
    tab.page.locator("button.pause:visible").click()


SPACE = """() => ({
    counts: uavs.map(({ flown }) => flown.count),
    at: uavs.map(({ body }) => [body.position.x, -body.position.z, body.position.y]),
    ends: uavs.map(({ points }) => [points.at(-1).x, -points.at(-1).z, points.at(-1).y]),
})"""
"""What is drawn of the flights in 3D, in the axes of the plan [m]."""


BELIEF = """() => {
    const box = new THREE.Box3().setFromObject(belief), { image } = belief.material.map;
    return {
        cells: [image.width, image.height], corners: [box.min.x, -box.max.z, box.max.x, -box.min.z],
        map: scene.getObjectByName("map").visible,
        mapBar: !document.getElementById("colour-bar").hidden,
    };
}"""
"""The belief that is drawn in 3D, corners in the axes of the plan [m], and what it replaces."""


def space_of(tab: Tab, n_flights: int) -> dict:
    """What the frame in 3D shows, once it has so many flights."""
    for _ in range(PATIENCE_MS // 250):
        with suppress(Error):  # a new map or other paths come with a new frame
            frame = tab.page.locator("iframe[title='3D']").element_handle().content_frame()
            ready = f"typeof uavs != 'undefined' && uavs.length == {n_flights}"
            if frame and frame.evaluate(ready):
                return frame.evaluate(SPACE)
        tab.page.wait_for_timeout(250)
    raise AssertionError(f"the view does not show {n_flights} flights")


def test_flights_play_in_three_dimensions_too(tab) -> None:
    start = tab.marks()[1]
    tab.choose("Training")
    tab.page.get_by_label("Episodes per second").select_option("no limit")
    tab.page.get_by_role("button", name="Train").click()
    tab.page.get_by_text(re.compile(r"^Learned in \d+ episodes: step (\d+) of \1")).wait_for()
    tab.page.get_by_role("button", name="3D", exact=True).click()
    shown = space_of(tab, 1)
    assert shown["at"] == shown["ends"]
    assert shown["at"][0][2] == pytest.approx(2.0)  # the receivers' height
    tab.page.get_by_role("button", name="Play learned flight").click()
    tab.page.get_by_text(re.compile(r"^Learned in \d+ episodes: step [0-5] of")).wait_for()
    tab.page.locator("button.pause:visible").click()
    tab.page.wait_for_timeout(500)
    words = tab.page.get_by_text(re.compile(r"^Learned in \d+ episodes")).inner_text()
    step = int(re.search(r"step (\d+) of", words).group(1)) + 1
    tab.page.locator("button.next:visible").click()
    tab.page.get_by_text(re.compile(rf"^Learned in \d+ episodes: step {step} of")).wait_for()
    tab.page.wait_for_timeout(500)
    shown = space_of(tab, 1)
    assert shown["counts"] == [step]
    assert shown["at"] != shown["ends"]
    tab.page.locator("button.first:visible").click()
    tab.page.get_by_text(re.compile(r"^Episode 1 of 1000: step 0 of")).wait_for()
    tab.page.wait_for_timeout(500)
    shown = space_of(tab, 1)
    assert shown["counts"] == [0]
    assert shown["at"][0][0] == pytest.approx(start)
    tab.choose("Setup")
    space_of(tab, 0)
    tab.page.get_by_role("button", name="2D", exact=True).click()


def test_two_searchers_fly_side_by_side(tab) -> None:
    tab.choose("Search")
    tab.page.get_by_label("Compared with").select_option("Frontier")
    tab.page.get_by_role("button", name="Fly").click()
    ended = tab.page.get_by_text(re.compile(r"^found, \d+ steps, [\d.]+ kJ$"))
    ended.nth(1).wait_for()
    tab.page.get_by_text(re.compile(r"Frontier: step (\d+) of \1$")).wait_for()
    tab.page.locator("button.first:visible").click()
    tab.page.get_by_text(re.compile(r"Frontier: step 0 of")).wait_for()
    tab.page.get_by_role("button", name="3D", exact=True).click()
    assert space_of(tab, 2)["counts"] == [0, 0]
    tab.page.wait_for_timeout(500)
    frame = tab.page.locator("iframe[title='3D']").element_handle().content_frame()
    drawn = frame.evaluate(BELIEF)
    assert drawn["cells"] == [12, 9]
    assert drawn["corners"] == pytest.approx([0.0, 0.0, 12.0, 9.0])
    assert not drawn["map"]
    assert not drawn["mapBar"]
    tab.page.get_by_label("Belief of").select_option("none")
    frame.wait_for_function("belief == null && scene.getObjectByName('map').visible")
    tab.page.get_by_role("button", name="2D", exact=True).click()
    tab.choose("Help")
    expect(tab.page.locator("button.first:visible")).to_have_count(0)


def test_download_map_figures_and_plan(tab, tmp_path) -> None:
    tab.choose("Files")
    for label, name in (
        ("Map (HDF5)", "flat.h5"),
        ("Figure (PNG)", "flat.png"),
        ("Figure (SVG)", "flat.svg"),
        ("Plan (TOML)", "flat.toml"),
    ):
        with tab.page.expect_download() as download:
            tab.page.get_by_text(label).click()
        assert download.value.suggested_filename == name
        download.value.save_as(tmp_path / name)
    with h5py.File(tmp_path / "flat.h5") as file:
        assert file["rss_dbm"].shape == (9, 12)
    assert floorplans.load(tmp_path / "flat.toml").walls == floorplans.load("flat").walls
    assert (tmp_path / "flat.png").read_bytes().startswith(b"\x89PNG")
    assert "<svg" in (tmp_path / "flat.svg").read_text(encoding="utf-8")


def test_upload_a_plan_and_choose_another(tab, tmp_path) -> None:
    text = floorplans.dumps(floorplans.load("flat"))
    tab.choose("Setup")
    for name, content, says in (
        ("bad.toml", "name = ", "bad.toml: not valid TOML"),
        ("mine.toml", text.replace('"flat"', '"my flat"'), "my flat"),
    ):
        Path(tmp_path / name).write_text(content, encoding="utf-8")
        tab.page.locator("input[type=file]").set_input_files(tmp_path / name)
        tab.page.locator(".bar, .status").get_by_text(says).first.wait_for()
    tab.wait_for_map()
    tab.page.get_by_label("Cell size [m]").fill("2")
    tab.page.get_by_label("Cell size [m]").press("Enter")
    tab.page.get_by_text(re.compile("^24 cells")).wait_for()
    tab.page.get_by_label("Cell size [m]").fill("1")
    tab.page.get_by_label("Cell size [m]").press("Enter")
    tab.page.get_by_label("Floor plan", exact=True).select_option("flat")
    tab.page.locator(".bar b").get_by_text("flat", exact=True).wait_for()
    tab.wait_for_map()


def test_second_tab_on_a_phone_is_on_its_own(tab, browser, address, tmp_path) -> None:
    phone = Tab(browser, address, PHONE)
    phone.drag(SOURCE, (8.5, 2.5))
    phone.wait_for_map()
    phone.page.mouse.click(*phone.place(9.5, 6.5))
    phone.page.get_by_text("(9.5, 6.5, 2) m").wait_for()
    phone.page.screenshot(path=tmp_path / "phone.png", full_page=True)
    phone.page.get_by_role("button", name="3D", exact=True).click()
    key = phone.page.frame_locator("iframe[title='3D']").locator("#key")
    key.get_by_text("plasterboard").wait_for(state="hidden")  # folded, to leave the view free
    key.locator("summary").click()
    key.get_by_text("plasterboard").wait_for(state="visible")
    phone.choose("Training")
    width = phone.page.evaluate("document.documentElement.scrollWidth")
    phone.page.screenshot(path=tmp_path / "phone-training.png", full_page=True)
    phone.wait_for_marks(lambda source, start: abs(source - 8.5) <= 0.1)
    tab.wait_for_marks(lambda source, start: abs(source - SOURCE[0]) <= 0.1)
    phone.context.close()
    assert width <= PHONE["width"]


def test_only_this_computer_and_this_page_are_served(address) -> None:
    port = int(address.rsplit(":", 1)[1].strip("/"))
    with pytest.raises(ConnectionRefusedError):
        socket.create_connection(("127.0.0.2", port), timeout=5)
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=5)
    headers = {
        "Connection": "Upgrade",
        "Upgrade": "websocket",
        "Origin": "http://elsewhere.example",
        "Sec-WebSocket-Version": "13",
        "Sec-WebSocket-Key": "AAAAAAAAAAAAAAAAAAAAAA==",
    }
    connection.request("GET", "/ws", headers=headers)
    assert connection.getresponse().status == 403
    connection.close()
