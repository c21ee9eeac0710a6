"""Flights of the benchmark, made up."""

from __future__ import annotations

from rssnav.benchmark.protocol import CONDITIONS, Extent
from rssnav.benchmark.running import Record

SMALL = Extent(generated=2, paper=False, seeds=1)
"""Of two buildings with three flights in each condition."""


def record(**changes) -> Record:
    """Three flights: one by the fewest steps, one with a detour and readings in place, one lost."""
    flights = {
        "found": [True, True, False],
        "false_alarm": [False, False, True],
        "steps": [10, 30, 50],
        "actions": [10, 25, 50],
        "shortest": [10, 20, 12],
        "turns": [1, 2, 3],
        "energy_kj": [1.0, 2.0, 6.0],
    }
    who = {"policy": "a", "track": "RSS", "condition": "2 dB", "site": "test", "building": "b"}
    return Record(**{**who, **flights, "collisions": 4, "cpu_s": 0.009, **changes})


def records() -> list[Record]:
    """Flights in all conditions and both buildings of `SMALL`."""
    return [
        made
        for condition in CONDITIONS
        for made in (
            record(condition=condition.name),
            record(condition=condition.name, building="c", steps=[300, 30, 40]),
        )
    ]
