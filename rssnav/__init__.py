"""RSS-based Q-learning for indoor UAV navigation: worlds, agents, training, results.

>>> import floorplans, raytrace, rssnav
>>> plan = floorplans.load("scenario1")
>>> radio_map = raytrace.RadioMap.load("scenario1.h5")
>>> world = rssnav.GridWorld.from_map(plan, radio_map, speed=1)
>>> result = rssnav.train(world, rssnav.RssAgent(), runs=100, episodes=1000, seed=0)
"""

from rssnav.agents import Agent, DecisionProcess, LocationAgent, QLearning, RssAgent
from rssnav.planning import Path, Solution, greedy_path, shortest_path, value_iteration
from rssnav.results import Schedule, TrainingResult
from rssnav.states import ExactStates, Fluctuation, IntervalStates, ToleranceStates
from rssnav.store import ResultFileError
from rssnav.training import TrainingInterrupted, train
from rssnav.world import ACTION_NAMES, ACTIONS, GridWorld, WorldError

__all__ = [
    "ACTIONS",
    "ACTION_NAMES",
    "Agent",
    "DecisionProcess",
    "ExactStates",
    "Fluctuation",
    "GridWorld",
    "IntervalStates",
    "LocationAgent",
    "Path",
    "QLearning",
    "ResultFileError",
    "RssAgent",
    "Schedule",
    "Solution",
    "ToleranceStates",
    "TrainingInterrupted",
    "TrainingResult",
    "WorldError",
    "greedy_path",
    "shortest_path",
    "train",
    "value_iteration",
]
