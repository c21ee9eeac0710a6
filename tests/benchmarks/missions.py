"""Energy and a transmitter that jumps in Scenario 1 beside oracles, doors, confirmation of goals.

    python tests/benchmarks/missions.py [energy] [jumps] [doors] [confirmation]

prints the numbers of docs/how_to/energy_and_moving_sources.md, all in four minutes of processor
time.
"""

from __future__ import annotations

import math
import sys
import time
from dataclasses import replace
from itertools import islice, product

import numpy as np

import floorplans
from rssnav import Fluctuation, GridWorld, QLearning
from rssnav.benchmark.buildings import Building, generated
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
from rssnav.missions.door_planning import plan_by_sight
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


def doors() -> None:
    """Doors of generated buildings: known, seen, remembered or not; and learned with a memory."""
    steps: dict[str, list[float]] = {}
    for building in islice(generated("validation", 12), 12):
        mission = building.with_doors.mission()
        task = Task(GOAL, "none", max_steps=400)
        known, seen = plan_mission(mission, task), plan_by_sight(mission, task)
        opened = plan_mission(mission.with_modes(_all_open(mission)), task)
        for name, plan in (("known", known), ("seen", seen), ("all open", opened)):
            steps.setdefault(name, []).append(plan.expected)
    for name, values in steps.items():
        print(f"doors {name}: {np.mean(values):.2f} steps expected")
    for building in islice(generated("validation", 12), 2, 12, 3):
        learned_doors(building.with_doors)


def _all_open(mission: Mission) -> ModeProcess:
    """Modes of a mission whose doors never close."""
    even = np.where(mission.closed.any(axis=1), 0.0, 1.0)
    return ModeProcess(even / even.sum(), np.eye(even.size))


def learned_doors(building: Building) -> None:
    """Q-learning with a memory of doors and without, for one place and one start."""
    mission = replace(building, places=building.places[:1]).mission()
    task = Task(GOAL, "none", per_second=-1.0, goal_reward=0.0, max_steps=400)
    mission = mission.from_starts(mission.starts[-1:])
    known, seen = plan_mission(mission, task), plan_by_sight(mission, task)
    found = [f"known {known.expected:.1f}", f"seen {seen.expected:.1f}"]
    for memory in (True, False):
        sight = Observation(None, cell=True, doors=memory)
        decay = math.log(100.0) / (0.5 * STEPS)
        learning = QLearning(eta=decay, initial_q=0.0)
        table = train_mission(mission, task, sight, steps=STEPS, learning=learning)
        flights = fly(mission, task, sight, table, episodes=200)
        name = "with memory" if memory else "without"
        found.append(f"{name} {flights.steps.mean():.1f} (found {flights.found.mean():.2f})")
    print(f"Q-learning, {building.name}: {', '.join(found)}")


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


def energy_in_scenario1() -> None:
    """Energy with the paper's transmitter."""
    plan = floorplans.load("scenario1")
    energy(GridWorld.from_map(plan, make_map(plan), 1).mission())


PARTS = {
    "energy": energy_in_scenario1, "jumps": jumps, "doors": doors, "confirmation": confirmation,
}  # fmt: skip

if __name__ == "__main__":
    for part in sys.argv[1:] or PARTS:
        PARTS[part]()
