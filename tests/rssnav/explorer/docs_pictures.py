"""Take the pictures of the explorer for the documentation, with Chromium.

``PYTHONPATH=tests/helpers python tests/rssnav/explorer/docs_pictures.py`` writes them to
docs/images.
"""

from __future__ import annotations

import re
from pathlib import Path

from explorer_browser import DESKTOP, PHONE, Tab, chromium, serving

IMAGES = Path(__file__).resolve().parents[3] / "docs" / "images"
SETTLED_MS = 3000


def take(tab: Tab, name: str) -> None:
    tab.page.mouse.move(1, 1)
    tab.page.wait_for_timeout(SETTLED_MS)
    tab.page.screenshot(path=IMAGES / f"{name}.png")


def train(tab: Tab) -> None:
    tab.choose("Training")
    tab.page.get_by_role("button", name="Train", exact=True).click()
    tab.page.get_by_text(re.compile("^Learned")).wait_for()


def search(tab: Tab) -> None:
    tab.choose("Search")
    tab.page.get_by_role("button", name="Fly", exact=True).click()
    tab.page.get_by_text(re.compile("^found")).nth(1).wait_for()


def main() -> None:
    with serving() as address, chromium() as browser:
        desktop = Tab(browser, address, DESKTOP)
        desktop.page.mouse.click(*desktop.place(6.5, 4.5))
        desktop.page.get_by_text("(6.5, 4.5, 2) m").wait_for()
        take(desktop, "explorer")
        search(desktop)
        take(desktop, "explorer_search")
        desktop.page.get_by_role("button", name="3D", exact=True).click()
        train(desktop)
        take(desktop, "explorer_flight")
        phone = Tab(browser, address, PHONE)
        train(phone)
        phone.page.mouse.wheel(0, -3000)
        take(phone, "explorer_phone")


if __name__ == "__main__":
    main()
