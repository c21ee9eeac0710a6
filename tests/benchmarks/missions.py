"""Energy and a transmitter that jumps in Scenario 1 beside oracles, and confirmation of the goal.

    python tests/benchmarks/missions.py

prints the numbers of docs/how_to/energy_and_moving_sources.md, in two minutes of processor time.
"""

from __future__ import annotations

import math
import time
from itertools import product

import numpy as np

import floorplans
from rssnav import Fluctuation, GridWorld, QLearning
from rssnav.benchmark.buildings import generated
from rssnav.maps import make_map
from rssnav.mission_training import train_mission
from rssnav.missions import (
    Mission,
    ModeProcess,
    MultirotorEnergy,
    Observation,
    ReadingAbove,
    Task,
    Within,
    fly,
    learn_by_model,
    mission_of_places,
    plan_mission,
    spread_places,
)
from rssnav.policies import DistanceSearch, FrontierSearch, GaussianProcessSearch

SEEDS = 5
STEPS = 30_000_000
GOAL = ReadingAbove(-21.0)


def energy(mission: Mission) -> None:
    """Least energy, fewest steps, and Q-learning without and with headings."""
    task = Task(GOAL, energy=MultirotorEnergy(), max_steps=500)
    for minimise in ("energy", "steps"):
        plan = plan_mission(mission, task, minimise)
        row(f"oracle, {plan.policy.name}", fly(mission, task, plan.observation, plan.policy))
    for heading, per_kj in ((False, 0.0), (True, -20.0)):
        sight = Observation(None, cell=True, heading=heading)
        paid = Task(GOAL, energy=MultirotorEnergy(), per_kj=per_kj)
        decay = math.log(100.0) / (0.5 * STEPS)
        learning = QLearning(eta=decay, initial_q=200.0 if heading else 100.0)
        for seed in range(SEEDS):
            table = train_mission(mission, paid, sight, steps=STEPS, seed=seed, learning=learning)
            row(f"Q-learning, heading {heading}", fly(mission, task, sight, table, episodes=1))


def row(name, flights) -> None:
    print(
        f"{name}: found {flights.found.mean():.2f}, {flights.steps.mean():.1f} steps, "
        f"{flights.energy_kj.mean():.2f} kJ, {flights.turns.mean():.1f} turns"
    )


def jumps() -> None:
    """Five places, a jump with probability 0.005 a second."""
    plan = floorplans.load("scenario1")
    mission = mission_of_places(plan, spread_places(plan, 5), modes=ModeProcess.jumping(5, 0.005))
    task = Task(Within(2.0), "none", per_second=-1.0, max_steps=2000)
    oracle = plan_mission(mission, task)
    print(f"value iteration: {oracle.expected:.1f} steps expected")
    row("value iteration", fly(mission, task, oracle.observation, oracle.policy, episodes=1000))
    everywhere = mission.from_starts(np.arange(mission.n_states))
    begin = time.process_time()
    table, sight = learn_by_model(everywhere, task, steps=1_000_000)
    print(f"planning on counts: {time.process_time() - begin:.1f} s")
    row("planning on counts", fly(mission, task, sight, table, episodes=1000))


def confirmation() -> None:
    """False alarms of searchers in generated buildings, by the rule that confirms the goal."""
    folds = [(building.layout, building.mission()) for building in generated("train", 12)]
    rules = {
        "one reading": ReadingAbove(-21.0),
        "mean of 16": ReadingAbove(-21.0, 16),
        "mean of 64": ReadingAbove(-21.0, 64),
        "test": ReadingAbove(-21.0, 64, 0.002),
    }
    for sigma_db, (name, goal) in product((2.0, 4.0), rules.items()):
        sight = Observation(None, cell=True, fluctuation=Fluctuation(sigma_db))
        task = Task(goal, "none", max_steps=400)
        flown = [
            (mission, fly(mission, task, sight, make(layout), episodes=20, seed=1))
            for layout, mission in folds
            for make in (DistanceSearch, FrontierSearch, GaussianProcessSearch)
        ]
        alarms = np.concatenate([flights.false_alarm for _, flights in flown])
        below_db = [
            goal.level_dbm - mission.rss_dbm[modes[-1], cells[-1]]
            for mission, flights in flown
            for modes, cells, alarm in zip(
                flights.modes, flights.cells, flights.false_alarm, strict=True
            )
            if alarm
        ]
        print(
            f"{sigma_db:g} dB, {name}: {alarms.sum()} false alarms of {alarms.size}, "
            f"{np.median(below_db) if below_db else 0:.1f} dB below the level, found "
            f"{np.mean([f.found for _, f in flown]):.3f} after "
            f"{np.mean([f.steps.mean() for _, f in flown]):.0f} s, "
            f"{np.mean([(f.steps - f.actions).mean() for _, f in flown]):.0f} of them in place"
        )


if __name__ == "__main__":
    plan = floorplans.load("scenario1")
    one = GridWorld.from_map(plan, make_map(plan), 1).mission()
    energy(one)
    jumps()
    confirmation()
