"""The process that runs inputs, and what it reports."""

from __future__ import annotations

import faulthandler
import linecache
import os
import resource
import tempfile
import time
import traceback
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any
from zlib import crc32

from hypothesis import HealthCheck, Phase, given, seed, settings
from hypothesis import strategies as st

from fuzz.targets import TARGETS, Target
from raytrace import MemoryLimitError

MEMORY_BYTES = 2 << 30
"""How much the address space of a worker may grow."""
PACKAGES = ("atomicfiles", "floorplans", "raytrace", "rssnav")
AT_ONCE = 10
"""Inputs that are drawn together."""
CURRENT = "current"
"""File of the input that is run, in the worker's folder."""
OUTPUT = "output"
"""File of what the worker prints."""


@dataclass(frozen=True)
class Task:
    """Inputs to run: a batch by number from an input on, or one that is given."""

    target: str
    batch: int = 0
    first: int = 0
    size: int = 0
    case: bytes | None = None


@dataclass(frozen=True)
class Failure:
    """An input that had another end than a result or a documented error.

    Attributes
    ----------
    kind
        "traceback", "memory", "hang" or "crash".
    signature
        Equal for failures with the same cause, as far as can be told.
    detail
        Traceback or exit code.
    """

    target: str
    kind: str
    signature: str
    case: bytes
    detail: str


@dataclass(frozen=True)
class Report:
    """What became of a task, and the processor time that it took [s]."""

    task: Task
    n_inputs: int
    failures: tuple[Failure, ...]
    cpu_s: float = 0.0


def work(tasks: Connection, state: Any, folder: str, random_seed: int) -> None:
    """Run tasks until None comes.

    Parameters
    ----------
    tasks
        Tasks come in and reports go out.
    state
        Shared with the supervisor: when the current input began, as `time.monotonic`, 0 between
        inputs; its index within the batch; and when it began, as `time.process_time`.
    folder
        For the files of the inputs; the current one stays there if the process is ended.
    """
    warnings.simplefilter("ignore")
    _own_streams(folder)
    tempfile.tempdir = folder
    _limit_memory()
    while (task := tasks.recv()) is not None:
        began_s = time.process_time()
        cases = [task.case] if task.case is not None else _drawn(task, random_seed)
        failures: list[Failure] = []
        for index, case in enumerate(cases):
            if index < task.first:
                continue
            (Path(folder) / CURRENT).write_bytes(case)
            state[1], state[2], state[0] = index, time.process_time(), time.monotonic()
            failure = run_case(task.target, case, Path(folder))
            state[0] = 0.0
            failures += [failure] if failure else []
        cpu_s = time.process_time() - began_s
        tasks.send(Report(task, len(cases) - task.first, tuple(failures), cpu_s))


def _own_streams(folder: str) -> None:
    """Send what libraries print to a file, and the reason of a crash."""
    with (Path(folder) / OUTPUT).open("w") as output:
        os.dup2(output.fileno(), 1)
        os.dup2(output.fileno(), 2)
    faulthandler.enable(all_threads=False)


def _limit_memory() -> None:
    pages = int(Path("/proc/self/statm").read_text().split()[0])
    limit = pages * resource.getpagesize() + MEMORY_BYTES
    resource.setrlimit(resource.RLIMIT_AS, (limit, resource.RLIM_INFINITY))


def _drawn(task: Task, random_seed: int) -> list[bytes]:
    """Draw the inputs of a batch, the same for the same seed, target and number.

    The first example is left out: hypothesis begins each batch with the same, the simplest one.
    """
    found: list[bytes] = []
    each = min(AT_ONCE, task.size)

    @seed(crc32(f"{random_seed} {task.target} {task.batch}".encode()))
    @settings(
        max_examples=-(-task.size // each) + 1,
        database=None,
        deadline=None,
        derandomize=False,
        phases=[Phase.generate],
        suppress_health_check=list(HealthCheck),
    )
    @given(_several(task.target, each))
    def draw(cases: list[bytes]) -> None:
        found.extend(cases)

    draw()
    return found[each : each + task.size]


@cache
def _several(name: str, number: int) -> st.SearchStrategy[list[bytes]]:
    """Inputs of a target, some at once: hypothesis takes milliseconds for each example."""
    return st.lists(TARGETS[name].cases(), min_size=number, max_size=number)


def run_case(name: str, case: bytes, folder: Path) -> Failure | None:
    """Run one input; return None where it ended as documented."""
    target = TARGETS[name]
    path = folder / f"input{target.suffix}"
    path.write_bytes(case)
    try:
        target.run(path)
    except MemoryLimitError:
        return None
    except MemoryError as error:
        return _failure(name, "memory", case, error)
    except Exception as error:
        if not is_documented(error, target):
            return _failure(name, "traceback", case, error)
    return None


def is_documented(error: Exception, target: Target) -> bool:
    """Whether an error is one that the target may raise; a plain ValueError only on purpose."""
    if not isinstance(error, target.errors):
        return False
    return type(error) is not ValueError or _is_raised_by_us(error)


def _is_raised_by_us(error: Exception) -> bool:
    last = traceback.extract_tb(error.__traceback__)[-1]
    line = linecache.getline(last.filename, last.lineno or 0).strip()
    return _is_ours(last.filename) and line.startswith("raise ")


def _is_ours(file: str) -> bool:
    return any(f"/{package}/" in file for package in PACKAGES) and "site-packages" not in file


def _failure(name: str, kind: str, case: bytes, error: Exception) -> Failure:
    frames = traceback.extract_tb(error.__traceback__)
    ours = [frame for frame in frames if _is_ours(frame.filename)] or frames
    place = f"{Path(ours[-1].filename).name}:{ours[-1].lineno} in {ours[-1].name}"
    signature = f"{name}: {type(error).__name__} at {place}"
    return Failure(name, kind, signature, case, _shortened(traceback.format_exception(error)))


def _shortened(lines: Sequence[str]) -> str:
    return "".join(line if len(line) < 2000 else line[:2000] + "...\n" for line in lines[-30:])
