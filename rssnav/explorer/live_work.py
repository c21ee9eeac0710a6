"""Work in a thread of its own that can be watched and stopped, in the turns of its tab."""

from __future__ import annotations

import logging
from abc import ABC, abstractmethod
from threading import Event, Thread

from rssnav.explorer.background import SupersededError
from rssnav.explorer.fair_turns import FairTurns, TabTurns
from rssnav.world import WorldError

LOGGER = logging.getLogger(__name__)


class LiveWork(ABC):
    """Work in a thread; a problem of the user's making is told, any other is logged.

    Parameters
    ----------
    name : str
        What it is, for its thread and for messages.
    turns : TabTurns or None
        Turns of its tab; turns of its own by default.

    Attributes
    ----------
    problem : str
        Why it failed; empty if it did not.
    """

    def __init__(self, name: str, turns: TabTurns | None) -> None:
        self.problem = ""
        self._name = name
        self._turns = turns or TabTurns(FairTurns(1))
        self._stop = Event()
        self._thread = Thread(target=self._run, name=name, daemon=True)

    def start(self) -> None:
        """Start it."""
        self._thread.start()

    def stop(self) -> None:
        """Ask it to stop; its results so far stay."""
        self._stop.set()

    def join(self, timeout_s: float | None = None) -> None:
        """Wait until it ends."""
        self._thread.join(timeout_s)

    @property
    def running(self) -> bool:
        """Whether it is still running."""
        return self._thread.is_alive()

    @abstractmethod
    def _work(self) -> None:
        """Do the work; calls `_check` now and then, as while it waits for a turn."""

    def _check(self) -> None:
        """Raise `SupersededError` if asked to stop."""
        if self._stop.is_set():
            raise SupersededError

    def _run(self) -> None:
        try:
            self._work()
        except SupersededError:
            return
        except (WorldError, ValueError) as error:
            self.problem = str(error)
        except Exception:
            LOGGER.exception("the %s failed", self._name)
            self.problem = f"the {self._name} failed; see the server's log"
