"""Processes that are killed, interrupted, run twice at once, or have no room to write."""

from __future__ import annotations

import os
import random
import re
import resource
import signal
import subprocess
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor, wait
from dataclasses import dataclass
from pathlib import Path

from raytrace.threads import n_threads
from torture.checks import differences, files_in, half_files, temporary_in
from torture.jobs import JOBS, LIMIT_S, Job, Workshop, command, environment, run_to_end

SIGNALS = (signal.SIGKILL, signal.SIGINT, signal.SIGTERM)
CODES = {signal.SIGKILL: -signal.SIGKILL, signal.SIGINT: 130, signal.SIGTERM: 143}
"""Exit codes after a signal."""
START_S = 60.0
"""Longest time until a program handles signals."""
TRIES = 3
"""A job that has always ended before its signals is tried this many times as often as wanted."""
SHORTEST = 0.2
"""A job that continues is taken to need at least this fraction of its time."""
LONGEST_S = 120.0
"""A process that runs this long after its signal is killed."""
SLOW_S = 5.0
"""An interrupted process ends within this, besides waiting for a processor that others have; longer
where more processes run than there are cores."""


@dataclass(frozen=True)
class Attacked:
    """What came of a job that was attacked.

    Attributes
    ----------
    n_attacks
        How often it was.
    slowest_s
        Longest time from a signal to the end of the process [s].
    faults
        What was wrong, one sentence each.
    """

    name: str
    n_attacks: int
    slowest_s: float
    faults: tuple[str, ...]


def kill_at_random(
    name: str, workshop: Workshop, generator: random.Random, kills: int | None = None
) -> Attacked:
    """End a job several times, then let it finish: nothing is half, lost or left behind."""
    job, folder, wanted = JOBS[name], workshop.before(name), workshop.after(name)
    faults: list[str] = []
    slowest_s, n_kills, tries, most = 0.0, 0, 0, kills or job.kills
    left_s = duration_s = workshop.duration_s(name)
    while n_kills < most and tries < TRIES * most:
        tries += 1
        sent = generator.choice(SIGNALS)
        moment_s = generator.choice((duration_s, left_s)) * generator.random()
        ended = _end(job, folder, sent, moment_s, while_writing=generator.random() < 0.3)
        faults += [f"{sent.name} after {moment_s:.2f} s: {fault}" for fault in ended.faults(sent)]
        faults += half_files(folder)
        slowest_s, n_kills = max(slowest_s, ended.took_s), n_kills + ended.was_running
        left_s = max(left_s - moment_s, SHORTEST * duration_s)  # where it continues what was kept
        if not ended.was_running:  # there is nothing left to resume
            faults += differences(folder, wanted)
            folder, left_s = workshop.before(name), duration_s
    try:
        run_to_end(job, folder)
    except RuntimeError as error:
        faults.append(f"does not finish afterwards: {error}")
    faults += differences(folder, wanted)
    return Attacked(name, n_kills, slowest_s, tuple(faults))


@dataclass(frozen=True)
class _Ended:
    code: int
    errors: str
    was_running: bool
    took_s: float

    def faults(self, sent: signal.Signals) -> Iterator[str]:
        """What is wrong in how the process ended."""
        expected = (CODES[sent], 0) if self.was_running else (0,)
        if self.code not in expected:
            yield f"exit code {self.code}, expected {expected[0]}: {self.errors[-500:]}"
        if "Traceback" in self.errors:
            yield f"a traceback: {self.errors[-1500:]}"
        elif self.code in (130, 143):
            yield from _message_faults(self.errors)
        if self.took_s > SLOW_S * max(1.0, os.getloadavg()[0] / n_threads()):
            yield f"it took {self.took_s:.1f} s to end"


def _message_faults(errors: str) -> Iterator[str]:
    lines = errors.splitlines()
    own = [line for line in lines if re.match("rssnav: (?!warning: )", line)]
    if len(own) != 1 or lines[-1] != own[0]:
        yield f"expected one last line of rssnav, found {lines[-3:]}"


def _end(
    job: Job, folder: Path, sent: signal.Signals, moment_s: float, while_writing: bool
) -> _Ended:
    """Send a signal at a moment after the program's first, or as soon as the job writes."""
    known = temporary_in(folder)
    with subprocess.Popen(
        command(job.arguments), cwd=folder, env=environment(), stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE, text=True, errors="replace",
    ) as process:  # fmt: skip
        wait_until_signals_are_handled(process)
        began = time.monotonic()
        while process.poll() is None and time.monotonic() - began < moment_s:
            time.sleep(0.002)
            if while_writing and temporary_in(folder) - known:
                break
        was_running, at, queued_s = process.poll() is None, time.monotonic(), _queued_s(process)
        process.send_signal(sent)
        with ThreadPoolExecutor(1) as pool:
            output = pool.submit(process.communicate)
            waited_s = queued_s
            while not output.done() and time.monotonic() - at < LONGEST_S:
                waited_s = max(waited_s, _queued_s(process))
                wait((output,), 0.02)
            if not output.done():
                process.kill()
            _, errors = output.result()
    took_s = time.monotonic() - at - (waited_s - queued_s)
    return _Ended(process.returncode, errors, was_running, took_s)


def _queued_s(process: subprocess.Popen[str]) -> float:
    """How long a process has waited for a processor that others had [s]; 0 once it has ended."""
    try:
        return int(Path(f"/proc/{process.pid}/schedstat").read_text().split()[1]) / 1e9
    except (OSError, IndexError):
        return 0.0


def wait_until_signals_are_handled(process: subprocess.Popen[str]) -> None:
    """Wait for the program's first moment; until then Python starts, and ends in its own ways."""
    status = Path(f"/proc/{process.pid}/status")
    bit, ends = 1 << (signal.SIGTERM - 1), time.monotonic() + START_S
    while process.poll() is None and time.monotonic() < ends:
        caught = re.search(r"SigCgt:\s*(\w+)", status.read_text())
        if caught and int(caught.group(1), 16) & bit:
            return
        time.sleep(0.002)


def fill_the_disk(name: str, workshop: Workshop, generator: random.Random) -> Attacked:
    """Let a job write only few bytes: it fails with one line and leaves nothing half."""
    job, folder, wanted = JOBS[name], workshop.before(name), workshop.after(name)
    before = files_in(folder)
    largest = max((wanted / file).stat().st_size for file in files_in(wanted) - before or before)
    limit = generator.randrange(max(largest, 1))
    done = subprocess.run(
        command(job.arguments), cwd=folder, env=environment(), capture_output=True, text=True,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit)),
        timeout=LIMIT_S,
    )  # fmt: skip
    faults = [f"limit of {limit} bytes: {fault}" for fault in _full_disk_faults(done)]
    faults += [*half_files(folder), *(f"{file} is litter" for file in temporary_in(folder))]
    run_to_end(job, folder)
    return Attacked(name, 1, 0.0, (*faults, *differences(folder, wanted)))


def _full_disk_faults(done: subprocess.CompletedProcess[str]) -> Iterator[str]:
    if done.returncode not in (0, 1):
        yield f"exit code {done.returncode}: {done.stderr[-1500:]}"
    elif "Traceback" in done.stderr:
        yield f"a traceback: {done.stderr[-1500:]}"
    elif done.returncode == 1:
        yield from _message_faults(done.stderr)
        if "too large" not in done.stderr:
            yield f"the message does not say what is full: {done.stderr[-500:]}"


def write_twice(name: str, workshop: Workshop, generator: random.Random) -> Attacked:
    """Run a job twice at once in one folder: one result, whole, and no litter."""
    job, folder, wanted = JOBS[name], workshop.before(name), workshop.after(name)
    processes = []
    for _ in range(2):
        processes.append(
            subprocess.Popen(
                command(job.arguments), cwd=folder, env=environment(), stdout=subprocess.DEVNULL,
                stderr=subprocess.PIPE, text=True,
            )
        )  # fmt: skip
        time.sleep(generator.random() / 5)
    faults: list[str] = []
    for process in processes:
        _, errors = process.communicate(timeout=LIMIT_S)
        if process.returncode not in (0, 1) or "Traceback" in errors:
            faults.append(f"exit code {process.returncode}: {errors[-1500:]}")
    faults += [*half_files(folder), *differences(folder, wanted)]
    return Attacked(name, 1, 0.0, tuple(faults))
