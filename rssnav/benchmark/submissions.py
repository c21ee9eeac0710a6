"""Results as a JSON file that others can merge with theirs: written, and read with checks."""

from __future__ import annotations

import json
import math
import platform
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import asdict, fields
from importlib.metadata import version
from pathlib import Path
from reprlib import repr as shown
from typing import Any, cast, get_args

from raytrace.trace import TRACER_VERSION
from rssnav.benchmark.buildings import Site
from rssnav.benchmark.errors import BenchmarkError
from rssnav.benchmark.policies import PolicySpec, Track
from rssnav.benchmark.protocol import (
    BENCHMARK_VERSION,
    CONDITIONS,
    MAX_STEPS,
    Extent,
    conditions_of,
    flights_of_a_seed,
)
from rssnav.benchmark.scores import WITHIN_S, Score
from rssnav.experiments.statistics import Estimate, mean


def as_json(scores: Sequence[Score], extent: Extent) -> str:
    """Results that others can compare with."""
    content = {
        "benchmark": "rssnav",
        "version": BENCHMARK_VERSION,
        "rssnav": version("rssnav"),
        "tracer": TRACER_VERSION,
        "python": platform.python_version(),
        "extent": extent.written,
        "scores": [asdict(score) for score in scores],
    }
    return json.dumps(content, indent=1) + "\n"


def read_scores(path: Path, extent: Extent) -> list[Score]:
    """Read the scores of a results.json that was made to the same extent.

    Raises
    ------
    BenchmarkError
        With the file, the entry and what is expected, unless it holds such results.
    """
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise BenchmarkError(f"{path}: {error.strerror}") from error
    except ValueError as error:
        raise BenchmarkError(f"{path}: {error}") from error
    except RecursionError as error:
        raise BenchmarkError(f"{path}: lists or tables are nested too deeply") from error
    if not isinstance(content, dict) or content.get("benchmark") != "rssnav":
        raise BenchmarkError(f"{path}: not a results.json of rssnav benchmark")
    for key, expected in (
        ("version", BENCHMARK_VERSION),
        ("extent", extent.written),
    ):
        if content.get(key) != expected:
            raise BenchmarkError(
                f"{path}: {key}: {shown(content.get(key))}; only results with {expected!r} compare "
                "with these"
            )
    rows = content.get("scores")
    if not isinstance(rows, list) or not rows:
        raise BenchmarkError(f"{path}: scores: expected a list with at least one entry")
    found = [_score(row, f"{path}: scores[{k}]", extent) for k, row in enumerate(rows)]
    _check_whole(found, extent, path)
    return found


def _check_whole(found: Sequence[Score], extent: Extent, path: Path) -> None:
    """Check that every policy flew in all conditions and sites."""
    sites: list[Site] = [site for site, n in extent.buildings_of.items() if n > 0]
    expected = sum(len(conditions_of(site)) for site in sites)
    for (name, track), count in Counter((s.policy, s.track) for s in found).items():
        if count != expected:
            raise BenchmarkError(
                f"{path}: scores: {name!r} of track {track!r} has {count} entries; expected "
                f"{expected}, one for each condition in each of {len(sites)} kinds of buildings"
            )


def merged(parts: Sequence[Sequence[Score]]) -> list[Score]:
    """Scores of several files.

    Raises
    ------
    BenchmarkError
        When two have a policy of the same name and track.
    """
    found: dict[tuple[str, ...], Score] = {}
    for score in (score for part in parts for score in part):
        key = (score.site, score.condition, score.track, score.policy)
        if key in found:
            raise _twice(score.policy, score.track)
        found[key] = score
    return list(found.values())


def check_names(policies: Sequence[PolicySpec], others: Sequence[Score]) -> None:
    """Check that no policy that is to fly has name and track of one with scores.

    Raises
    ------
    BenchmarkError
        When one has.
    """
    taken = {(score.policy, score.track) for score in others}
    for spec in policies:
        if (spec.name, spec.track) in taken:
            raise _twice(spec.name, spec.track)


def _twice(policy: str, track: str) -> BenchmarkError:
    return BenchmarkError(
        f"policy {policy!r} of track {track!r} is in two results; give one another name (--name)"
    )


def _score(row: Any, where: str, extent: Extent) -> Score:
    if not isinstance(row, dict):
        raise BenchmarkError(f"{where}: expected a table, got {shown(row)}")
    names = [field.name for field in fields(Score)]
    for name in names:
        if name not in row:
            raise BenchmarkError(f"{where}: {name} is missing")
        holds, expected = _EXPECTED[name]
        if not holds(row[name]):
            raise BenchmarkError(f"{where}: {name}: {shown(row[name])}; expected {expected}")
    if unknown := sorted(set(row) - set(names)):
        raise BenchmarkError(f"{where}: {unknown[0]}: no such key; there are {', '.join(names)}")
    for name in ("spl", "success", "false_alarms"):
        row = {**row, name: Estimate(**row[name])}
    score = Score(**row)
    _check_together(score, where, extent)
    return score


def _check_together(score: Score, where: str, extent: Extent) -> None:
    """Check what must hold between the numbers of an entry."""
    by_building, n = score.spl_by_building, extent.buildings_of.get(cast(Site, score.site), 0)
    flights = n * extent.seeds * flights_of_a_seed(cast(Site, score.site))
    for holds, expected in (
        (n > 0, "site: one of this extent"),
        (len(by_building) == n, f"spl_by_building: {n} numbers"),
        (score.flights == flights, f"flights: {flights}"),
        (abs(sum(by_building) / len(by_building) - score.spl.value) < 1e-3, "spl: the mean of "
         "spl_by_building"),
        (score.spl.value <= score.success.value + 1e-3, "spl: at most success"),
        (score.success.value + score.false_alarms.value <= 1.001, "success and false_alarms: at "
         "most 1 together"),
        (score.found_within == sorted(score.found_within), "found_within: numbers that rise"),
        (abs(score.found_within[-1] - score.success.value) < 1e-3, "found_within: success at last"),
        (_is_median(score), "median_s: the time at which found_within is a half, or null"),
        (_is_interval(score), "spl: the interval of spl_by_building"),
        (score.turns <= MAX_STEPS, f"turns: at most {MAX_STEPS}, the steps of a flight"),
    ):  # fmt: skip
        if not holds:
            raise BenchmarkError(f"{where}: expected {expected}")


def _is_median(score: Score) -> bool:
    """Whether half of the flights have found the transmitter at the median, and no earlier."""
    found = math.inf if score.median_s is None else score.median_s
    return all(
        (found <= limit) == (part >= 0.5) or abs(part - 0.5) < 1e-4  # parts are rounded
        for limit, part in zip(WITHIN_S, score.found_within, strict=True)
    )


def _is_interval(score: Score) -> bool:
    """Whether the interval of SPL is that of the buildings, up to other draws of the bootstrap."""
    expected = mean(score.spl_by_building)
    return max(abs(score.spl.low - expected.low), abs(score.spl.high - expected.high)) < 0.005


def _number(low: float, high: float) -> Callable[[Any], bool]:
    def holds(value: Any) -> bool:
        return (
            isinstance(value, int | float)
            and not isinstance(value, bool)
            and low <= value <= high
            and math.isfinite(value)
        )

    return holds


_part, _positive = _number(0.0, 1.0), _number(0.0, 1e12)


def _is_whole(value: Any) -> bool:
    return isinstance(value, int) and not isinstance(value, bool) and 0 <= value < 2**63


def _is_text(value: Any) -> bool:
    return isinstance(value, str) and 0 < len(value) <= 80 and value.isprintable()


def _is_estimate(value: Any) -> bool:
    if not isinstance(value, dict) or set(value) != {"value", "low", "high"}:
        return False
    return all(map(_part, value.values())) and value["low"] <= value["value"] <= value["high"]


def _are_parts(value: Any, count: int | None = None) -> bool:
    right = isinstance(value, list) and len(value) == (count or len(value)) > 0
    return right and all(map(_part, value))


def _one_of(names: Sequence[str]) -> tuple[Callable[[Any], bool], str]:
    return (lambda value: value in names), " or ".join(map(repr, names))


_ESTIMATE = (_is_estimate, "low <= value <= high, all in [0, 1]")

_EXPECTED: dict[str, tuple[Callable[[Any], bool], str]] = {
    "site": _one_of(get_args(Site)),
    "condition": _one_of([condition.name for condition in CONDITIONS]),
    "policy": (_is_text, "a name of at most 80 printable characters"),
    "track": _one_of(get_args(Track)),
    "flights": (lambda v: _is_whole(v) and v > 0, "a positive whole number"),
    "spl_by_building": (_are_parts, "a list of numbers in [0, 1]"),
    "spl": _ESTIMATE,
    "success": _ESTIMATE,
    "false_alarms": _ESTIMATE,
    "median_s": (lambda v: v is None or _positive(v), "a number of seconds or null"),
    "found_within": (lambda v: _are_parts(v, len(WITHIN_S)), f"{len(WITHIN_S)} parts in [0, 1]"),
    "energy_kj": (_positive, "a number that is not negative"),
    "turns": (_positive, "a number that is not negative"),
    "collisions": (_is_whole, "a whole number"),
    "step_us": (_positive, "a number that is not negative"),
}
