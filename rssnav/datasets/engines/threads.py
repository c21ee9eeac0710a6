"""Plans on the threads of this process, one each; a few plans share all threads."""

from __future__ import annotations

import threading
import warnings
from collections import deque
from collections.abc import Callable
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait

from raytrace import SceneWarning
from raytrace.memory import memory_limit
from raytrace.threads import n_threads
from rssnav.datasets.engines.job import Job
from rssnav.datasets.errors import DatasetError
from rssnav.datasets.plans import PlanSource
from rssnav.datasets.tracing import Limits
from rssnav.datasets.work import Summary, make_plan

POLL_S = 0.1
LONGEST_END_S = 0.5


class Threads:
    """An engine on the threads of this process.

    Attributes
    ----------
    n
        Plans at the same time.
    """

    def __init__(self, threads: int | None = None, max_memory_bytes: int | None = None) -> None:
        self.n = n_threads(threads)
        self._max_memory_bytes = max_memory_bytes

    def run(self, job: Job) -> None:
        """Trace all plans; see `Engine`."""
        stop, traced = threading.Event(), deque[None]()
        at_once = min(self.n, len(job.sources))
        limits = Limits(
            max(1, self.n // max(at_once, 1)),
            memory_limit(self._max_memory_bytes) // max(at_once, 1),
            stop.is_set,
            lambda: traced.append(None),
        )
        pool = ThreadPoolExecutor(self.n)
        running: dict[Future[Summary], PlanSource] = {}
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", SceneWarning)
                waiting = deque(job.sources)
                while waiting or running:
                    while waiting and len(running) < self.n:
                        source = waiting.popleft()
                        work = (make_plan, source, job.configuration, job.folder, limits)
                        running[pool.submit(*work)] = source
                    done = wait(running, POLL_S, FIRST_COMPLETED).done
                    job.traced(_taken(traced))
                    for future in done:
                        job.finished(_result(job, running.pop(future), future))
        finally:
            stop.set()
            pool.shutdown(wait=False, cancel_futures=True)
            wait(running, LONGEST_END_S)


def _taken(traced: deque[None]) -> int:
    """Take what is in a queue; return how much that was."""
    n = len(traced)
    for _ in range(n):
        traced.popleft()
    return n


def _result(job: Job, source: PlanSource, future: Future[Summary]) -> Summary:
    """Return the summary of a plan; an error that is not of the folder is one of this plan."""
    read: Callable[[], Summary] = future.result
    try:
        return read()
    except (DatasetError, OSError):
        raise
    except Exception as error:
        return job.failed(source, error)
