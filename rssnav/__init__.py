"""RSS-based Q-learning for indoor UAV navigation: worlds, agents, training, results.

>>> import floorplans, raytrace, rssnav
>>> plan = floorplans.load("scenario1")
>>> radio_map = raytrace.RadioMap.load("scenario1.h5")
>>> world = rssnav.GridWorld.from_map(plan, radio_map, speed=1)
>>> result = rssnav.train(world, rssnav.RssAgent(), runs=100, episodes=1000, seed=0)

Each name is imported when it is first asked for (PEP 562), so that ``rssnav --help`` and shell
completion do not wait for numba.
"""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rssnav.agent_description import AgentDescription
    from rssnav.agents import Agent, LocationAgent, RssAgent
    from rssnav.decision_process import DecisionProcess
    from rssnav.discrete_states import ExactStates, Fluctuation, IntervalStates, ToleranceStates
    from rssnav.learning_parameters import QLearning
    from rssnav.optimal_flights import Flight, Solution, greedy_path, shortest_path, value_iteration
    from rssnav.result_file import ResultFileError
    from rssnav.results import TrainingResult
    from rssnav.scenes import PlanScene, scene_of
    from rssnav.schedule import Schedule
    from rssnav.training import TrainingInterrupted, train
    from rssnav.world import ACTION_NAMES, ACTIONS, GridWorld, WorldError

__all__ = [
    "ACTIONS",
    "ACTION_NAMES",
    "Agent",
    "AgentDescription",
    "DecisionProcess",
    "ExactStates",
    "Flight",
    "Fluctuation",
    "GridWorld",
    "IntervalStates",
    "LocationAgent",
    "PlanScene",
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
    "scene_of",
    "shortest_path",
    "train",
    "value_iteration",
]

_HOMES = {
    "agent_description": ("AgentDescription",),
    "agents": ("Agent", "LocationAgent", "RssAgent"),
    "decision_process": ("DecisionProcess",),
    "discrete_states": ("ExactStates", "Fluctuation", "IntervalStates", "ToleranceStates"),
    "learning_parameters": ("QLearning",),
    "optimal_flights": ("Flight", "Solution", "greedy_path", "shortest_path", "value_iteration"),
    "results": ("TrainingResult",),
    "scenes": ("PlanScene", "scene_of"),
    "schedule": ("Schedule",),
    "result_file": ("ResultFileError",),
    "training": ("TrainingInterrupted", "train"),
    "world": ("ACTIONS", "ACTION_NAMES", "GridWorld", "WorldError"),
}
_HOME_OF = {name: module for module, names in _HOMES.items() for name in names}


if not TYPE_CHECKING:  # a type checker knows the names from above, and finds a wrong one

    def __getattr__(name: str) -> object:
        if name not in _HOME_OF:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        value = getattr(import_module(f"{__name__}.{_HOME_OF[name]}"), name)
        globals()[name] = value
        return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
