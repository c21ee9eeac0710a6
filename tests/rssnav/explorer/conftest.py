"""A server of the explorer and a browser, for the tests that need them."""

from __future__ import annotations

from collections.abc import Iterator

import pytest


@pytest.fixture(scope="session")
def address() -> Iterator[str]:
    """A server on any free port, in a process of its own."""
    from explorer_browser import serving

    with serving() as started:
        yield started


@pytest.fixture(scope="session")
def browser() -> Iterator[object]:
    from explorer_browser import chromium

    with chromium() as opened:
        yield opened
