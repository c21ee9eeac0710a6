"""The page as a person sees it, at the sizes of a desktop and a phone: layout, contrast, keys."""

from __future__ import annotations

import numpy as np
import pytest

pytest.importorskip("playwright")
pytest.importorskip("panel")

from explorer_browser import DESKTOP, FRAME, NEEDS_BROWSER, PHONE, Tab
from explorer_looks import CONTRAST, FOCUSED, LAYOUT

pytestmark = NEEDS_BROWSER
MOST_STOPS = 60
MOST_GAP_PX = 8
PATHS_OF = "(6.5, 4.5, 2) m"


@pytest.fixture(scope="module", params=[DESKTOP, PHONE], ids=["desktop", "phone"])
def tab(request, browser, address):
    tab = Tab(browser, address, request.param)
    yield tab
    tab.context.close()


def faults(tab: Tab) -> list[str]:
    tab.page.wait_for_timeout(300)
    return [*tab.page.evaluate(LAYOUT), *tab.page.evaluate(CONTRAST)]


def click_cell(tab: Tab, x: float, y: float) -> None:
    """Click a cell of the map, which may be above what is scrolled to."""
    tab.page.evaluate("scrollTo(0, 0)")
    tab.page.mouse.click(*tab.place(x, y))


def focused(tab: Tab) -> dict:
    return tab.page.evaluate(FOCUSED)


def test_nothing_is_cut_overlaps_or_is_hard_to_read(tab, tmp_path) -> None:
    """A cell has paths and an error is shown, so that these are looked at too."""
    tab.page.get_by_label("Source x [m]").fill("500")
    tab.page.get_by_label("Source x [m]").press("Enter")
    tab.page.get_by_text("outside the outline").wait_for()
    found = {"refused": faults(tab)}
    tab.page.get_by_label("Source x [m]").fill("1.2")
    tab.page.get_by_label("Source x [m]").press("Enter")
    tab.wait_for_map()
    click_cell(tab, 6.5, 4.5)
    tab.page.get_by_text(PATHS_OF).wait_for()
    for name in ("Setup", "Paths", "Training", "Search", "Files", "Help"):
        tab.choose(name)
        found[name] = faults(tab)
        tab.page.screenshot(path=tmp_path / f"{name}.png", full_page=True)
    tab.choose("Paths")
    tab.page.get_by_role("button", name="Phase and angles").click()
    tab.page.get_by_text("departure").first.wait_for()
    found["angles"] = faults(tab)
    tab.choose("Training")
    tab.page.get_by_text("Parameters of Q-learning").click()
    found["parameters"] = faults(tab)
    assert not {name: wrong for name, wrong in found.items() if wrong}


def test_axes_are_at_the_plan(tab) -> None:
    """The frame, at whose edges the axes are, fits the plan when the map has less room too."""
    tab.choose("Setup")
    for opened in ("Setup", "Training"):
        tab.choose(opened)
        tab.page.wait_for_timeout(500)
        tab.page.evaluate("scrollTo(0, 0)")
        left, top, right, bottom = tab.page.evaluate(FRAME)
        corners = np.array([tab.place(0.0, 0.0), tab.place(12.0, 9.0)])
        (x0, y1), (x1, y0) = corners
        gaps = np.array([x0 - left, y0 - top, right - x1, bottom - y1])
        assert gaps.min() >= 0.0
        assert gaps.max() <= MOST_GAP_PX


def test_tab_leads_through_every_control_in_the_order_of_the_page(tab) -> None:
    tab.choose("Setup")
    tab.page.evaluate("document.activeElement.blur()")
    tab.page.locator("h1").click()
    stops = []
    for _ in range(MOST_STOPS):
        tab.page.keyboard.press("Tab")
        if not (stop := focused(tab)) or stop["label"] in [known["label"] for known in stops]:
            break
        stops.append(stop)
    labels = [stop["label"] for stop in stops]
    assert all(stop["ring"] for stop in stops), stops
    order = [
        "2D", "3D", "Map: arrow keys choose a cell, Enter shows its paths",
        "Drag source and start", "Setup", "Paths", "Training", "Search", "Files", "Help",
        "Floor plan", "Browse", "Source x [m]", "Source y [m]", "Source z [m]", "Start x [m]",
        "Start y [m]", "Preset", "Cell size [m]", "Receiver height [m]", "Reflections",
        "Transmissions", "Power [dBm]", "Frequency [GHz]", "Transmit antenna", "Receive antenna",
        "Transmit azimuth [\u00b0]", "Receive elevation [\u00b0]",
    ]  # fmt: skip
    assert [label for label in labels if label in order] == order


def test_arrows_choose_a_cell_and_enter_shows_its_paths(tab) -> None:
    tab.choose("Setup")
    click_cell(tab, 6.5, 4.5)
    tab.page.get_by_text(PATHS_OF).wait_for()
    tab.choose("Setup")
    tab.page.locator(".view").focus()
    for key in ("ArrowLeft", "ArrowUp", "ArrowRight", "ArrowRight", "ArrowDown", "ArrowDown"):
        tab.page.keyboard.press(key)
    tab.page.keyboard.press("Enter")
    tab.page.get_by_text("(7.5, 3.5, 2) m").wait_for()
    click_cell(tab, 6.5, 4.5)
    tab.page.get_by_text(PATHS_OF).wait_for()
    tab.page.keyboard.press("ArrowDown")  # the map has the focus after a click
    tab.page.get_by_text("(6.5, 3.5, 2) m").wait_for()
    tab.choose("Setup")
    tab.page.locator(".bk-tab", has_text="Files").focus()
    tab.page.keyboard.press("Enter")
    tab.page.get_by_text("Map (HDF5)").wait_for()
