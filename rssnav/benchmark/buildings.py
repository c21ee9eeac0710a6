"""The buildings of the benchmark: generated, split by building, each with three transmitters."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Literal, get_args

import numpy as np
import shapely
from numpy.typing import NDArray

import floorplans
from floorplans import FloorPlan
from raytrace import Grid, Transmitter
from rssnav.arguments import require
from rssnav.maps import CELL_SIZE_M, HEIGHT_M
from rssnav.missions import Layout, Mission, ReadingAbove, Task
from rssnav.missions.layout import WorldError
from rssnav.missions.places import mission_of_fields
from rssnav.policies import Hypotheses
from rssnav.policies.hypotheses import NO_WAY
from rssnav.presets import PRESETS
from rssnav.progress import Progress
from rssnav.transmitter_maps import make_transmitter_maps

Split = Literal["train", "validation", "test"]
SPLITS: tuple[Split, ...] = get_args(Split)
N_BUILDINGS: dict[Split, int] = {"train": 200, "validation": 50, "test": 50}
"""Buildings of each split."""

PLACES = 3
"""Transmitters of each building."""

GOAL = ReadingAbove(-21.0)
"""Where the transmitter is found: -21 dBm is free space at 2 m."""

LEAST_STEPS = 10
"""Flights begin at least so many steps from where any of the transmitters is found."""

_KINDS = ("office", "hotel", "school")
_AREA_M2 = (300.0, 700.0)
_SPLIT_SEED: dict[Split, int] = {"train": 0, "validation": 1_000_000, "test": 2_000_000}
_LEAST_PART = 0.5
_HEIGHT_M = 1.2
_BESIDE_M = 0.2  # at most this far from a cell's centre along each axis


@dataclass(frozen=True)
class Building:
    """A building of the benchmark.

    Attributes
    ----------
    split : {"train", "validation", "test"}
    number : int
        From 0, within the split.
    plan : FloorPlan
    layout : Layout
        The largest part of its cells that hangs together.
    places : tuple of (float, float, float)
        Transmitters [m].
    """

    split: Split
    number: int
    plan: FloorPlan
    layout: Layout
    places: tuple[tuple[float, float, float], ...]

    @property
    def name(self) -> str:
        """Name in tables and files."""
        return f"{self.split}-{self.number:03d}"

    @cached_property
    def senders(self) -> dict[str, Transmitter]:
        """Transmitters by name."""
        antenna = PRESETS["building"].antenna
        return {
            f"{k}": Transmitter(position=place, antenna=antenna)
            for k, place in enumerate(self.places)
        }

    @cached_property
    def hypotheses(self) -> Hypotheses:
        """A map for a transmitter in every cell or a step from it, of fewer paths than the world's.

        Tracing them takes some seconds.
        """
        return Hypotheses.of_plan(self.plan, self.layout)

    def mission(
        self,
        folder: Path | None = None,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> Mission:
        """Mission with a mode for each place, which is drawn for each episode.

        Flights begin in any cell that is far enough from all places. The maps are kept in a folder,
        if one is given.
        """
        maps = make_transmitter_maps(
            self.plan,
            self.senders,
            None if folder is None else folder / f"{self.name}.h5",
            config=PRESETS["building"].config,
            receive_antenna=PRESETS["building"].antenna,
            threads=threads,
            progress=progress,
        )
        rss_dbm = np.stack([self.layout.on_cells(maps[name].rss_dbm) for name in self.senders])
        mission = mission_of_fields(self.plan, (self.layout,), rss_dbm, self.places)
        hops = Hypotheses.of_mission(mission, Task(GOAL)).hops
        if hops.max() >= NO_WAY:
            raise WorldError(f"building {self.name}: a transmitter cannot be found from its cells")
        return mission.from_starts(np.flatnonzero(hops.min(axis=1) >= LEAST_STEPS))


def buildings(split: Split, count: int | None = None) -> Iterator[Building]:
    """Yield the buildings of a split; the same on any machine.

    Seeds are tried in order; a plan counts if one step after another reaches at least half of the
    cells in its outline.
    """
    require(split in SPLITS, "split", split, " or ".join(map(repr, SPLITS)))
    most = N_BUILDINGS[split]
    count = most if count is None else count
    require(1 <= count <= most, "count", count, f"1 to {most}")
    seed, number = _SPLIT_SEED[split], 0
    while number < count:
        building = _building(split, number, seed)
        seed += 1
        if building is not None:
            number += 1
            yield building


def _building(split: Split, number: int, seed: int) -> Building | None:
    generator = np.random.default_rng(seed)
    kind, area_m2 = _KINDS[number % len(_KINDS)], generator.uniform(*_AREA_M2)
    plan = floorplans.generate(kind, seed, area_m2=area_m2, furniture=False, n_transmitters=0)
    layout = Layout.of_plan(plan, Grid.over(plan.bounds, CELL_SIZE_M, HEIGHT_M))
    kept = _largest_part(layout)
    if kept.size < _LEAST_PART * layout.n_states:
        return None
    layout = layout.part(kept)
    return Building(split, number, plan, layout, _places(plan, layout, generator))


def _places(
    plan: FloorPlan, layout: Layout, generator: np.random.Generator
) -> tuple[tuple[float, float, float], ...]:
    """Draw places of transmitters, each in sight of the centre of its cell."""
    walls = shapely.multilinestrings(plan.solid_segments(_HEIGHT_M))
    places: list[tuple[float, float, float]] = []
    for cell in generator.permutation(layout.n_states):
        offset = generator.uniform(-_BESIDE_M, _BESIDE_M, 2)
        way = np.stack((layout.position[cell], layout.position[cell] + offset))
        if not shapely.intersects(shapely.linestrings(way), walls):
            places.append((float(way[1, 0]), float(way[1, 1]), _HEIGHT_M))
        if len(places) == PLACES:
            break
    return tuple(places)


def _largest_part(layout: Layout) -> NDArray[np.int64]:
    """Cells of the largest part that hangs together, in order."""
    left = np.ones(layout.n_states, dtype=np.bool_)
    largest = np.empty(0, dtype=np.int64)
    while left.any():
        part = layout.reachable(int(np.argmax(left)))
        left[part] = False
        largest = part if part.size > largest.size else largest
    return np.sort(largest)
