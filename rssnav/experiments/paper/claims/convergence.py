"""Claims about convergence, in each of three interpretations of the paper's "time"."""

from __future__ import annotations

from collections.abc import Iterator

from rssnav.experiments.paper.claims.comparing import agents_alike, falls_with_speed
from rssnav.experiments.paper.claims.verdicts import Case, Claim, Verdict, between
from rssnav.experiments.paper.convergence_measures import MEASURES, Measure, converged
from rssnav.experiments.paper.data import PaperData
from rssnav.experiments.statistics import mean

ENOUGH = 0.99
COMPARABLE = 1.25


def _falls(data: PaperData, measure: Measure) -> list[Case]:
    return [
        each for scenario in data.scenarios for each in falls_with_speed(data, scenario, measure.of)
    ]


def _falls_with_speed(measure: Measure) -> Claim:
    return Claim(
        f"{measure.name.replace('_', '-')}-falls",
        f"Convergence time falls with speed for both agents (measured as {measure.title}).",
        f"Mean {measure.title} to convergence, over the runs that converge. Reproduced where each "
        "speed takes less than the next slower one.",
        f"{measure.heading}, slower minus faster",
        lambda data: _falls(data, measure),
    )


def _comparable(data: PaperData) -> list[Case]:
    decide = between(1.0 / COMPARABLE, COMPARABLE)
    fastest = max(data.speeds)
    return [
        agents_alike(data, scenario, fastest, measure.of, decide, measure.title)
        for scenario in data.scenarios
        for measure in MEASURES
    ]


def _all_converge(data: PaperData) -> Iterator[Case]:
    for key, result in data.results.items():
        estimate = mean(converged(result))
        verdict = Verdict.REPRODUCED if estimate.value >= ENOUGH else Verdict.NOT_REPRODUCED
        compared = (
            ("converged", float(converged(result).sum())),
            ("runs", float(result.run_ids.size)),
        )
        yield Case(key.label, compared, estimate, verdict)


CLAIMS = (
    Claim(
        "all-converge",
        "Both algorithms converge.",
        "Fraction of runs that fly the same path in three consecutive episodes. Reproduced where "
        f"it is at least {100 * ENOUGH:g} % of the runs.",
        "fraction of runs",
        lambda data: list(_all_converge(data)),
    ),
    *(_falls_with_speed(measure) for measure in MEASURES),
    Claim(
        "comparable-at-high-speed",
        "At high speed the RSS-based agent converges about as fast as the location-based one.",
        "Ratio of the mean times to convergence at the highest speed, in each interpretation of "
        f"time. Reproduced where it lies within a factor {COMPARABLE:g}.",
        "ratio of times, RSS-based over location-based",
        _comparable,
    ),
)
