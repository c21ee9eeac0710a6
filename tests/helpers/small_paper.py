"""The paper's experiments in miniature: a small building, its map by a formula, few runs."""

from __future__ import annotations

from functools import cache

import numpy as np

import floorplans
from raytrace import Grid, RadioMap, TraceConfig, Transmitter
from rssnav.experiments.paper.data import (
    AGENTS,
    CONFIGURATIONS,
    SHOWN_EPISODES,
    VISIT_EPISODES,
    VISITS_CONFIGURATIONS,
    PaperData,
)
from rssnav.experiments.paper.first_episodes import first_episodes
from rssnav.experiments.paper.scenarios import Scenario, make_worlds
from rssnav.training import train

RUNS = 3

PLAN = """
name = "{name}"
format = 1
height_m = 3.0
floor_material = "concrete"
ceiling_material = "concrete"
source = [3, 6, 1.5]
start = [{start_x}, 6.5]
outline = [[0, 0], [{length}, 0], [{length}, 12], [0, 12], [0, 0]]

[[walls]]
points = [[0, 0], [{length}, 0], [{length}, 12], [0, 12], [0, 0]]
material = "concrete"
thickness_m = 0.2

[[walls]]
points = [[8, 0], [8, 4]]
material = "plasterboard"
thickness_m = 0.1
"""


def plan_text(number):
    length = 16 + 4 * number
    return PLAN.format(name=f"small{number}", length=length, start_x=length - 1.5)


def log_distance_map(plan):
    """RSS that falls with distance, the same in no two cells, above -21 dBm within 2 m."""
    grid = Grid.over(plan.bounds, 1.0, 2.0)
    distance_m = np.hypot(grid.x[None, :] - plan.source[0], grid.y[:, None] - plan.source[1])
    rss_dbm = -20.5 - 25.0 * np.log10(distance_m / 1.9)
    return RadioMap(
        rss_dbm + 1e-6 * np.arange(rss_dbm.size).reshape(rss_dbm.shape),
        rss_dbm,
        np.ones(rss_dbm.shape, dtype=np.int64),
        grid,
        Transmitter(plan.source),
        TraceConfig(),
        floorplans.dumps(plan),
        plan.sha256,
    )


@cache
def small_data():
    plans = {number: floorplans.loads(plan_text(number)) for number in (1, 2)}
    scenarios = {number: Scenario(plan, log_distance_map(plan)) for number, plan in plans.items()}
    worlds = make_worlds(scenarios)
    results = {
        key: train(
            worlds[key.scenario, key.speed],
            AGENTS[key.agent],
            runs=RUNS,
            episodes=20_000,
            until_converged=True,
            snapshot_episodes=VISIT_EPISODES,
        )
        for key in CONFIGURATIONS
    }
    first = {
        key: first_episodes(results[key], VISIT_EPISODES[0], SHOWN_EPISODES)
        for key in VISITS_CONFIGURATIONS
    }
    return PaperData(scenarios, results, first)
