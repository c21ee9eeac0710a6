"""A plan and a configuration in, all its maps out: the scene is prepared once for all of them."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from floorplans import FloorPlan, PlanTransmitter
from floorplans.transmitters import ALL
from raytrace import Antenna, Grid, Scene, SceneError, TraceConfig, Transmitter, compute_radio_map
from raytrace.arrays import Bools
from raytrace.results.layers import EMPTY
from raytrace.solver.workers import Stop
from rssnav.datasets.configuration import Configuration
from rssnav.datasets.plan_maps import MapIndex, PlanMaps, empty_layers
from rssnav.datasets.strongest import most_interactions, path_shapes, strongest_paths
from rssnav.maps import cells_inside, check_height
from rssnav.scenes import scene_of
from rssnav.transmitters import choose_transmitters

Traced = Callable[[], None]
"""Called after each map."""


@dataclass(frozen=True)
class Limits:
    """What a worker may use; the maps do not depend on it.

    Attributes
    ----------
    threads
        For each map.
    max_memory_bytes
        For each map; by default half of what is free.
    stop
        Ends the work where it returns True.
    traced
        Called after each map.
    """

    threads: int = 1
    max_memory_bytes: int | None = None
    stop: Stop | None = None
    traced: Traced | None = None


def trace_plan(plan: FloorPlan, configuration: Configuration, limits: Limits) -> PlanMaps:
    """Trace all maps of a plan.

    Raises
    ------
    SceneError, NoTransmitterError, ValueError
        Where the plan cannot be traced as the configuration asks.
    TraceStoppedError, MemoryLimitError
        As for `raytrace.compute_radio_map`.
    """
    placed = placed_transmitters(plan, configuration)
    for height_m in configuration.heights_m:
        check_height(plan, height_m)
    grids = [
        Grid.over(plan.bounds, configuration.cell_size_m, height_m)
        for height_m in configuration.heights_m
    ]
    inside = np.stack([cells_inside(plan, grid) for grid in grids])
    scene = scene_of(plan, configuration.edition)
    ends = _Ends.of(configuration, placed)
    maps = _empty(configuration, placed, grids[0], inside)
    seconds = dict[MapIndex, float]()
    for index in maps.indices():
        started = time.perf_counter()
        request = _Request.of(configuration, ends, grids, index)
        _fill(maps, index, request, scene, inside[index.height], limits)
        seconds[index] = time.perf_counter() - started
        if limits.traced is not None:
            limits.traced()
    return replace(maps, seconds=tuple(seconds.values()))


def placed_transmitters(
    plan: FloorPlan, configuration: Configuration
) -> tuple[PlanTransmitter, ...]:
    """Return the transmitters of a plan that are traced, at least one.

    Raises
    ------
    NoTransmitterError
        Where the plan has none, or none of a name.
    """
    chosen = choose_transmitters(plan, configuration.which or _default(plan))
    known = {transmitter.id: transmitter for transmitter in plan.transmitters}
    return tuple(
        known.get(name) or PlanTransmitter(name, transmitter.position)
        for name, transmitter in chosen.items()
    )


def _default(plan: FloorPlan) -> tuple[str, ...]:
    return (ALL,) if plan.transmitters else ()


@dataclass(frozen=True)
class _Ends:
    """Where maps are sent from, and the antennas of all; each is made once a plan.

    Attributes
    ----------
    placed
        The transmitters.
    transmit
        Antennas of each transmitter, for each antenna of the configuration.
    receive
        Of the receivers.
    """

    placed: tuple[PlanTransmitter, ...]
    transmit: tuple[tuple[Antenna, ...], ...]
    receive: Antenna

    @classmethod
    def of(cls, configuration: Configuration, placed: tuple[PlanTransmitter, ...]) -> _Ends:
        """Make the antennas."""
        return cls(
            placed,
            tuple(
                tuple(antenna.antenna(at.direction) for at in placed)
                for antenna in configuration.antennas
            ),
            configuration.receive_antenna.antenna(),
        )


@dataclass(frozen=True)
class _Request:
    """What a single map is traced with."""

    transmitter: Transmitter
    grid: Grid
    config: TraceConfig
    receive_antenna: Antenna

    @classmethod
    def of(
        cls,
        configuration: Configuration,
        ends: _Ends,
        grids: list[Grid],
        index: MapIndex,
    ) -> _Request:
        return cls(
            Transmitter(
                ends.placed[index.transmitter].position,
                configuration.power_dbm,
                configuration.frequencies_hz[index.frequency],
                ends.transmit[index.antenna][index.transmitter],
            ),
            grids[index.height],
            tuple(configuration.presets.values())[index.preset],
            ends.receive,
        )


def _empty(
    configuration: Configuration,
    placed: tuple[PlanTransmitter, ...],
    grid: Grid,
    inside: Bools,
) -> PlanMaps:
    """Return maps without any path, to be filled."""
    shape = (
        len(configuration.presets),
        len(configuration.heights_m),
        len(configuration.antennas),
        len(configuration.frequencies_hz),
        len(placed),
    )
    on_grid = (*shape, *grid.shape)
    paths: dict[str, NDArray[Any]] = {}
    if configuration.strongest_paths:
        most = max(map(most_interactions, configuration.presets.values()))
        shapes = path_shapes(configuration.strongest_paths, most)
        paths = {name: np.zeros((*on_grid, *s), dtype) for name, (s, dtype) in shapes.items()}
    return PlanMaps(
        presets=tuple(configuration.presets),
        heights_m=configuration.heights_m,
        antennas=tuple(antenna.name for antenna in configuration.antennas),
        frequencies_hz=configuration.frequencies_hz,
        transmitters=tuple(transmitter.id for transmitter in placed),
        positions=np.array([transmitter.position for transmitter in placed]),
        power_dbm=configuration.power_dbm,
        x=grid.x,
        y=grid.y,
        inside=inside,
        layers=empty_layers(configuration.layers, on_grid, EMPTY),
        paths=paths,
    )


def _fill(
    maps: PlanMaps,
    index: MapIndex,
    request: _Request,
    scene: Scene,
    inside: Bools,
    limits: Limits,
) -> None:
    """Trace a map into its place."""
    name = maps.transmitters[index.transmitter]
    try:
        radio_map = compute_radio_map(
            scene,
            request.transmitter,
            request.grid,
            request.config,
            receive_antenna=request.receive_antenna,
            threads=limits.threads,
            stop=limits.stop,
            max_memory_bytes=limits.max_memory_bytes,
        ).covering(inside)
        for layer, values in maps.layers.items():
            values[index] = radio_map.layers[layer]
        if maps.paths:
            count, most = maps.paths["path_interactions"].shape[-2:]
            found = strongest_paths(
                scene,
                request.transmitter,
                request.grid,
                request.config,
                request.receive_antenna,
                inside,
                count,
                most,
                limits.stop,
            )
            for array, values in found.items():
                maps.paths[array][index] = values
    except SceneError as error:
        raise SceneError(f"transmitter {name!r}: {error}") from error
