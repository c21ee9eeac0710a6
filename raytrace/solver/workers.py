"""Threads that compute while the calling one waits, reports progress and can be interrupted."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor, wait
from typing import ParamSpec, TypeVar

import numpy as np

from raytrace.errors import TraceStoppedError
from raytrace.kernels.guard import Guard
from raytrace.threads import n_threads

Stop = Callable[[], bool]
"""Called some twenty times a second while a trace runs; True ends it."""

POLL_S = 0.05
"""Time between two calls of `Stop` [s]."""

LONGEST_END_S = 0.5
"""Longest wait for threads to end; one that compiles a kernel is left to itself [s]."""

Arguments = ParamSpec("Arguments")
Result = TypeVar("Result")


class Workers:
    """Threads that run until the end of a ``with`` block, which also ends unfinished work.

    Kernels run on them and never on the calling thread: Python handles signals on the main thread,
    and only between its own instructions.

    Attributes
    ----------
    n
        How many threads there are.
    """

    def __init__(self, threads: int | None = None, stop: Stop | None = None) -> None:
        self.n = n_threads(threads)
        self._stop = stop
        self._flag = np.zeros(1, np.uint8)
        self._pool = ThreadPoolExecutor(self.n)
        self._unfinished: set[Future[object]] = set()

    def __enter__(self) -> Workers:
        """Start."""
        return self

    def __exit__(self, *_error: object) -> None:
        """Stop what is unfinished, and wait for it."""
        self._flag[0] = 1
        self._pool.shutdown(wait=False, cancel_futures=True)
        wait(tuple(self._unfinished), LONGEST_END_S)

    def guard(self, max_bytes: int) -> Guard:
        """Return the guard of kernels that run here."""
        return Guard(self._flag, max_bytes)

    def submit(
        self, work: Callable[Arguments, Result], *args: Arguments.args, **kwargs: Arguments.kwargs
    ) -> Future[Result]:
        """Put work in the queue."""
        future = self._pool.submit(work, *args, **kwargs)
        self._unfinished.add(future)  # pyright: ignore[reportArgumentType]
        future.add_done_callback(self._unfinished.discard)  # pyright: ignore[reportArgumentType]
        return future

    def result(self, future: Future[Result]) -> Result:
        """Wait for the result of submitted work.

        Raises
        ------
        TraceStoppedError
            Where the caller wants no result any more.
        """
        while True:
            if self._stop is not None and self._stop():
                raise TraceStoppedError("the trace was stopped before its end")
            if wait((future,), POLL_S).done:
                return future.result()

    def run(
        self, work: Callable[Arguments, Result], *args: Arguments.args, **kwargs: Arguments.kwargs
    ) -> Result:
        """Return the result of work, done on one of the threads."""
        return self.result(self.submit(work, *args, **kwargs))
