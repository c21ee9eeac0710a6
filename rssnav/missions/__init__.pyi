from .door_planning import DoorPlan, plan_by_sight
from .doors import detour_doors, mission_of_doors
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
    "DoorPlan",
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
    "detour_doors",
    "fly",
    "learn_by_model",
    "mission_of_doors",
    "mission_of_places",
    "plan_by_sight",
    "plan_mission",
    "spread_places",
]
