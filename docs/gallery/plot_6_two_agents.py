"""
Two agents learn to find a transmitter
======================================

One agent observes only the RSS. The other knows its own position and that of the transmitter. Both
learn by Q-learning from the same start, in twenty independent runs.
"""

import matplotlib.pyplot as plt
import numpy as np

import floorplans
import rssnav
from rssnav.maps import make_map
from rssnav.pictures.radio_map import draw_radio_map
from rssnav.pictures.style import AGENT_COLOURS, PAGE_IN, STYLE, draw_flight

plt.rcParams.update(STYLE)

plan = floorplans.load("flat")
radio_map = make_map(plan)
world = rssnav.GridWorld.from_map(plan, radio_map)
agents = (rssnav.RssAgent(terminal_dbm=-30.0), rssnav.LocationAgent())
results = [rssnav.train(world, agent, runs=20, episodes=1000) for agent in agents]

# %%
# An agent with full knowledge would take the minimum number of steps. The two agents end at
# different cells, the first above -30 dBm and the second within 2 m of the transmitter, so each has
# its own minimum.
figure, (left, right) = plt.subplots(1, 2, figsize=(PAGE_IN, 2.4), layout="constrained")
for agent, result in zip(agents, results, strict=True):
    colour = AGENT_COLOURS[agent.name]
    terminal = agent.decision_process(world, result.learning).terminal
    fewest = rssnav.shortest_path(world, terminal).steps
    print(f"{agent.name:8} {result.path_steps.mean():.1f} steps after training, minimum {fewest}")
    episode = np.arange(1, result.steps.shape[1] + 1)
    left.loglog(
        episode, result.steps.mean(axis=0), color=colour, lw=0.8, label=f"{agent.name} agent"
    )
    left.axhline(fewest, color=colour, ls=":")
left.set_xlabel("episode")
left.set_ylabel("steps, mean of 20 runs")
left.legend()

draw_radio_map(plan, radio_map, right).set_alpha(0.75)
for agent, result in zip(agents, results, strict=True):
    draw_flight(right, result.trajectory_m(0), agent.name)
right.set_title("flights after training")
plt.show()
