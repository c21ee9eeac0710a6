"""A short run of the fuzzer, and its watchdog."""

from __future__ import annotations

import os
import signal
import time

import pytest

from fuzz import supervisor
from fuzz.mutations import Nested
from fuzz.targets import TARGETS
from fuzz.text_formats import json_text, toml_text
from fuzz.worker import Failure, Task, _drawn, run_case

HERE = sorted(TARGETS.keys() - {"options"})  # which interrupts imports of its process


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("name", HERE)
def test_mutated_inputs_end_in_results_or_documented_errors(name, tmp_path) -> None:
    cases = _drawn(Task(name, size=20), 0)
    found = [run_case(name, case, tmp_path) for case in cases]
    assert [failure.detail for failure in found if failure is not None] == []


@pytest.mark.filterwarnings("ignore")
def test_same_seed_same_inputs() -> None:
    task = Task("plan", batch=3, size=10)
    assert _drawn(task, 1) == _drawn(task, 1) != _drawn(task, 2)


def test_absurd_values_are_written_as_they_are() -> None:
    assert toml_text({"a": [1, True, float("nan")]}) == b'"a" = [1, true, nan]'
    assert json_text({"a": None, "b": Nested(3)}) == b'{"a": null, "b": [[[]]]}'


class _Pipe:
    """A connection on which nothing comes, or only its end."""

    def __init__(self, is_closed: bool) -> None:
        self._is_closed = is_closed

    def poll(self, _: float) -> bool:
        return self._is_closed

    def recv(self) -> object:
        raise EOFError


@pytest.mark.parametrize(("is_closed", "kind"), [(True, "crash"), (False, "hang")])
def test_a_lost_worker_is_replaced_and_its_input_kept(monkeypatch, is_closed, kind) -> None:
    monkeypatch.setattr(supervisor, "HANG_S", 0.0)
    monkeypatch.setattr(supervisor, "processor_s", lambda _: 1.0)
    monkeypatch.setattr(supervisor.Worker, "_start", lambda self: None)
    worker = supervisor.Worker(0)
    worker._process = _Dead()
    worker.tasks = _Pipe(is_closed)
    worker.task = Task("plan", size=50)
    folder = worker._folder.name
    for name in (supervisor.CURRENT, supervisor.OUTPUT):
        with open(os.path.join(folder, name), "w") as file:
            file.write("input")
    worker._state[:] = 1e-9, 7, 0.5
    report = worker.result(0.0)
    worker._folder.cleanup()
    assert report is not None
    assert report.n_inputs == 8
    (failure,) = report.failures
    assert (failure.kind, failure.case) == (kind, b"input")


class _Dead:
    pid = 0
    exitcode = -signal.SIGSEGV

    def kill(self) -> None: ...

    def join(self) -> None: ...


def test_an_input_that_waits_for_a_processor_does_not_hang(monkeypatch) -> None:
    monkeypatch.setattr(supervisor.Worker, "_start", lambda self: None)
    worker = supervisor.Worker(0)
    worker._process, worker.task, worker.tasks = _Dead(), Task("plan", size=50), _Pipe(False)
    worker._state[:] = time.monotonic() - 2.0 * supervisor.HANG_S, 7, 0.5
    monkeypatch.setattr(supervisor, "processor_s", lambda _: 0.6)
    assert worker.result(0.0) is None
    worker._folder.cleanup()


def test_failures_become_smaller_as_long_as_they_stay(monkeypatch) -> None:
    def replay(name: str, case: bytes, _: object) -> Failure | None:
        return Failure(name, "traceback", "same", case, "") if b"bad\n" in case else None

    monkeypatch.setattr(supervisor, "replay", replay)
    long = Failure("plan", "traceback", "same", b"good\n" * 20 + b"bad\n" + b"good\n" * 9, "")
    assert supervisor.minimised(long, None).case == b"bad\n"
