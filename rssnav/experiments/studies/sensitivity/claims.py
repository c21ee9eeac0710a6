"""Table of the sensitivity study: in how many cases the paper's claims hold under each choice.

By means alone, without intervals: it shows which choice decides a claim.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise, product

import numpy as np
from numpy.typing import NDArray

from rssnav.experiments.paper.claims.learning import GOOD_FACTOR, GOOD_FRACTION
from rssnav.experiments.paper.data import AGENTS, Configuration
from rssnav.experiments.paper.scenarios import SPEEDS
from rssnav.experiments.studies.sensitivity.alternatives import Alternative, Outcome
from rssnav.experiments.tables import Cell, Column, Table

ByKey = dict[Configuration, Outcome]
Values = NDArray[np.float64] | None

_SCENARIOS = (1, 2)


def claims_table(outcomes: Sequence[Outcome]) -> Table:
    """Make a row per alternative.

    Parameters
    ----------
    outcomes : sequence of Outcome
        All outcomes.

    Returns
    -------
    Table
    """
    alternatives = dict.fromkeys(outcome.alternative for outcome in outcomes)
    return Table(
        "sensitivity_claims",
        "Which choices decide the paper's claims",
        "Cases that agree with the claim by their means, of those in which both sides have a mean. "
        "Farther, more turns: the RSS-based agent's final flight, at each speed in each scenario. "
        "Episodes, flight time: until convergence, from each speed to the next for each agent in "
        f"each scenario. Good: agents in Scenario 1 at {SPEEDS[0]} m/s of which at least "
        f"{GOOD_FRACTION:.0%} of the final flights take at most {GOOD_FACTOR:g} times the fewest "
        "steps.",
        (
            Column("parameter", "Parameter"),
            Column("choice", "Choice"),
            Column("farther", "RSS farther"),
            Column("more_turns", "RSS more turns"),
            Column("episodes_fall", "Episodes fall"),
            Column("flight_time_falls", "Flight time falls"),
            Column("good", "Good"),
        ),
        tuple(
            _row(choice, {o.key: o for o in outcomes if o.alternative == choice})
            for choice in alternatives
        ),
    )


def _row(choice: Alternative, found: ByKey) -> tuple[Cell, ...]:
    agents = [
        tuple(Configuration(scenario, agent, speed) for agent in AGENTS)
        for scenario, speed in product(_SCENARIOS, SPEEDS)
    ]
    speeds = [
        (Configuration(scenario, agent, slow), Configuration(scenario, agent, fast))
        for scenario, agent in product(_SCENARIOS, AGENTS)
        for slow, fast in pairwise(SPEEDS)
    ]
    return (
        choice.parameter,
        choice.choice,
        _greater(agents, found, lambda outcome: outcome.length_m),
        _greater(agents, found, lambda outcome: outcome.turns),
        _greater(speeds, found, lambda outcome: outcome.episodes),
        _greater(speeds, found, lambda outcome: outcome.steps),
        _good([found[key] for key in agents[0] if key in found]),
    )


def _greater(
    pairs: Sequence[tuple[Configuration, ...]], found: ByKey, values: Callable[[Outcome], Values]
) -> str:
    """Count pairs whose first configuration has the greater mean, and those that have means."""
    compared: list[bool] = []
    for pair in pairs:
        sides = [values(found[key]) for key in pair if key in found]
        means = [side.mean() for side in sides if side is not None and side.size]
        if len(means) == len(pair):
            compared.append(bool(means[0] > means[1]))
    return f"{sum(compared)} of {len(compared)}"


def _good(outcomes: Sequence[Outcome]) -> str:
    good = [
        np.count_nonzero(o.path_steps <= GOOD_FACTOR * o.fewest_steps) >= GOOD_FRACTION * o.runs
        for o in outcomes
    ]
    return f"{sum(good)} of {len(good)}"
