"""Worker threads of a tab: for the newest request only, and for files that are made in turn."""

import asyncio
import logging
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from threading import Condition, Event, Thread

from rssnav.explorer.fair_turns import TabTurns

LOGGER = logging.getLogger(__name__)


class SupersededError(Exception):
    """A newer request has replaced this one."""


class TooManyError(Exception):
    """A tab has as many requests waiting as it may."""


class Ticket:
    """Cancellation token of a job."""

    def __init__(self) -> None:
        self._cancelled = Event()

    def cancel(self) -> None:
        """Ask the job to stop."""
        self._cancelled.set()

    @property
    def cancelled(self) -> bool:
        """Whether the job was asked to stop."""
        return self._cancelled.is_set()

    def check(self) -> None:
        """Raise `SupersededError` if the job was asked to stop."""
        if self.cancelled:
            raise SupersededError


Job = Callable[[Ticket], None]


class NewestOnly:
    """A thread that runs one job at a time and cancels it when a newer one is submitted.

    A job waits for a turn of its tab. It must check its ticket often and handle its own errors; any
    other error is logged, and the thread continues.

    Parameters
    ----------
    name : str
        Name of the thread.
    turns : TabTurns
    """

    def __init__(self, name: str, turns: TabTurns) -> None:
        self._name = name
        self._turns = turns
        self._changed = Condition()
        self._waiting: tuple[Job, Ticket] | None = None
        self._ticket = Ticket()
        self._thread: Thread | None = None
        self._closed = False

    def submit(self, job: Job) -> None:
        """Cancel the current job, and run this one as soon as it has stopped."""
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
        """Cancel the running and the waiting job."""
        with self._changed:
            self._ticket.cancel()
            self._waiting = None

    def close(self) -> None:
        """Cancel all jobs and end the thread; later jobs are ignored."""
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
                with self._turns.turn(ticket.check):
                    job(ticket)
            except SupersededError:
                continue
            except Exception:
                LOGGER.exception("a job of %s failed", self._name)

    def _next(self) -> tuple[Job, Ticket] | None:
        """Wait for a job; None after `close`."""
        with self._changed:
            self._changed.wait_for(lambda: self._closed or self._waiting is not None)
            task, self._waiting = self._waiting, None
            return task


class FileMaker:
    """A thread that makes files one after the other, so that the page answers meanwhile.

    Parameters
    ----------
    turns : TabTurns
        A file waits for a turn of its tab.
    """

    MOST = 8
    """Maximum number of files that are waiting or being made."""

    def __init__(self, turns: TabTurns) -> None:
        self._turns = turns
        self._ticket = Ticket()
        self._pool = ThreadPoolExecutor(1, thread_name_prefix="files")
        self._n = 0

    async def make(self, content: Callable[[], bytes]) -> bytes:
        """Return the content of a file that a function makes on the thread.

        Raises
        ------
        TooManyError
            When `MOST` files are waiting already.
        SupersededError
            After `close`.
        """
        if self._n >= self.MOST:
            raise TooManyError(f"{self._n} downloads are waiting: try again when they are done")
        self._ticket.check()
        self._n += 1
        try:
            loop = asyncio.get_running_loop()
            return await loop.run_in_executor(self._pool, self._in_turn, content)
        finally:
            self._n -= 1

    def _in_turn(self, content: Callable[[], bytes]) -> bytes:
        with self._turns.turn(self._ticket.check):
            return content()

    def close(self) -> None:
        """Make no more files, and end the thread."""
        self._ticket.cancel()
        self._pool.shutdown(wait=False)
