"""How long-running experiments report to their caller."""

from __future__ import annotations

from collections.abc import Callable

StageProgress = Callable[[str, int, int], None]
"""Called as ``progress(stage, done, total)``; a stage is done when ``done == total``."""

Notice = Callable[[str], None]
"""Called with a sentence for the user."""


def ignore(*_: object) -> None:
    """Discard a progress report or a notice."""
