from .distance_belief import DistanceSearch
from .frontier import FrontierSearch
from .gaussian_process import GaussianProcessSearch
from .hypotheses import Hypotheses
from .map_belief import Infotaxis, Likelihood, MapSearch, Qmdp
from .map_particles import MapParticleFilter
from .step_memory import StepMemory

__all__ = [
    "DistanceSearch",
    "FrontierSearch",
    "GaussianProcessSearch",
    "Hypotheses",
    "Infotaxis",
    "Likelihood",
    "MapParticleFilter",
    "MapSearch",
    "Qmdp",
    "StepMemory",
]
