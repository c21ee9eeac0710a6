"""
A flight, step by step
======================

The animation that ``rssnav fly`` writes as a GIF or MP4: the trained UAV over the map, and the RSS
it measures. Here it searches the larger building of the paper, at four cells per step.
"""

import matplotlib.pyplot as plt
from matplotlib.animation import FuncAnimation

import floorplans
import rssnav
from raytrace import TraceConfig
from rssnav.maps import make_map
from rssnav.pictures.flight_movie import FinalFlight, FlightScene
from rssnav.pictures.style import drawing

plan = floorplans.load("scenario2")
radio_map = make_map(plan, config=TraceConfig(max_reflections=3, max_diffractions=1))
world = rssnav.GridWorld.from_map(plan, radio_map, speed=4)
agent = rssnav.LocationAgent()
result = rssnav.train(world, agent, runs=1, episodes=20_000, until_converged=True)

flight = FinalFlight.of(result)
print(flight.label)

# %%
# ``FlightScene`` draws one picture per step; ``save_flight_movie`` writes them to a file.
with drawing():
    scene = FlightScene(plan, radio_map, [flight])
first = scene.frame(0)
screen = plt.figure(figsize=(first.shape[1] / 100, first.shape[0] / 100), dpi=60)
ax = screen.add_axes((0.0, 0.0, 1.0, 1.0))
ax.axis("off")
image = ax.imshow(first)


def show(step: int) -> None:
    """Show the picture of a step."""
    image.set_data(scene.frame(step))


film = FuncAnimation(screen, show, frames=scene.n_steps + 1, interval=200)
plt.show()
