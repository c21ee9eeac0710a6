"""Exact indoor ray tracing: every path of a bounded order, no sampling.

A `Scene` is made from a triangle mesh of vertical wall sheets, a floor and a ceiling. From it
`trace_paths` finds the paths to given receivers, `received_power` sums them at points, and
`compute_radio_map` over a grid. Lengths are in metres, heights above the floor, angles in radians,
gains linear unless a name ends in ``_db`` or ``_dbm``.
"""

from raytrace.config import TraceConfig
from raytrace.errors import (
    AntennaError,
    MapFileError,
    MemoryLimitError,
    MissingMapError,
    SceneError,
    SceneWarning,
    TraceStoppedError,
)
from raytrace.evaluation import TracedPoints, evaluate_paths, trace_points
from raytrace.grid import Grid
from raytrace.radio.antenna_array import AntennaArray
from raytrace.radio.antennas import DIPOLE_PEAK_GAIN_DBI, Antenna, HalfWaveDipole, Isotropic
from raytrace.radio.directive import Monopole, Patch, Sector
from raytrace.radio.materials import (
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
from raytrace.radio.pattern_table import PatternTable
from raytrace.radio.rotated import Rotated
from raytrace.radio.transmitter import Transmitter
from raytrace.results.channel_matrix import channel_matrix
from raytrace.results.path_statistics import PathStatistics
from raytrace.results.paths import ImpulseResponse, Paths
from raytrace.results.radio_map import RadioMap
from raytrace.results.transmitter_maps import TransmitterMaps
from raytrace.scene import Scene
from raytrace.solver.cost_estimate import CostEstimate, estimate_cost
from raytrace.trace import compute_radio_map, compute_radio_maps, received_power, trace_paths

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
    "channel_matrix",
    "compute_radio_map",
    "compute_radio_maps",
    "dielectrics_of",
    "estimate_cost",
    "evaluate_paths",
    "find_material",
    "received_power",
    "trace_paths",
    "trace_points",
]
