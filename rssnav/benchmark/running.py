"""Flights of all entrants, saved building by building, so that a run can be resumed."""

from __future__ import annotations

import json
import re
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from atomicfiles import atomic_write
from rssnav.benchmark.buildings import Building, buildings
from rssnav.benchmark.entrants import Briefing, Entrant, Guarded
from rssnav.benchmark.protocol import BENCHMARK_VERSION, CONDITIONS, Condition, Extent
from rssnav.missions import Flights, Mission, fly
from rssnav.policies import Hypotheses

Show = Callable[[str, int, int], None]


@dataclass(frozen=True)
class Record:
    """Flights of an entrant in a task and a building; lists have an item for each flight.

    Attributes
    ----------
    entrant, knows, condition, building : str
        Who, its track, which task, where.
    found, false_alarm : list of bool
        As of `rssnav.missions.Flights`.
    steps, shortest, turns : list of int
        Seconds flown, fewest that were possible at the begin, changes of direction.
    energy_kj : list of float
        Energy [kJ].
    collisions : int
        Impossible actions of all flights.
    cpu_s : float
        Processor time of all flights [s].
    """

    entrant: str
    knows: str
    condition: str
    building: str
    found: list[bool]
    false_alarm: list[bool]
    steps: list[int]
    shortest: list[int]
    turns: list[int]
    energy_kj: list[float]
    collisions: int
    cpu_s: float


def run(
    entrants: Sequence[Entrant],
    extent: Extent,
    folder: Path,
    *,
    threads: int | None = None,
    resume: bool = True,
    show: Show | None = None,
) -> list[Record]:
    """Fly all entrants in all tasks and buildings, or load what was flown before.

    Parameters
    ----------
    entrants : sequence of Entrant
        Who flies.
    extent : Extent
        How much.
    folder : Path
        Where maps and finished flights are kept.
    threads : int, optional
        Of the tracer.
    resume : bool
        Whether finished flights are taken from the folder.
    show : callable, optional
        Called as ``show(stage, done, total)``.
    """
    records: list[Record] = []
    maps = folder / "maps"
    maps.mkdir(parents=True, exist_ok=True)
    for number, building in enumerate(buildings(extent.split, extent.buildings)):
        if show is not None:
            show("buildings", number, extent.buildings)
        records += _fly_in(building, entrants, extent, folder, threads, resume=resume)
    if show is not None:
        show("buildings", extent.buildings, extent.buildings)
    return records


def _fly_in(
    building: Building,
    entrants: Sequence[Entrant],
    extent: Extent,
    folder: Path,
    threads: int | None,
    *,
    resume: bool,
) -> Iterator[Record]:
    mission: Mission | None = None
    for entrant in entrants:
        path = folder / "flights" / f"{building.name}-{_file_name(entrant)}.json"
        key = {"version": BENCHMARK_VERSION, "seeds": extent.seeds, "flights": extent.flights}
        saved = _load(path, key) if resume else None
        if saved is None:
            mission = mission or building.mission(folder / "maps", threads)
            policy = entrant.make(Briefing(building, entrant.knows))
            saved = [
                _record(entrant, condition, building, mission, Guarded(policy), extent)
                for condition in CONDITIONS
            ]
            path.parent.mkdir(parents=True, exist_ok=True)
            with atomic_write(path) as temporary:
                temporary.write_text(json.dumps({**key, "records": [asdict(r) for r in saved]}))
        yield from saved


def _file_name(entrant: Entrant) -> str:
    return re.sub(r"[^a-z0-9]+", "-", f"{entrant.knows} {entrant.name}".lower()).strip("-")


def _load(path: Path, key: dict[str, Any]) -> list[Record] | None:
    """Records of a file made by the same protocol; None without one."""
    try:
        content = json.loads(path.read_text())
        if any(content[name] != value for name, value in key.items()):
            return None
        return [Record(**record) for record in content["records"]]
    except (OSError, ValueError, KeyError, TypeError):
        return None


def _record(
    entrant: Entrant,
    condition: Condition,
    building: Building,
    mission: Mission,
    policy: Guarded,
    extent: Extent,
) -> Record:
    world, task = condition.world(mission), condition.task
    begin_s, before = time.process_time(), policy.collisions
    flown = [
        fly(
            world,
            task,
            condition.observation,
            policy,
            episodes=extent.flights,
            seed=1000 * building.number + seed,
        )
        for seed in range(extent.seeds)
    ]
    hops = Hypotheses.of_mission(mission, task).hops
    return Record(
        entrant=entrant.name,
        knows=entrant.knows,
        condition=condition.name,
        building=building.name,
        found=_all(flown, lambda f: f.found),
        false_alarm=_all(flown, lambda f: f.false_alarm),
        steps=_all(flown, lambda f: f.steps),
        shortest=_all(
            flown,
            lambda f: np.array([hops[c[0], m[0]] for c, m in zip(f.cells, f.mode, strict=True)]),
        ),
        turns=_all(flown, lambda f: f.turns),
        energy_kj=_all(flown, lambda f: np.round(f.energy_kj, 3)),
        collisions=policy.collisions - before,
        cpu_s=round(time.process_time() - begin_s, 4),
    )


def _all(flown: Sequence[Flights], of: Callable[[Flights], Any]) -> list[Any]:
    return np.concatenate([of(flights) for flights in flown]).tolist()
