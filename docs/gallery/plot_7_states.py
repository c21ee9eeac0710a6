"""
Discrete states and fluctuating RSS
===================================

In a static world every RSS value can be a state of its own. Real RSS readings fluctuate, and then a
state must be a range of readings. How wide may it be?
"""

import matplotlib.pyplot as plt
import numpy as np

import floorplans
import rssnav
from rssnav.maps import make_map
from rssnav.pictures.style import AGENT_COLOURS, PAGE_IN, STYLE, shade

plt.rcParams.update(STYLE)

plan = floorplans.load("flat")
world = rssnav.GridWorld.from_map(plan, make_map(plan))
threshold_db = np.array([0.02, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0])
RUNS = 16

# %%
# With a tolerance of Th dB, a reading nearer than that to a known state is that state. Each point
# is 16 independent trainings of 500 episodes, truncated at 300 steps.
learning = rssnav.QLearning(max_steps=300)
figure, (left, right) = plt.subplots(1, 2, figsize=(PAGE_IN, 2.3), layout="constrained")
for sigma_db, lightness in ((0.0, -0.4), (0.1, 0.0), (0.5, 0.5)):
    states, arrived = [], []
    for threshold in threshold_db:
        agent = rssnav.RssAgent(
            rssnav.ToleranceStates(threshold), -30.0, rssnav.Fluctuation(sigma_db)
        )
        result = rssnav.train(world, agent, runs=RUNS, episodes=500, learning=learning)
        states.append(result.n_discrete_states.mean())
        arrived.append(result.reached.mean())
    colour = shade(AGENT_COLOURS["rss"], lightness)
    left.loglog(threshold_db, states, ".-", color=colour, label=f"σ = {sigma_db:g} dB")
    right.semilogx(threshold_db, arrived, ".-", color=colour)
left.axhline(world.n_states, color="0.7", ls=":", label="cells")
left.set_ylabel("states")
left.legend()
right.set_ylabel("fraction of final flights that arrive")
right.set_ylim(-0.05, 1.05)
for ax in (left, right):
    ax.set_xlabel("tolerance Th [dB]")
plt.show()

# %%
# The final flight is the greedy one without fluctuation. With fluctuation, narrow states are many,
# and each is visited rarely. Wide states merge cells that need different actions, and fewer flights
# arrive. Why the widest do better again was not investigated.
