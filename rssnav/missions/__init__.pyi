from .energy import MultirotorEnergy
from .flights import Flights, fly
from .layout import Layout
from .mission import Mission
from .model_learning import learn_by_model
from .modes import ModeProcess
from .observation import Observation
from .places import mission_of_places, spread_places
from .planning import Plan, plan_mission
from .policy import HOVER, GreedyTable, Policy, RandomPolicy, Seen
from .task import ReadingAbove, Task, Within

__all__ = [
    "HOVER",
    "Flights",
    "GreedyTable",
    "Layout",
    "Mission",
    "ModeProcess",
    "MultirotorEnergy",
    "Observation",
    "Plan",
    "Policy",
    "RandomPolicy",
    "ReadingAbove",
    "Seen",
    "Task",
    "Within",
    "fly",
    "learn_by_model",
    "mission_of_places",
    "plan_mission",
    "spread_places",
]
