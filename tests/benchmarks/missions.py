"""Energy, a transmitter that jumps, and confirmation of the goal in Scenario 1, beside oracles.

    python tests/benchmarks/missions.py

prints the numbers of docs/how_to/energy_and_moving_sources.md, in about a minute of processor time.
"""

from __future__ import annotations

import math
import time

import numpy as np

import floorplans
from rssnav import Fluctuation, GridWorld, IntervalStates, QLearning
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


def confirmation(mission: Mission) -> None:
    """False alarms on the way that a table of steps flies, at 2 dB."""
    oracle = plan_mission(mission, Task(GOAL))
    bins = Observation(IntervalStates((-30.0,)), cell=True, fluctuation=Fluctuation(2.0))
    for readings in (1, 4, 16, 64):
        task = Task(ReadingAbove(-21.0, readings), max_steps=20_000)
        policy = _ByCell(oracle.policy.q)
        flights = fly(mission, task, bins, policy, episodes=500)
        print(
            f"{readings} readings: false alarms {flights.false_alarm.mean():.3f}, found "
            f"{flights.found.mean():.3f} after {flights.steps[flights.found].mean():.1f} s"
        )


class _ByCell:
    """Acts by the cell alone; in a goal cell that readings do not confirm, at random."""

    name = "fewest steps"

    def __init__(self, q) -> None:
        self.q = q

    def begin(self, generator) -> None:
        self.generator = generator

    def act(self, observation, mask) -> int:
        row = np.where(mask, self.q[observation.cell], -np.inf)
        if row.max() <= -1e8 or np.ptp(row[mask]) == 0.0:
            return int(self.generator.choice(np.flatnonzero(mask)))
        return int(np.argmax(row))


if __name__ == "__main__":
    plan = floorplans.load("scenario1")
    one = GridWorld.from_map(plan, make_map(plan), 1).mission()
    energy(one)
    jumps()
    confirmation(one)
