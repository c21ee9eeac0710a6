"""Work on a thread of its own, of which only the newest request counts."""

import logging
from collections.abc import Callable
from threading import Condition, Event, Thread

LOGGER = logging.getLogger(__name__)


class SupersededError(Exception):
    """A newer request has taken the place of this one."""


class Ticket:
    """Tells a job whether it is still wanted."""

    def __init__(self) -> None:
        self._cancelled = Event()

    def cancel(self) -> None:
        """Tell the job to stop."""
        self._cancelled.set()

    @property
    def cancelled(self) -> bool:
        """Whether the job was told to stop."""
        return self._cancelled.is_set()

    def check(self) -> None:
        """Raise `SupersededError` where the job was told to stop."""
        if self.cancelled:
            raise SupersededError


Job = Callable[[Ticket], None]


class NewestOnly:
    """A thread that runs one job at a time and drops what a newer one makes needless.

    A job must look at its ticket often, and handle its own errors; one that escapes is logged, and
    the thread goes on.

    Parameters
    ----------
    name : str
        Of the thread.
    """

    def __init__(self, name: str) -> None:
        self._name = name
        self._changed = Condition()
        self._waiting: tuple[Job, Ticket] | None = None
        self._ticket = Ticket()
        self._thread: Thread | None = None
        self._closed = False

    def submit(self, job: Job) -> None:
        """Run a job as soon as the one before it has noticed that it is no longer wanted."""
        with self._changed:
            if self._closed:
                return
            self._ticket.cancel()
            self._ticket = Ticket()
            self._waiting = (job, self._ticket)
            if self._thread is None:
                self._thread = Thread(target=self._work, name=self._name, daemon=True)
                self._thread.start()
            self._changed.notify()

    def cancel(self) -> None:
        """Stop what is running and forget what is waiting."""
        with self._changed:
            self._ticket.cancel()
            self._waiting = None

    def close(self) -> None:
        """Cancel everything and end the thread; later jobs are ignored."""
        with self._changed:
            self._closed = True
            self._ticket.cancel()
            self._waiting = None
            self._changed.notify()

    def join(self, timeout_s: float | None = None) -> None:
        """Wait for the thread to end after `close`."""
        if self._thread is not None:
            self._thread.join(timeout_s)

    def _work(self) -> None:
        while (task := self._next()) is not None:
            job, ticket = task
            try:
                job(ticket)
            except SupersededError:
                continue
            except Exception:
                LOGGER.exception("a job of %s failed", self._name)

    def _next(self) -> tuple[Job, Ticket] | None:
        """Wait for a job; None once closed."""
        with self._changed:
            self._changed.wait_for(lambda: self._closed or self._waiting is not None)
            task, self._waiting = self._waiting, None
            return task
