"""The explorer in a real browser: a server, and a page with what a person does on it."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import pytest

pytest.importorskip("playwright")

from playwright.sync_api import Browser, Error, sync_playwright

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("chrome")
FLAGS = (
    "--headless --no-sandbox --disable-gpu --disable-quic --no-first-run "
    "--disable-background-networking --disable-component-update --disable-sync"
)
PATIENCE_MS = 30_000
COMPLETE = re.compile(r"cells, .* paths, traced in [\d.]+ s$")
DESKTOP, PHONE = {"width": 1280, "height": 800}, {"width": 390, "height": 844}

NEEDS_BROWSER = pytest.mark.skipif(CHROMIUM is None, reason="there is no Chromium here")

MAP_VIEW = """
    const views = [...Bokeh.index.roots];
    for (const view of views) views.push(...(view.child_views ?? []));
    const map = views.find(
      (view) => view.model.type == "Figure" && view.model.renderers.length > 5);
"""
PLACE = f"""([x, y]) => {{ {MAP_VIEW}
    const box = map.canvas_view.el.getBoundingClientRect();
    return [box.left + map.frame.x_scale.compute(x), box.top + map.frame.y_scale.compute(y)];
}}"""
FRAME = f"""() => {{ {MAP_VIEW}
    const box = map.canvas_view.el.getBoundingClientRect(), frame = map.frame.bbox;
    return [box.left + frame.left, box.top + frame.top, box.left + frame.right,
      box.top + frame.bottom];
}}"""
"""Left, top, right and bottom of the map's frame in the window [px]."""

COLUMNS = f"""(glyph) => {{ {MAP_VIEW}
    const all = map.model.renderers.filter((renderer) => renderer.glyph.type == glyph);
    return all.map((renderer) => [...renderer.data_source.data.x ?? []]);
}}"""


@contextmanager
def serving() -> Iterator[str]:
    """Address of a server on any free port, in a process of its own."""
    command = [sys.executable, "-m", "rssnav", "explore", "flat", "--port", "0", "--no-browser"]
    server = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
    try:
        line = server.stderr.readline()
        yield re.search(r"http://\S+", line).group()
    finally:
        server.terminate()
        remarks = server.communicate(timeout=20)[1]
    assert "Traceback" not in remarks, remarks


@contextmanager
def chromium() -> Iterator[Browser]:
    """A browser without a window."""
    with sync_playwright() as library:
        opened = library.chromium.launch(executable_path=CHROMIUM, args=FLAGS.split())
        yield opened
        opened.close()


class Tab:
    """A page of the explorer, and what a person does on it."""

    def __init__(self, browser, address: str, viewport=DESKTOP) -> None:
        self.context = browser.new_context(viewport=viewport, accept_downloads=True)
        self.page = self.context.new_page()
        self.page.set_default_timeout(PATIENCE_MS)
        self.requests, self.errors = [], []
        self.page.on("request", lambda request: self.requests.append(request.url))
        self.page.on("pageerror", lambda error: self.errors.append(str(error)))
        for _ in range(20):
            try:
                self.page.goto(address)
                break
            except Error:
                self.page.wait_for_timeout(250)  # the address is told just before it is open
        self.wait_for_map()

    def wait_for_map(self) -> None:
        self.page.get_by_text(COMPLETE).wait_for()

    def place(self, x: float, y: float) -> list[float]:
        """Where a point of the plan [m] is in the window."""
        return self.page.evaluate(PLACE, [x, y])

    def columns(self, glyph: str) -> list[list[float]]:
        """The x of everything that a kind of glyph draws on the map."""
        return self.page.evaluate(COLUMNS, glyph)

    def marks(self) -> list[float]:
        """The x of source and start [m]."""
        return self.columns("Scatter")[-1]

    def wait_for_marks(self, holds: Callable[[float, float], bool]) -> None:
        """Wait until something holds for the x of source and start; the server may move them."""
        for _ in range(PATIENCE_MS // 100):
            if holds(*self.marks()):
                return
            self.page.wait_for_timeout(100)
        raise AssertionError(f"source and start stay at x = {self.marks()}")

    def drag(self, start: tuple[float, float], end: tuple[float, float]) -> None:
        (x, y), (to_x, to_y) = self.place(*start), self.place(*end)
        self.page.mouse.move(x, y)
        self.page.mouse.down()
        for share in (0.1, 0.4, 0.7, 1.0):
            self.page.mouse.move(x + share * (to_x - x), y + share * (to_y - y))
            self.page.wait_for_timeout(60)
        self.page.mouse.up()

    def choose(self, name: str) -> None:
        """Turn to a tab of the tools."""
        self.page.locator(".bk-tab").get_by_text(name, exact=True).click()

    def wait_until(self, expression: str) -> None:
        self.page.wait_for_function(expression)
