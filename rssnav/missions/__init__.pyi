from .energy import MultirotorEnergy
from .flights import Flights, fly
from .layout import Layout
from .mission import Mission
from .modes import ModeProcess
from .observation import Observation
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
    "Policy",
    "RandomPolicy",
    "ReadingAbove",
    "Seen",
    "Task",
    "Within",
    "fly",
]
