from .agent_description import AgentDescription
from .agents import Agent, LocationAgent, RssAgent
from .decision_process import DecisionProcess
from .discrete_states import ExactStates, Fluctuation, IntervalStates, ToleranceStates
from .learning_parameters import QLearning
from .optimal_flights import Flight, Solution, greedy_path, shortest_path, value_iteration
from .result_file import ResultFileError
from .results import TrainingResult
from .scenes import PlanScene, scene_of
from .schedule import Schedule
from .training import TrainingInterrupted, train
from .world import ACTION_NAMES, ACTIONS, GridWorld, WorldError

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
