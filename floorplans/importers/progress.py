"""Progress of an import."""

from __future__ import annotations

from collections.abc import Callable
from enum import IntEnum

Progress = Callable[[int, int], None]
"""Called with the numbers of finished and of all steps."""


class Step(IntEnum):
    """Steps of an import, each up to what is then finished; none takes most of the time."""

    BEGUN = 0
    FILE_LOADED = 1
    FACES_PAIRED = 2
    DRAFT_READ = 3
    WALLS_REPAIRED = 4
    WALLS_SPLIT = 5
    OUTLINE_FOUND = 6
    WALLS_SETTLED = 7
    OPENINGS_ATTACHED = 8
    PLACES_CHOSEN = 9
    PLAN_CHECKED = 10


Report = Callable[[Step], None]
"""Called with each step that is finished."""


def reporter(progress: Progress | None) -> Report:
    """Report to a caller, if any."""
    if progress is None:
        return no_report
    return lambda step: progress(int(step), int(max(Step)))


def no_report(step: Step) -> None:
    """Report nothing."""
