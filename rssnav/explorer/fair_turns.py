"""Turns of work: a few jobs at a time, and at most one of each tab."""

from collections.abc import Callable, Generator
from contextlib import contextmanager
from threading import Condition

WAKE_S = 0.05
"""Time between two checks of a waiting job for cancellation [s]."""


class FairTurns:
    """Turns of all tabs, granted in the order of request to tabs that have none.

    Parameters
    ----------
    at_once : int
        Maximum number of simultaneous turns.
    """

    def __init__(self, at_once: int) -> None:
        self._at_once = at_once
        self._changed = Condition()
        self._waiting: list[tuple[object, object]] = []
        self._working: list[object] = []

    @contextmanager
    def turn(self, owner: object, check: Callable[[], None]) -> Generator[None]:
        """Wait for a turn, and hold it during the body.

        Parameters
        ----------
        owner : object
            The tab.
        check : callable
            Called while waiting; its exception ends the wait.
        """
        self._take(owner, check)
        try:
            yield
        finally:
            with self._changed:
                self._working.remove(owner)
                self._changed.notify_all()

    def _take(self, owner: object, check: Callable[[], None]) -> None:
        entry = (owner, object())
        with self._changed:
            self._waiting.append(entry)
            try:
                check()
                while self._next() is not entry:
                    self._changed.wait(WAKE_S)
                    check()
                self._working.append(owner)
            finally:
                self._waiting.remove(entry)
                self._changed.notify_all()

    def _next(self) -> tuple[object, object] | None:
        """Return the entry whose turn it is; None while all turns are taken."""
        if len(self._working) >= self._at_once:
            return None
        return next((entry for entry in self._waiting if entry[0] not in self._working), None)


class TabTurns:
    """Turns of one tab: only one of its jobs runs at a time.

    Parameters
    ----------
    turns : FairTurns
    """

    def __init__(self, turns: FairTurns) -> None:
        self._turns = turns

    @contextmanager
    def turn(self, check: Callable[[], None]) -> Generator[None]:
        """Wait for a turn of this tab; see `FairTurns.turn`."""
        with self._turns.turn(self, check):
            yield
