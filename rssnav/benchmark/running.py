"""Flights of all policies, saved building by building, so that a run can be resumed."""

from __future__ import annotations

import json
import multiprocessing
import os
import re
import signal
import threading
import time
from collections.abc import Callable, Generator, Iterator, Sequence
from concurrent.futures import Executor, ProcessPoolExecutor, as_completed
from contextlib import contextmanager
from dataclasses import asdict, dataclass, replace
from functools import cache
from hashlib import sha256
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from atomicfiles import atomic_write
from raytrace.threads import n_threads
from raytrace.trace import TRACER_VERSION
from rssnav.benchmark.buildings import Building, Site, generated, own, paper
from rssnav.benchmark.policies import Briefing, Guarded, PolicySpec
from rssnav.benchmark.protocol import (
    BENCHMARK_VERSION,
    Condition,
    Extent,
    conditions_of,
    flights_of_a_seed,
)
from rssnav.missions import Flights, Mission, fly
from rssnav.policies import Hypotheses

_WARMING_S = 3
"""Seconds of a flight before the first, in which compiled kernels are loaded; it is not timed."""

_FLIGHT_CODE = (
    *(f"benchmark/{module}.py" for module in ("buildings", "policies", "protocol", "running")),
    *(f"{package}/*.py" for package in ("kernels", "missions", "policies")),
)
"""Modules of rssnav that decide how flights go."""

Show = Callable[[str, int, int], None]


@dataclass(frozen=True)
class Record:
    """Flights of a policy in a condition and a building; lists have an item for each flight.

    Attributes
    ----------
    policy, track, condition : str
        Who, its track, under which condition.
    site : {"train", "validation", "test", "paper", "own"}
        Where the building comes from.
    building : str
        Its name.
    found, false_alarm : list of bool
        As of `rssnav.missions.Flights`.
    steps, actions, shortest, turns : list of int
        Seconds flown, steps and hovering that the policy chose, fewest steps that were possible,
        changes of direction.
    energy_kj : list of float
        Energy [kJ].
    collisions : int
        Impossible actions of all flights.
    cpu_s : float
        Processor time of all flights [s].
    """

    policy: str
    track: str
    condition: str
    site: Site
    building: str
    found: list[bool]
    false_alarm: list[bool]
    steps: list[int]
    actions: list[int]
    shortest: list[int]
    turns: list[int]
    energy_kj: list[float]
    collisions: int
    cpu_s: float


def run(
    policies: Sequence[PolicySpec],
    extent: Extent,
    folder: Path,
    *,
    threads: int | None = None,
    resume: bool = True,
    show: Show | None = None,
) -> list[Record]:
    """Fly all policies in all conditions and buildings, or load what was flown before.

    Parameters
    ----------
    policies : sequence of PolicySpec
        Who flies; what makes them can be pickled.
    extent : Extent
        How much.
    folder : Path
        Where maps and finished flights are kept.
    threads : int, optional
        Buildings that are flown in at the same time, each by a process; by default one a processor.
        The result does not depend on it.
    resume : bool
        Whether finished flights are taken from the folder.
    show : callable, optional
        Called as ``show(stage, done, total)``.
    """
    for part in ("maps", "flights"):
        (folder / part).mkdir(parents=True, exist_ok=True)
    total, count = extent.buildings, min(n_threads(threads), extent.buildings)
    records: dict[str, list[Record]] = {}
    shown = show or _show_nothing
    shown("buildings", 0, total)
    if count == 1 or multiprocessing.current_process().daemon:  # these may not have processes
        for building in buildings(extent):
            records[building.name] = fly_in(building, policies, extent, folder, resume)
            shown("buildings", len(records), total)
    else:
        with _processes(count) as pool:
            waiting = {
                pool.submit(fly_in, building, policies, extent, folder, resume): building.name
                for building in buildings(extent)
            }
            for done in as_completed(waiting):
                records[waiting[done]] = done.result()
                shown("buildings", len(records), total)
    order = sorted(records, key=lambda name: (name.partition("-")[0] == "paper", name))
    return [record for name in order for record in records[name]]


def _show_nothing(stage: str, done: int, total: int) -> None:
    pass


def buildings(extent: Extent) -> Iterator[Building]:
    """Yield the buildings of an extent; those that take longest first."""
    parts = [own(extent.plan_files)]
    if extent.paper:
        parts.append(paper())
    if extent.generated:
        parts.append(generated(extent.split, extent.generated))
    return chain(*parts)


_ENVIRONMENT = {
    **dict.fromkeys(("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"), "1"),
    # Semaphores that an interrupted run leaves are removed; there is no need to say so.
    "PYTHONWARNINGS": "ignore::UserWarning:multiprocessing.resource_tracker",
}


@contextmanager
def _processes(count: int) -> Generator[Executor]:
    """Processes that end with this one, and compute on one thread each."""
    before = {name: os.environ.get(name) for name in _ENVIRONMENT}
    os.environ.update(_ENVIRONMENT)
    context = multiprocessing.get_context("spawn")
    pool = ProcessPoolExecutor(count, mp_context=context, initializer=_end_with_parent)
    try:
        yield pool
    finally:
        pool.shutdown(wait=False, cancel_futures=True)
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value


def _end_with_parent() -> None:
    """Leave Ctrl-C to the parent process, and end when it has ended in any way."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)

    def watch() -> None:
        if (parent := multiprocessing.parent_process()) is not None:
            parent.join()
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


def fly_in(
    building: Building, policies: Sequence[PolicySpec], extent: Extent, folder: Path, resume: bool
) -> list[Record]:
    """Fly policies in a building, or load their flights."""
    worlds = _Worlds(building, folder / "maps")
    records: list[Record] = []
    for spec in policies:
        path = folder / "flights" / f"{building.name}-{_file_name(spec)}.json"
        key = {
            "version": BENCHMARK_VERSION,
            "tracer": TRACER_VERSION,
            "program": _program(),
            "building": building.fingerprint,
            "seeds": extent.seeds,
            "policy": [spec.name, spec.track, spec.source],
        }
        flown = _load(path, key) if resume else None
        if flown is None:
            flown = [
                _record(spec, condition, worlds, extent)
                for condition in conditions_of(building.site)
            ]
            rows = [asdict(record) for record in flown]
            with atomic_write(path) as temporary:
                temporary.write_text(json.dumps({**key, "sha256": _hash(rows), "records": rows}))
        records += flown
    return records


@cache
def _program() -> str:
    """Hash of the code that flights depend on beside the tracer: others are not resumed."""
    package = Path(__file__).parents[1]
    files = (file for part in _FLIGHT_CODE for file in sorted(package.glob(part)))
    return sha256(b"".join(file.read_bytes() for file in files)).hexdigest()


class _Worlds:
    """A building as its doors are in each condition, and its missions: each made once."""

    def __init__(self, building: Building, folder: Path) -> None:
        self.building, self._folder = building, folder
        self._made: dict[bool, tuple[Building, Mission]] = {}

    def of(self, condition: Condition) -> tuple[Building, Mission]:
        if condition.doors not in self._made:
            building = condition.building(self.building)
            self._made[condition.doors] = (building, building.mission(self._folder))
        return self._made[condition.doors]


def _file_name(spec: PolicySpec) -> str:
    name = f"{spec.track} {spec.name}"
    readable = re.sub(r"[^a-z0-9]+", "-", name.lower()).strip("-")
    return f"{readable}-{sha256(name.encode()).hexdigest()[:8]}"


def _load(path: Path, key: dict[str, Any]) -> list[Record] | None:
    """Records of a file of the same protocol and tracer; None without one, or a damaged one."""
    try:
        content = json.loads(path.read_text())
        expected = {**key, "sha256": _hash(content["records"])}
        if any(content[name] != value for name, value in expected.items()):
            return None
        return [Record(**record) for record in content["records"]]
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        return None


def _hash(rows: object) -> str:
    return sha256(json.dumps(rows).encode()).hexdigest()


def _record(spec: PolicySpec, condition: Condition, worlds: _Worlds, extent: Extent) -> Record:
    building, mission = worlds.of(condition)
    world, task = condition.world(mission), condition.task
    policy = Guarded.made(spec, Briefing(condition, spec.track, building, mission))
    sight = condition.observation(world_seen=spec.track == "world")
    fly(world, replace(task, max_steps=_WARMING_S), sight, policy, episodes=1)
    policy.collisions = 0
    begin_s = time.process_time()
    flown = [
        fly(
            world,
            task,
            sight,
            policy,
            episodes=flights_of_a_seed(building.site),
            seed=1000 * building.number + seed,
        )
        for seed in range(extent.seeds)
    ]
    cpu_s = time.process_time() - begin_s
    hops = Hypotheses.of_mission(mission, task).hops
    return Record(
        policy=spec.name,
        track=spec.track,
        condition=condition.name,
        site=building.site,
        building=building.name,
        found=_all(flown, lambda f: f.found),
        false_alarm=_all(flown, lambda f: f.false_alarm),
        steps=_all(flown, lambda f: f.steps),
        actions=_all(flown, lambda f: f.actions),
        shortest=_all(flown, lambda f: shortest(f, hops)),
        turns=_all(flown, lambda f: f.turns),
        energy_kj=_all(flown, lambda f: np.round(f.energy_kj, 3)),
        collisions=policy.collisions,
        cpu_s=round(cpu_s, 4),
    )


def shortest(flights: Flights, hops: NDArray[np.int32]) -> NDArray[np.int64]:
    """Steps of one who knows beforehand where the transmitter will be, and is there the earliest.

    At second t it can be found by a flight of ``hops[start, mode(t)]`` steps, if these are not more
    than t.

    Parameters
    ----------
    flights : Flights
        With the modes of N flights.
    hops : (S, M) int32
        Fewest steps from each cell to where it is found in each mode.
    """
    found: list[int] = []
    for cells, modes in zip(flights.cells, flights.modes, strict=True):
        steps = hops[cells[0], modes]
        in_time = np.flatnonzero(steps <= np.arange(steps.size))
        found.append(int(steps[in_time[0]] if in_time.size else steps[0]))
    return np.array(found, dtype=np.int64)


def _all(flown: Sequence[Flights], of: Callable[[Flights], Any]) -> list[Any]:
    return np.concatenate([of(flights) for flights in flown]).tolist()
