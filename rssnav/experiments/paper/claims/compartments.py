"""The claim about the compartments that final flights pass through."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import shapely
from numpy.typing import NDArray

from floorplans import FloorPlan
from rssnav.experiments.paper.claims.verdicts import Case, Claim, between, case, undecided
from rssnav.experiments.paper.data import AGENT_LABELS, PaperData, flights
from rssnav.experiments.statistics import mean
from rssnav.results import TrainingResult

SCENARIO = 2
"""The scenario with compartments."""

ENTERED_BELOW = 2
"""Speed from which on the paper says that flights avoid compartments [m/s]."""


def compartments(plan: FloorPlan) -> shapely.MultiPolygon:
    """Return the spaces of a plan that hold neither source nor start when every door is closed."""
    closed = shapely.linestrings([[wall.start, wall.end] for wall in plan.walls])
    spaces = shapely.get_parts(shapely.polygonize([shapely.union_all(closed)]))
    ends = shapely.points([plan.require_source()[:2], plan.require_start()])
    return shapely.MultiPolygon([s for s in spaces if not shapely.intersects(s, ends).any()])


def enters(plan: FloorPlan, result: TrainingResult) -> NDArray[np.float64]:
    """Return 1 for each final flight (n,) with a cell in a compartment, otherwise 0."""
    rooms = compartments(plan)
    shapely.prepare(rooms)
    inside = shapely.contains_xy(rooms, *result.world.position.T)
    return np.array([float(inside[flight].any()) for flight in flights(result)])


def _cases(data: PaperData) -> Iterator[Case]:
    plan = data.scenarios[SCENARIO].plan
    for speed in data.speeds:
        expected = "enters" if speed < ENTERED_BELOW else "avoids"
        name = f"Scenario {SCENARIO}, {speed} m/s, {expected} compartments"
        location, rss = (
            enters(plan, data.result(SCENARIO, agent, speed)) for agent in ("location", "rss")
        )
        if location.size == 0 or compartments(plan).is_empty:
            yield undecided(name)
            continue
        compared = [(AGENT_LABELS["location"], float(location.mean()))]
        if rss.size:
            compared.append((AGENT_LABELS["rss"], float(rss.mean())))
        decide = between(0.5, 1.0) if speed < ENTERED_BELOW else between(0.0, 0.5)
        yield case(name, compared, mean(location), decide)


CLAIMS = (
    Claim(
        "location-enters-compartments",
        "At 1 m/s the location-based agent tends to enter compartments, which are nearer to the "
        "victim than the hallway; at higher speeds it avoids them.",
        "Final flights with a cell in a space that holds neither source nor start when all doors "
        "are closed. Reproduced at 1 m/s where at least half of them do, and at higher speeds "
        "where at most half of them do.",
        "fraction of the location-based agent's flights",
        lambda data: list(_cases(data)),
    ),
)
