"""RSS-based Q-learning for indoor UAV navigation: worlds, agents, training, results.

>>> import floorplans, raytrace, rssnav
>>> plan = floorplans.load("scenario1")
>>> radio_map = raytrace.RadioMap.load("scenario1.h5")
>>> world = rssnav.GridWorld.from_map(plan, radio_map, speed=1)
>>> result = rssnav.train(world, rssnav.RssAgent(), runs=100, episodes=1000, seed=0)

The names are listed in `__init__.pyi`. Each is imported when it is first used, so that programs
which use few of them start quickly.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
