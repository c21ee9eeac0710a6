"""
Fewest steps, or least energy
=============================

A turn costs a multirotor energy. Of all flights with the fewest steps some zigzag and some do not,
and an agent that does not know the direction it came from cannot tell them apart.
"""

import math

import matplotlib.pyplot as plt

import floorplans
from raytrace import TraceConfig
from rssnav import GridWorld, QLearning
from rssnav.maps import make_map
from rssnav.mission_training import train_mission
from rssnav.missions import MultirotorEnergy, Observation, ReadingAbove, Task, fly, plan_mission
from rssnav.pictures.radio_map import draw_radio_map
from rssnav.pictures.style import PAGE_IN, STYLE

plt.rcParams.update(STYLE)

plan = floorplans.load("scenario1")
radio_map = make_map(plan, config=TraceConfig(max_reflections=3, max_diffractions=1))
mission = GridWorld.from_map(plan, radio_map).mission()
goal, craft = ReadingAbove(-21.0), MultirotorEnergy()
task = Task(goal, energy=craft, max_steps=500)

# %%
# The oracles are value iteration, over cells for steps, and over cells and headings for energy.
# Q-learning is given the RSS difference, and with headings a price of 20 per kilojoule besides.
STEPS = 20_000_000
best = {
    "fewest steps": plan_mission(mission, task),
    "least energy": plan_mission(mission, task, "energy"),
}
flown = {
    f"oracle, {name}": [fly(mission, task, plan.observation, plan.policy, episodes=1)]
    for name, plan in best.items()
}  # fmt: skip
for name, heading, per_kj in (("Q-learning", False, 0.0), ("Q-learning, headings", True, -20.0)):
    sight = Observation(None, cell=True, heading=heading)
    paid = Task(goal, energy=craft, per_kj=per_kj)
    learning = QLearning(eta=math.log(100.0) / (0.5 * STEPS), initial_q=200.0 if heading else 100.0)
    tables = [
        train_mission(mission, paid, sight, steps=STEPS, seed=seed, learning=learning)
        for seed in range(3)
    ]
    flown[name] = [fly(mission, task, sight, table, episodes=1) for table in tables]

for name, flights in flown.items():
    energy = ", ".join(f"{f.energy_kj[0]:.2f}" for f in flights)
    print(f"{name:22} {flights[0].steps[0]} steps, {energy} kJ, {flights[0].turns[0]} turns")

# %%
# The flights: those of Q-learning turn where those of the oracle go straight on.
COLOURS = dict(zip(flown, ("#0072b2", "#009e73", "#d55e00", "#cc79a7"), strict=True))
figure, panels = plt.subplots(2, 2, figsize=(PAGE_IN, 2.7), layout="constrained")
for ax, (name, flights) in zip(panels.flat, flown.items(), strict=True):
    draw_radio_map(plan, radio_map, ax).set_alpha(0.5)
    ax.plot(*mission.layout.position[flights[0].cells[0]].T, color=COLOURS[name], lw=1.6)
    ax.set_title(f"{name}: {flights[0].energy_kj[0]:.1f} kJ, {flights[0].turns[0]} turns")
    ax.set(xlabel="", ylabel="")
plt.show()

# %%
# Energy against steps, beside the oracles. Least energy may take a step more.
figure, (left, right) = plt.subplots(1, 2, figsize=(PAGE_IN, 2.4), layout="constrained")
for name, flights in flown.items():
    energy = [float(f.energy_kj[0]) for f in flights]
    marker = "*" if name.startswith("oracle") else "o"
    left.plot([f.steps[0] for f in flights], energy, marker, color=COLOURS[name], label=name)
    right.plot([f.turns[0] for f in flights], energy, marker, color=COLOURS[name])
left.axhline(flown["oracle, least energy"][0].energy_kj[0], color="0.7", ls=":")
left.set(xlabel="steps", ylabel="energy [kJ]")
left.margins(0.3, 0.1)
right.margins(0.1)
left.xaxis.get_major_locator().set_params(integer=True)
right.set(xlabel="turns")
figure.legend(loc="outside lower center", ncols=4)
plt.show()
