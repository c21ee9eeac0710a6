"""Progress of an import."""

from __future__ import annotations

from collections.abc import Callable

Progress = Callable[[int, int], None]
"""Called with the numbers of finished and of all steps."""

N_STEPS = 3
"""Steps of an import: reading the file, finding the outline, checking the plan."""


def no_progress(done: int, total: int) -> None:
    """Report nothing."""
