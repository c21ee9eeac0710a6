"""
Doors in a building never seen
==============================

A building of the benchmark, in which three doors are open or closed by chance. Each closed one
means a detour. Four fly from the same start with the same doors: one knows which are closed, one
plans for what it may meet, and two believe in a law of distance and remember the doors they saw,
or forget them.
"""

import matplotlib.pyplot as plt
import numpy as np

from rssnav.benchmark.buildings import GOAL, generated
from rssnav.missions import ModeProcess, Observation, Task, fly, plan_by_sight, plan_mission
from rssnav.pictures.radio_map import set_limits
from rssnav.pictures.style import INK, PAGE_IN, STYLE, draw_solid_walls
from rssnav.policies import DistanceSearch

plt.rcParams.update(STYLE)

*_, drawn = generated("validation", 3)
building = drawn.with_doors
mission = building.mission()
task = Task(GOAL, "none", max_steps=400)
known, seen = plan_mission(mission, task), plan_by_sight(mission, task)
steps = {"plan_known": True, "steps_to_draw": 1}
policies = {
    "doors known": (known.observation, known.policy),
    "doors by sight": (seen.observation, seen.policy),
    "distance law, doors remembered": (
        Observation(None, cell=True),
        DistanceSearch(building.layout, **steps),
    ),
    "distance law, doors forgotten": (
        Observation(None, cell=True),
        DistanceSearch(building.layout, remembers=False, **steps),
    ),
}

# %%
# Over a hundred flights, all in the same eight states of the doors:
for name, (sight, policy) in policies.items():
    flights = fly(mission, task, sight, policy, episodes=100)
    print(f"{name:31} {flights.found.mean():.2f} found, {flights.steps.mean():6.1f} s")

# %%
# One start and one state of the doors: of some starts, where not knowing the doors costs most.


def in_one(mode: int, start: int):
    """Return the mission with one start and one state of the doors."""
    only = ModeProcess(np.eye(mission.n_modes)[mode], np.eye(mission.n_modes))
    return mission.from_starts(np.array([start])).with_modes(only)


def steps_of(name: str, mode: int, start: int) -> int:
    """Return the steps of a flight."""
    return int(fly(in_one(mode, start), task, *policies[name], episodes=1).steps[0])


starts = mission.starts[:: mission.starts.size // 12].tolist()
_, mode, start = max(
    (steps_of("doors by sight", mode, start) - steps_of("doors known", mode, start), mode, start)
    for mode in range(mission.n_modes)
    for start in starts
)
figure, panels = plt.subplots(2, 2, figsize=(PAGE_IN, 4.6), layout="constrained")
for ax, (name, (sight, policy)) in zip(panels.flat, policies.items(), strict=True):
    flights = fly(in_one(mode, start), task, sight, policy, episodes=1)
    way = mission.layout.position[flights.cells[0]]
    draw_solid_walls(ax, building.plan, 2.0)
    for door, closed in zip(building.doors, mission.closed[mode], strict=True):
        wall = building.plan.walls[door.wall]
        opening = wall.openings[door.opening]
        ends = [wall.point_at(along) for along in (opening.offset_m, opening.end_m)]
        ax.plot(*zip(*ends, strict=True), color="#d55e00" if closed else "#009e73", lw=3)
    ax.plot(*way.T, color="#0072b2", lw=1.2, alpha=0.8)
    ax.plot(*way[0], "o", mfc="white", mec=INK)
    ax.plot(*mission.source[mode], "*", color="#cc79a7", ms=9)
    ending = f"{flights.steps[0]} s" if flights.found[0] else "not found"
    ax.set(aspect="equal", title=f"{name}: {ending}")
    set_limits(building.plan, ax)
plt.show()

# %%
# Green doors are open, red ones closed. Whoever forgets a closed door goes back to it.
