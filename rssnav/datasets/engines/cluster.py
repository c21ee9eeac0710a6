"""Plans on the workers of a Dask cluster, one task each; workers write the files themselves.

Only a few more tasks than there are workers are with the scheduler at a time. A task whose worker
ends is given to another one. Whatever is lost, a further run finds the files that were written.
"""

from __future__ import annotations

import asyncio
import logging
import os
import time
import warnings
from collections import deque
from collections.abc import Callable, Generator
from contextlib import contextmanager, suppress
from functools import partial
from pathlib import Path
from queue import Empty, SimpleQueue
from typing import Any, TypeVar

from raytrace import SceneWarning
from raytrace.extras import needs_extra
from rssnav.datasets.configuration import Configuration
from rssnav.datasets.engines.job import Job
from rssnav.datasets.engines.warming import warm_kernels
from rssnav.datasets.errors import DatasetError
from rssnav.datasets.plans import PlanSource
from rssnav.datasets.tracing import Limits
from rssnav.datasets.work import Summary, make_plan

Asked = TypeVar("Asked")

CONNECT_S = 10.0
POLL_S = 0.2
COUNT_EVERY_S = 5.0
"""How often the workers are counted: they may join and leave."""
AHEAD = 1
"""Tasks that wait at each worker, so that it is never idle."""
ONE_THREAD = {"NUMBA_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
"""Environment of local workers, set before they import anything."""


class Cluster:
    """An engine on a Dask cluster: one of this machine, or that of a scheduler.

    Attributes
    ----------
    n
        Plans that are traced at the same time.
    """

    def __init__(
        self,
        workers: int | None = None,
        scheduler: str | None = None,
        max_memory_bytes: int | None = None,
    ) -> None:
        with needs_extra("cluster"):
            import distributed as _  # noqa: F401
        self._workers = workers
        self._scheduler = scheduler
        self._max_memory_bytes = max_memory_bytes
        self.n = workers or 1
        if scheduler is not None:
            with _connected(scheduler) as client:
                self.n = max(1, _threads_of(client))

    def run(self, job: Job) -> None:
        """Trace all plans; see `Engine`."""
        if self._scheduler is not None:
            with _connected(self._scheduler) as client:
                self._run(client, job)
            return
        with _local_cluster(min(self._workers or 1, len(job.sources))) as client:
            self._run(client, job)

    def _run(self, client: Any, job: Job) -> None:
        self._asked(client.register_plugin, _warming(job.configuration))
        waiting, running = deque(job.sources), dict[str, tuple[PlanSource, Any]]()
        done: SimpleQueue[str] = SimpleQueue()
        window, counted_s = 1, 0.0
        while waiting or running:
            if time.monotonic() - counted_s > COUNT_EVERY_S:
                window = max(1, (1 + AHEAD) * self._asked(_threads_of, client))
                counted_s = time.monotonic()
            while waiting and len(running) < window:
                source = waiting.popleft()
                key = source.key(job.configuration.key)
                future = client.submit(
                    on_worker, source, job.configuration, job.folder, key,
                    self._max_memory_bytes, key=f"rssnav-{key}", pure=False,
                )  # fmt: skip
                future.add_done_callback(partial(_put, done, key))
                running[key] = source, future
            job.traced(0)
            try:
                source, future = running.pop(done.get(timeout=POLL_S))
            except Empty:
                self._check_alive(client)
                continue
            summary = self._result(client, job, source, future)
            job.traced(len(summary.rows))
            job.finished(summary)

    def _result(self, client: Any, job: Job, source: PlanSource, future: Any) -> Summary:
        """Return the summary of a task; a lost one is that of a plan, or of the cluster."""
        with suppress(_cancelled()):  # the scheduler may be lost at any moment
            if future.status == "finished":
                return future.result()
        if future.status == "error":
            error = future.exception()
            if isinstance(error, DatasetError | OSError):
                raise error
            return job.failed(source, error)
        self._check_alive(client)
        raise DatasetError(
            f"the task of plan {source.name!r} was cancelled; run the same command again to resume"
        )

    def _check_alive(self, client: Any) -> None:
        """Raise DatasetError where the scheduler is gone."""
        comm = getattr(client, "scheduler_comm", None)
        if client.status != "running" or comm is None or comm.comm.closed():
            raise self._gone()

    def _asked(self, ask: Callable[..., Asked], *arguments: Any) -> Asked:
        """Ask the scheduler something; raise DatasetError where it does not answer."""
        try:
            return ask(*arguments)
        except (OSError, TimeoutError) as error:
            raise self._gone() from error

    def _gone(self) -> DatasetError:
        where = f"at {self._scheduler} " if self._scheduler else ""
        return DatasetError(
            f"the Dask scheduler {where}is gone; finished plans are saved: run the same command "
            "again to resume"
        )


def _cancelled() -> type[BaseException]:
    """Return the error of a task whose result the scheduler no longer has."""
    from distributed.client import FutureCancelledError

    return FutureCancelledError


def on_worker(
    source: PlanSource,
    configuration: Configuration,
    folder: Path,
    key: str,
    max_memory_bytes: int | None,
) -> Summary:
    """Trace a plan on a worker; see `make_plan`.

    Raises
    ------
    DatasetError, OSError
        Where no plan can be traced here, or kept.
    """
    if source.key(configuration.key) != key:
        raise DatasetError("a worker has another version of rssnav: expected the same everywhere")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", SceneWarning)
            return make_plan(source, configuration, folder, Limits(1, max_memory_bytes))
    except (DatasetError, OSError):
        raise
    except Exception as error:  # such as one that cannot be sent
        return Summary.of_failure(source, key, error, is_final=False)


def _put(done: SimpleQueue[str], key: str, _future: Any) -> None:
    """Note that a task has ended."""
    done.put(key)


def _warming(configuration: Configuration) -> Any:
    """Return a plug-in that compiles the kernels of a worker, or loads them, before its tasks."""
    from distributed import WorkerPlugin

    class Warming(WorkerPlugin):
        name = f"rssnav-kernels-{configuration.key[:12]}"

        async def setup(self, worker: Any) -> None:
            loop = asyncio.get_running_loop()
            await loop.run_in_executor(None, warm_kernels, configuration)

    return Warming()


def _threads_of(client: Any) -> int:
    return sum(client.nthreads().values())


@contextmanager
def _connected(scheduler: str) -> Generator[Any]:
    from dask import config
    from distributed import Client

    config.set({"distributed.comm.timeouts.connect": f"{CONNECT_S}s"})
    try:
        client = Client(scheduler, timeout=CONNECT_S, set_as_default=False)
    except (OSError, ValueError, TimeoutError) as error:
        raise DatasetError(
            f"no Dask scheduler answers at {scheduler!r}: expected an address such as "
            "tcp://host:8786"
        ) from error
    with _closing(client):
        yield client


@contextmanager
def _local_cluster(workers: int) -> Generator[Any]:
    from dask import config
    from distributed import Client, LocalCluster

    environment = "distributed.nanny.pre-spawn-environ"
    found = config.get(environment, default={})
    with (
        _silent_tracker(),
        config.set({environment: {**found, **ONE_THREAD}}),
        LocalCluster(
            n_workers=workers,
            threads_per_worker=1,
            processes=True,
            dashboard_address=None,  # pyright: ignore[reportArgumentType]
            silence_logs=logging.CRITICAL,
        ) as cluster,
        _closing(Client(cluster, set_as_default=False)) as client,
    ):
        yield client


@contextmanager
def _silent_tracker() -> Generator[None]:
    """Let multiprocessing clean up after an interrupt without a warning for each semaphore."""
    before = os.environ.get("PYTHONWARNINGS")
    ignore = "ignore::UserWarning:multiprocessing.resource_tracker"
    os.environ["PYTHONWARNINGS"] = f"{before},{ignore}" if before else ignore
    try:
        yield
    finally:
        if before is None:
            del os.environ["PYTHONWARNINGS"]
        else:
            os.environ["PYTHONWARNINGS"] = before


@contextmanager
def _closing(client: Any) -> Generator[Any]:
    """Close a client, without waiting for a scheduler that is gone."""
    logging.getLogger("distributed").setLevel(logging.CRITICAL)
    try:
        yield client
    finally:
        client.close(timeout=1)
