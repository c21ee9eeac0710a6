"""Keeps a worker busy on every processor, ends those that hang, and collects failures."""

from __future__ import annotations

import multiprocessing
import os
import tempfile
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from types import TracebackType
from typing import Any

from fuzz import samples
from fuzz.targets import TARGETS
from fuzz.worker import CURRENT, OUTPUT, Failure, Report, Task, work

HANG_S = 10.0
"""Processor time that an input may take [s]."""
WAIT_S = 200.0
"""Time that an input may take in all, where other programs need the processors [s]."""
BATCH = 100
IN_MEMORY = "/dev/shm"
KINDS = ("traceback", "hang", "crash", "memory")

_CONTEXT = multiprocessing.get_context("forkserver")


@dataclass
class Outcome:
    """Counts of a run, and one example of each failure."""

    inputs: Counter[str] = field(default_factory=Counter)
    kinds: Counter[str] = field(default_factory=Counter)
    examples: dict[str, Failure] = field(default_factory=dict)
    seconds: float = 0.0
    cpu_s: float = 0.0

    def add(self, report: Report) -> None:
        """Count inputs and failures; keep the smallest input of each kind of failure."""
        self.inputs[report.task.target] += report.n_inputs
        self.cpu_s += report.cpu_s
        for failure in report.failures:
            self.kinds[failure.kind] += 1
            known = self.examples.get(failure.signature)
            if known is None or len(failure.case) < len(known.case):
                self.examples[failure.signature] = failure

    def summary(self) -> str:
        """Counts in one line."""
        total = sum(self.inputs.values())
        names = ("tracebacks", "hangs", "crashes", "over memory")
        counts = ", ".join(f"{self.kinds[k]} {n}" for k, n in zip(KINDS, names, strict=True))
        rate = total / max(self.seconds, 1e-9)
        of_cpu = total / max(self.cpu_s, 1e-9)
        return (
            f"{total} inputs in {self.seconds:.0f} s, {rate:.0f} per second "
            f"({of_cpu:.0f} per second of processor time): {counts}"
        )


def _fast_folder() -> str | None:
    """A folder in memory for the files of inputs, which are written all the time."""
    return IN_MEMORY if os.access(IN_MEMORY, os.W_OK) else None


def processor_s(process: int) -> float:
    """Processor time that a process has used [s]; 0 where it has ended."""
    try:
        fields = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
    except OSError:
        return 0.0
    return sum(map(int, fields[11:13])) / os.sysconf("SC_CLK_TCK")


class Worker:
    """A worker process and the task it has."""

    def __init__(self, random_seed: int) -> None:
        self._seed = random_seed
        self._folder = tempfile.TemporaryDirectory(dir=_fast_folder())
        self._state = _CONTEXT.RawArray("d", 3)
        self.task: Task | None = None
        self._hang = ""
        self._start()

    def _start(self) -> None:
        self._state[0] = 0.0
        self.tasks, other = _CONTEXT.Pipe()
        arguments = (other, self._state, self._folder.name, self._seed)
        self._process: Any = _CONTEXT.Process(target=work, args=arguments, daemon=True)
        self._process.start()
        other.close()

    def __enter__(self) -> Worker:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """End the process and remove its files."""
        self._process.kill()
        self._process.join()
        self.tasks.close()
        self._folder.cleanup()

    def give(self, task: Task) -> None:
        """Start a task."""
        self.task = task
        self.tasks.send(task)

    def result(self, wait_s: float) -> Report | None:
        """What became of the task; None while it runs."""
        assert self.task is not None
        if self.tasks.poll(wait_s):
            try:
                return self.tasks.recv()
            except (EOFError, ConnectionResetError):
                return self._lost("crash")
        return self._lost("hang") if self._hangs() else None

    def _hangs(self) -> bool:
        """Whether the input takes too long; `_hang` says in which way."""
        began = self._state[0]
        waited_s = time.monotonic() - began if began else 0.0
        if waited_s <= HANG_S:
            return False
        computed = processor_s(self._process.pid) - self._state[2] > HANG_S
        self._hang = f"more than {HANG_S:g} s of a processor" if computed else "it waits"
        return computed or waited_s > WAIT_S

    def _lost(self, kind: str) -> Report:
        """Start again after the input that ended the process."""
        assert self.task is not None
        self._process.kill()
        self._process.join()
        code = self._process.exitcode
        case = (Path(self._folder.name) / CURRENT).read_bytes()
        at = int(self._state[1])
        name = self.task.target
        reason = f"exit code {code}" if kind == "crash" else self._hang
        printed = (Path(self._folder.name) / OUTPUT).read_text(errors="replace")
        detail = f"{reason}\n{printed[-3000:]}"
        failure = Failure(name, kind, f"{name}: {kind}, {reason}", case, detail)
        report = Report(self.task, at + 1 - self.task.first, (failure,))
        self._start()
        return report


def fuzz(
    names: Sequence[str], seconds: float, random_seed: int, n_workers: int, most: int | None = None
) -> Outcome:
    """Run inputs for a time.

    Parameters
    ----------
    names
        Of `TARGETS`; each gets the same share of the time.
    seconds
        When to stop [s].
    random_seed
        Same seed, same inputs.
    n_workers
        Processes.
    most
        Batches per target; no limit by default.
    """
    run = _Run(list(names), most)
    workers = [Worker(random_seed) for _ in range(n_workers)]
    for worker in workers:
        replay(names[0], b"", worker)  # until it has started
    began = time.monotonic()
    try:
        while time.monotonic() - began < seconds and run.step(workers):
            pass
    finally:
        for worker in workers:
            worker.__exit__(None, None, None)
    run.outcome.seconds = time.monotonic() - began
    return run.outcome


class _Run:
    """Which batch comes next: one of the target that has had the least time."""

    def __init__(self, names: list[str], most: int | None) -> None:
        self.outcome = Outcome()
        self._time_s = dict.fromkeys(names, 0.0)
        self._next = dict.fromkeys(names, 0)
        self._most = most
        self._began: dict[int, float] = {}

    def step(self, workers: Sequence[Worker]) -> bool:
        """Give tasks to free workers and take what is done; False when nothing is left."""
        n_free = 0
        for worker in workers:
            task = None if worker.task else self._next_task()
            if task is not None:
                self._begin(worker, task)
            if worker.task is not None:
                report = worker.result(0.02)
                if report is not None:
                    self._take(worker, report)
            else:
                n_free += 1
        return n_free < len(workers)

    def _next_task(self) -> Task | None:
        left = [n for n in self._next if self._most is None or self._next[n] < self._most]
        if not left:
            return None
        name = min(left, key=lambda n: (self._time_s[n], self._next[n]))
        batch = self._next[name]
        self._next[name] += 1
        self._time_s[name] += 1e-3  # so that two workers do not begin with the same target
        return Task(name, batch, size=BATCH)

    def _begin(self, worker: Worker, task: Task) -> None:
        self._began[id(worker)] = time.monotonic()
        worker.give(task)

    def _take(self, worker: Worker, report: Report) -> None:
        task = report.task
        self._time_s[task.target] += time.monotonic() - self._began[id(worker)]
        self.outcome.add(report)
        done = task.first + report.n_inputs
        worker.task = None
        if report.failures and report.failures[-1].kind in ("hang", "crash") and done < task.size:
            self._begin(worker, replace(task, first=done))


@contextmanager
def preparation() -> Iterator[None]:
    """Make samples and load all modules once; workers begin with them."""
    with tempfile.TemporaryDirectory() as folder:
        os.environ[samples.FOLDER] = folder
        samples.make_all()
        _CONTEXT.set_forkserver_preload(["fuzz.preloaded"])
        yield


def replay(name: str, case: bytes, worker: Worker) -> Failure | None:
    """Run one input in a worker; return its failure."""
    worker.give(Task(name, case=case))
    while (report := worker.result(0.05)) is None:
        pass
    worker.task = None
    return report.failures[0] if report.failures else None


def minimised(failure: Failure, worker: Worker, seconds: float = 15.0) -> Failure:
    """Remove parts of an input as long as the same failure stays."""
    by_lines = TARGETS[failure.target].by_lines
    parts = _parts(failure.case, by_lines)
    until = time.monotonic() + seconds
    length = max(len(parts) // 2, 1)
    while length and time.monotonic() < until:
        at, shrunk = 0, False
        while at < len(parts) and time.monotonic() < until:
            shorter = parts[:at] + parts[at + length :]
            found = replay(failure.target, b"".join(shorter), worker)
            if found is not None and found.signature == failure.signature:
                failure, parts, shrunk = found, shorter, True
            else:
                at += length
        length = length if shrunk and length == 1 else length // 2
    return failure


def _parts(case: bytes, by_lines: bool) -> list[bytes]:
    if by_lines:
        return case.splitlines(keepends=True)
    return [case[at : at + 1] for at in range(len(case))]
