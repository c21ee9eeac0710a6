"""The buildings of the benchmark: generated and split by building, the paper's, and one's own."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from hashlib import sha256
from pathlib import Path
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

import floorplans
from floorplans import FloorPlan
from raytrace import Grid, TraceConfig
from rssnav.arguments import require
from rssnav.benchmark.frozen import DOOR_FINGERPRINTS, FINGERPRINTS, Split
from rssnav.doors import Door, shut_doors, with_changed
from rssnav.maps import CELL_SIZE_M, HEIGHT_M
from rssnav.missions import Layout, Mission, ReadingAbove, Task, spread_places
from rssnav.missions.doors import detour_doors, mission_of_doors
from rssnav.missions.layout import WorldError
from rssnav.missions.places import (
    are_in_sight,
    fields_of_places,
    mission_of_fields,
    reachable_layout,
)
from rssnav.policies import Hypotheses
from rssnav.policies.hypotheses import COARSE, NO_WAY
from rssnav.presets import PRESETS, PresetName

Site = Literal["train", "validation", "test", "paper", "own"]
"""Where a building comes from."""

PLACES = 3
"""Transmitters of a generated or own building."""

PAPER_PLACES = 20
"""Transmitters of a building of the paper, its own first."""

GOAL = ReadingAbove(-21.0)
"""Where the transmitter is found: -21 dBm is free space at 2 m."""

DOORS = 3
"""Doors of a building that open and close, at most."""

LEAST_STEPS, FEWEST_STEPS = 10, 5
"""Flights begin at least so many steps from where any of the transmitters is found; where no cell
is as far from all of them, in the cells that are farthest, but not nearer than the second."""

_KINDS = ("office", "hotel", "school")
_AREA_M2 = (300.0, 700.0)
_FIRST_SEED: dict[Split, int] = {"train": 0, "validation": 1_000_000, "test": 2_000_000}
_LEAST_PART = 0.5
_HEIGHT_M = 1.2
_BESIDE_M = 0.2  # at most this far from a cell's centre along each axis
_SEARCH_LIMITS: dict[PresetName, TraceConfig] = {"paper": TraceConfig(2, 1, 0), "building": COARSE}


@dataclass(frozen=True)
class Building:
    """A building of the benchmark.

    Attributes
    ----------
    site : {"train", "validation", "test", "paper", "own"}
    number : int
        From 0, within the site.
    plan : FloorPlan
    layout : Layout
        The largest connected part of its cells.
    places : tuple of (float, float, float)
        Transmitters [m].
    preset : {"building", "paper"}
        Antennas and limits of the traces.
    drawn : (str, int, float) or None
        Kind, seed and area [m^2] of a generated building.
    doors : tuple of Door or None
        Doors that open and close; None where doors are as in the plan.
    """

    site: Site
    number: int
    plan: FloorPlan
    layout: Layout
    places: tuple[tuple[float, float, float], ...]
    preset: PresetName = "building"
    drawn: tuple[str, int, float] | None = None
    doors: tuple[Door, ...] | None = None

    @property
    def name(self) -> str:
        """Name in tables and files."""
        return f"{self.site}-{self.number:03d}"

    @cached_property
    def fingerprint(self) -> str:
        """Hash of plan, places, and doors that open and close."""
        content = ";".join(",".join(f"{x:.9f}" for x in place) for place in self.places)
        if self.doors is not None:
            content += "".join(f" door {door.wall} {door.opening}" for door in self.doors)
        return sha256(f"{self.plan.sha256} {content}".encode()).hexdigest()

    @cached_property
    def with_doors(self) -> Building:
        """The building with all doors open, of which some open and close.

        A generated one has connecting doors besides, between any two rooms side by side. Of all
        doors those are chosen that can be closed without cutting off a cell, and lengthen the ways
        to the places most (`detour_doors`).

        Raises
        ------
        WorldError
            When a generated building is not the one of this version of the benchmark.
        """
        plan = self.plan if self.drawn is None else _draw(*self.drawn, connecting_doors=1.0)
        plan = with_changed(plan, shut_doors(plan))
        whole = Layout.of_plan(plan, Grid.over(plan.bounds, CELL_SIZE_M, HEIGHT_M))
        inside = whole.reachable(whole.nearest(*self.layout.position[0]))
        layout = whole.part(np.sort(inside))
        doors = detour_doors(plan, layout, self.places, DOORS)
        found = replace(self, plan=plan, layout=layout, drawn=None, doors=doors)
        return found if self.drawn is None else _checked(found)

    @cached_property
    def hypotheses(self) -> Hypotheses:
        """A map for a transmitter in every cell or a step from it, of fewer paths than the world's.

        Tracing them takes some seconds.
        """
        return Hypotheses.of_plan(
            self.plan,
            self.layout,
            config=_SEARCH_LIMITS[self.preset],
            antenna=PRESETS[self.preset].antenna,
            threads=1,
        )

    def mission(self, folder: Path | None = None) -> Mission:
        """Mission with a mode for each place, and state of the doors, drawn for each episode.

        Flights begin in any cell that is far enough from all places. The maps are kept in a folder,
        if one is given.
        """
        path = None if folder is None else folder / f"{self.name}.h5"
        mission = self._everywhere(path)
        hops = Hypotheses.of_mission(mission, Task(GOAL)).hops
        nearest = hops.min(axis=1)
        if hops.max() >= NO_WAY or nearest.max() < FEWEST_STEPS:
            raise WorldError(
                f"building {self.name} (plan {self.plan.name!r}): no cell is {FEWEST_STEPS} steps "
                "or more from each transmitter, with a way to it; a larger building is needed"
            )
        far = nearest >= min(LEAST_STEPS, int(nearest.max()))
        return mission.from_starts(np.flatnonzero(far))

    def _everywhere(self, path: Path | None) -> Mission:
        """Mission of flights that begin in any cell."""
        preset = PRESETS[self.preset]
        if self.doors is not None:
            return mission_of_doors(
                self.plan,
                self.layout,
                self.doors,
                self.places,
                config=preset.config,
                antenna=preset.antenna,
                threads=1,
                path=path,
            )
        rss_dbm = fields_of_places(
            self.plan,
            self.layout,
            self.places,
            config=preset.config,
            antenna=preset.antenna,
            threads=1,
            path=path,
        )
        everywhere = np.arange(self.layout.n_states)
        return mission_of_fields(self.plan, (self.layout,), rss_dbm, self.places, starts=everywhere)


def generated(split: Split, count: int) -> Iterator[Building]:
    """Yield the first buildings of a split; the same on any machine.

    Seeds are tried in order; a plan counts if one step after another reaches at least half of the
    cells in its outline.

    Raises
    ------
    ValueError
        For an unknown split or too many buildings.
    WorldError
        When a building is not the one of this version of the benchmark.
    """
    require(split in get_args(Split), "split", split, " or ".join(map(repr, get_args(Split))))
    most = len(FINGERPRINTS[split])
    require(1 <= count <= most, "count", count, f"1 to {most}")
    yield from map(_checked, unchecked(split, count))


def _checked(building: Building) -> Building:
    known = FINGERPRINTS if building.doors is None else DOOR_FINGERPRINTS
    if not building.fingerprint.startswith(known[building.site][building.number]):
        raise WorldError(
            f"building {building.name} is not that of the benchmark: plans are drawn or generated "
            "in another way than in the version of rssnav that froze it"
        )
    return building


def unchecked(site: Split | Literal["paper"], count: int) -> Iterator[Building]:
    """Yield buildings without comparing them with the frozen ones."""
    if site == "paper":
        yield from _paper()
        return
    split: Split = site
    seed, number = _FIRST_SEED[split], 0
    while number < count:
        building = _generate(split, number, seed)
        seed += 1
        if building is not None:
            number += 1
            yield building


def paper() -> Iterator[Building]:
    """Yield the two buildings of the paper, with its transmitter and others spread over them."""
    yield from map(_checked, _paper())


def _paper() -> Iterator[Building]:
    for number, name in enumerate(("scenario1", "scenario2")):
        plan = floorplans.load(name)
        places = spread_places(plan, PAPER_PLACES)
        yield Building("paper", number, plan, reachable_layout(plan), places, "paper")


def own(plans: Sequence[str | Path]) -> Iterator[Building]:
    """Yield buildings of plans, built-in or files, with transmitters drawn as in generated ones."""
    for number, name in enumerate(plans):
        plan = floorplans.load(name)
        layout = _largest_part(plan)
        places = _draw_places(plan, layout, np.random.default_rng(0))
        yield Building("own", number, plan, layout, places)


def _generate(split: Split, number: int, seed: int) -> Building | None:
    generator = np.random.default_rng(seed)
    kind, area_m2 = _KINDS[number % len(_KINDS)], generator.uniform(*_AREA_M2)
    plan = _draw(kind, seed, area_m2)
    whole = Layout.of_plan(plan, Grid.over(plan.bounds, CELL_SIZE_M, HEIGHT_M))
    layout = _largest_part(plan, whole)
    if layout.n_states < _LEAST_PART * whole.n_states:
        return None
    places = _draw_places(plan, layout, generator)
    return Building(split, number, plan, layout, places, drawn=(kind, seed, area_m2))


def _draw(kind: str, seed: int, area_m2: float, connecting_doors: float = 0.0) -> FloorPlan:
    return floorplans.generate(
        kind,
        seed,
        area_m2=area_m2,
        furniture=False,
        n_transmitters=0,
        connecting_doors=connecting_doors,
    )


def _draw_places(
    plan: FloorPlan, layout: Layout, generator: np.random.Generator
) -> tuple[tuple[float, float, float], ...]:
    """Draw places of transmitters, each in sight of the centre of its cell."""
    places: list[tuple[float, float, float]] = []
    for cell in generator.permutation(layout.n_states):
        offset = generator.uniform(-_BESIDE_M, _BESIDE_M, 2)
        centre = layout.position[[cell]]
        if are_in_sight(plan, centre, centre + offset, _HEIGHT_M)[0]:
            x, y = (centre[0] + offset).tolist()
            places.append((x, y, _HEIGHT_M))
        if len(places) == PLACES:
            break
    return tuple(places)


def _largest_part(plan: FloorPlan, whole: Layout | None = None) -> Layout:
    """Cells of the largest connected part, in order."""
    if whole is None:
        whole = Layout.of_plan(plan, Grid.over(plan.bounds, CELL_SIZE_M, HEIGHT_M))
    left = np.ones(whole.n_states, dtype=np.bool_)
    largest: NDArray[np.int64] = np.empty(0, dtype=np.int64)
    while left.any():
        part = whole.reachable(int(np.argmax(left)))
        left[part] = False
        largest = part if part.size > largest.size else largest
    return whole.part(np.sort(largest))
