from . import antennas
from .config import TraceConfig
from .errors import (
    AntennaError,
    MapFileError,
    MemoryLimitError,
    MissingMapError,
    SceneError,
    SceneWarning,
    TraceStoppedError,
)
from .evaluation import TracedPoints, evaluate_paths, trace_points
from .grid import Grid
from .left_out import LeftOutSample, sample_left_out
from .radio.antenna_array import AntennaArray
from .radio.antennas import DIPOLE_PEAK_GAIN_DBI, Antenna, HalfWaveDipole, Isotropic
from .radio.directive import Monopole, Patch, Sector
from .radio.materials import (
    ABSORBER,
    PERFECT_CONDUCTOR,
    Dielectric,
    Layer,
    Layered,
    Material,
    Slab,
    dielectrics_of,
    find_material,
)
from .radio.pattern_table import PatternTable
from .radio.rotated import Rotated
from .radio.transmitter import Transmitter
from .results.channel_matrix import channel_matrix
from .results.path_statistics import PathStatistics
from .results.paths import ImpulseResponse, Paths
from .results.radio_map import RadioMap
from .results.transmitter_maps import TransmitterMaps
from .scene import Scene
from .solver.cost_estimate import CostEstimate, estimate_cost
from .trace import compute_radio_map, compute_radio_maps, received_power, trace_paths

__all__ = [
    "ABSORBER",
    "DIPOLE_PEAK_GAIN_DBI",
    "PERFECT_CONDUCTOR",
    "Antenna",
    "AntennaArray",
    "AntennaError",
    "CostEstimate",
    "Dielectric",
    "Grid",
    "HalfWaveDipole",
    "ImpulseResponse",
    "Isotropic",
    "Layer",
    "Layered",
    "LeftOutSample",
    "MapFileError",
    "Material",
    "MemoryLimitError",
    "MissingMapError",
    "Monopole",
    "Patch",
    "PathStatistics",
    "Paths",
    "PatternTable",
    "RadioMap",
    "Rotated",
    "Scene",
    "SceneError",
    "SceneWarning",
    "Sector",
    "Slab",
    "TraceConfig",
    "TraceStoppedError",
    "TracedPoints",
    "Transmitter",
    "TransmitterMaps",
    "antennas",
    "channel_matrix",
    "compute_radio_map",
    "compute_radio_maps",
    "dielectrics_of",
    "estimate_cost",
    "evaluate_paths",
    "find_material",
    "received_power",
    "sample_left_out",
    "trace_paths",
    "trace_points",
]
