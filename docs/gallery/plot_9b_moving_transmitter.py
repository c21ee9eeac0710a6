"""
A transmitter that moves during the flight
==========================================

The transmitter jumps among five places. How long does an agent need that learned before, and how
long one that sees all jumps and knows how often they come?
"""

import math

import matplotlib.pyplot as plt
import numpy as np

import floorplans
from raytrace import TraceConfig
from rssnav import IntervalStates, QLearning
from rssnav.mission_training import train_mission
from rssnav.missions import (
    ModeProcess,
    Observation,
    Task,
    Within,
    fly,
    learn_by_model,
    mission_of_places,
    plan_mission,
    spread_places,
)
from rssnav.pictures.radio_map import draw_walls, set_limits
from rssnav.pictures.style import INK, PAGE_IN, STYLE

plt.rcParams.update(STYLE)

PLACES, STEPS, LIMIT_S = 5, 10_000_000, 1000
plan = floorplans.load("scenario1")
steady = mission_of_places(plan, spread_places(plan, PLACES), config=TraceConfig(1, 1))
task = Task(Within(2.0), "rss", max_steps=LIMIT_S)
learning = QLearning(eta=math.log(100.0) / (0.5 * STEPS))

# %%
# Value iteration on cells and places is the oracle. Q-learning has a row for each cell and place in
# the same way, or for each cell and interval of 5 dB of the reading; its reward is the RSS
# difference, without which it takes several times as long. Planning on counts explores at
# random for 300 000 s, counts where actions lead and how often places change, and plans on that.
PROBABILITIES = (0.0, 0.005, 0.02)
SIGHTS = {
    "Q-learning, cell and place": Observation(None, cell=True, mode=True),
    "Q-learning, cell and 5 dB": Observation(IntervalStates(tuple(range(-95, -19, 5))), cell=True),
}
found: dict[str, list[float]] = {}
for probability in PROBABILITIES:
    mission = steady.with_modes(ModeProcess.jumping(PLACES, probability))
    oracle = plan_mission(mission, task)
    who = {"oracle": (oracle.observation, oracle.policy)}
    everywhere = mission.from_starts(np.arange(mission.n_states))
    policy, sight = learn_by_model(everywhere, task, steps=300_000)
    who["planning on counts"] = (sight, policy)
    for name, sight in SIGHTS.items():
        who[name] = (sight, train_mission(mission, task, sight, steps=STEPS, learning=learning))
    for name, (sight, policy) in who.items():
        flights = fly(mission, task, sight, policy, episodes=100)
        found.setdefault(name, []).append(float(flights.steps.mean()))
        time, part = flights.steps.mean(), flights.found.mean()
        print(f"{probability:5} {name:26} {time:6.1f} s, {part:.2f} found")

# %%
# A flight of the oracle while the transmitter jumps: it turns round where a jump makes another way
# the best, and not before.
mission = steady.with_modes(ModeProcess.jumping(PLACES, 0.02))
oracle = plan_mission(mission, task)
flights = fly(mission, task, oracle.observation, oracle.policy, episodes=20)
jumps = [np.flatnonzero(np.diff(modes)) for modes in flights.modes]
shown = int(np.argmax([each.size for each in jumps]))
way, modes = mission.layout.position[flights.cells[shown]], flights.modes[shown]
figure, (left, right) = plt.subplots(1, 2, figsize=(PAGE_IN, 2.6), layout="constrained")
draw_walls(plan, 2.0, left)
set_limits(plan, left)
for part in np.split(np.arange(modes.size), jumps[shown] + 1):
    first = max(part[0] - 1, 0)
    (line,) = left.plot(*way[first : part[-1] + 1].T, lw=1.8)
    left.plot(*mission.source[modes[part[0]]], "*", color=line.get_color(), ms=9)
left.plot(*way[0], "o", mfc="white", mec=INK)
left.set(
    aspect="equal", xlabel="x [m]", ylabel="y [m]", title="a flight; colour changes with a jump"
)

for name, steps in found.items():
    right.plot(PROBABILITIES, steps, "k*:" if name == "oracle" else "o-", label=name)
right.set(xlabel="probability of a jump, per second", ylabel="mean time to find [s]")
figure.legend(*right.get_legend_handles_labels(), loc="outside lower center", ncols=2)
plt.show()

# %%
# Flights that do not find it count as 1000 s.
