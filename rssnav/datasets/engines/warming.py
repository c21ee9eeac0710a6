"""Compiling the kernels that a configuration needs, before the first plan."""

from __future__ import annotations

import warnings
from dataclasses import replace

import floorplans
from raytrace import TraceConfig
from rssnav.datasets.configuration import Configuration
from rssnav.datasets.tracing import Limits, trace_plan

_HEIGHT_M = 1.5
_CELL_SIZE_M = 2.0


def warm_kernels(configuration: Configuration) -> None:
    """Trace a small flat with the antennas and the kinds of paths of a configuration."""
    plan = floorplans.generate("flat", 0, area_m2=50.0, n_transmitters=1)
    small = replace(
        configuration,
        which=(),
        heights_m=(_HEIGHT_M,),
        cell_size_m=_CELL_SIZE_M,
        presets={name: _shortened(config) for name, config in configuration.presets.items()},
        strongest_paths=min(configuration.strongest_paths, 1),
    )
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        trace_plan(plan, small, Limits())


def _shortened(config: TraceConfig) -> TraceConfig:
    """Return the same kinds of paths with at most one reflection."""
    return replace(config, max_reflections=min(config.max_reflections, 1))
