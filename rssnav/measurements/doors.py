"""Which doors stood open and which were shut during a survey, as far as its readings tell.

The survey is traced with each door in its other state. The door that explains the readings best is
changed, and so on until none does so clearly; a change that others have made needless is undone.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection
from contextlib import suppress
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from floorplans import FloorPlan, PlanError
from raytrace import Scene
from raytrace.arrays import Bools, Floats, Ints
from rssnav.doors import Door, doors_of, with_changed
from rssnav.measurements.calibration import NOISE_DB, Levels, TracedSurvey, residuals_db
from rssnav.measurements.survey import Survey
from rssnav.measurements.traced import TraceSettings, traced_dbm
from rssnav.scenes import scene_of

BELOW_DB, SILENT_DBM = 10.0, -150.0
"""How far readings without a path are below the weakest one [dB]; their level without any [dBm]."""

KEPT = 4
"""Traces of the survey with other states of doors that are kept with all their paths."""

CLEAR = 10.0
"""Difference of the logarithmic likelihood from which a state is told. It is large, since readings
at neighbouring places err together, and count as independent here."""


@dataclass(frozen=True)
class DoorState:
    """What readings tell of a door.

    Attributes
    ----------
    door
        Which it is.
    place
        Its middle (x, y) [m].
    was_open, is_open
        In the plan, and by the readings.
    evidence
        How much more likely, by the logarithm of the likelihood of all readings, this state is than
        the other; infinite where the plan allows no other.
    """

    door: Door
    place: tuple[float, float]
    was_open: bool
    is_open: bool
    evidence: float

    @property
    def is_told(self) -> bool:
        """Whether the readings tell the state; otherwise it is the plan's."""
        return CLEAR <= self.evidence < math.inf

    def summary(self) -> dict[str, Any]:
        """Return the numbers, for programs; no evidence where the other state is impossible."""
        return {
            "wall": self.door.wall,
            "opening": self.door.opening,
            "place": list(self.place),
            "was_open": self.was_open,
            "is_open": self.is_open,
            "is_told": self.is_told,
            "evidence": self.evidence if np.isfinite(self.evidence) else None,
        }


NO_DOORS: frozenset[Door] = frozenset()


class DoorSearch:
    """The states of a plan's doors that readings tell.

    Parameters
    ----------
    plan, survey, settings
        The building, the readings, and how they are traced.
    groups
        (n,) which offset each reading has.
    edition
        Of the built-in materials, see `rssnav.scene_of`.
    advance
        Called after each trace of the whole survey.
    """

    def __init__(
        self,
        plan: FloorPlan,
        survey: Survey,
        settings: TraceSettings,
        groups: Ints,
        edition: str | None,
        advance: Callable[[], None],
    ) -> None:
        self._plan, self._survey, self._settings = plan, survey, settings
        self._groups, self._edition, self._advance = groups, edition, advance
        self.doors = doors_of(plan)
        self._levels: dict[frozenset[Door], Floats | None] = {}
        self.traced = lru_cache(maxsize=KEPT)(self._traced)

    def plan(self, changed: Collection[Door]) -> FloorPlan:
        """Return the plan with some doors in their other state."""
        return with_changed(self._plan, changed) if changed else self._plan

    def scene(self, changed: Collection[Door]) -> Scene:
        """Return its scene."""
        return scene_of(self.plan(changed), self._edition)

    def _traced(self, changed: frozenset[Door]) -> TracedSurvey:
        return TracedSurvey.of(self.scene(changed), self._survey, self._settings)

    def changed(self, fit: Bools) -> frozenset[Door]:
        """Return the doors whose other state the readings `fit` (n,) tell."""
        found = NO_DOORS
        for _ in range(4 * len(self.doors)):
            gains = {door: self._gain(found, door, fit) for door in self.doors}
            best = max(gains, key=lambda door: gains[door])
            if gains[best] >= CLEAR:
                found = found ^ {best}
                continue
            doubtful = [door for door in found if -gains[door] < CLEAR]
            if not doubtful:
                break
            found = found - {max(doubtful, key=lambda door: gains[door])}
        return found

    def states(self, changed: frozenset[Door]) -> tuple[DoorState, ...]:
        """Say what all readings tell of each door, where some are in their other state."""
        everything = np.ones(len(self._survey), dtype=bool)

        def state(door: Door) -> DoorState:
            wall = self._plan.walls[door.wall]
            opening = wall.openings[door.opening]
            place = wall.point_at(opening.offset_m + 0.5 * opening.width_m)
            was_open = opening.material is None
            evidence = -self._gain(changed, door, everything)
            return DoorState(door, place, was_open, was_open ^ (door in changed), evidence)

        return tuple(state(door) for door in self.doors)

    def level_dbm(self, changed: frozenset[Door]) -> Floats | None:
        """Predict all readings (n,) [dBm] without offsets; None where the plan is refused."""
        if changed not in self._levels:
            level = None
            with suppress(PlanError):
                level = traced_dbm(self.scene(changed), self._survey, self._settings)
            self._levels[changed] = level
            self._advance()
        return self._levels[changed]

    def _gain(self, changed: frozenset[Door], door: Door, fit: Bools) -> float:
        """Logarithm of how much likelier readings become as a door changes its state.

        -inf where the plan does not allow it.
        """
        now, then = self.level_dbm(changed), self.level_dbm(changed ^ {door})
        if now is None or then is None:
            return -math.inf
        return self._loss(now, fit) - self._loss(then, fit)

    def _loss(self, level: Floats, fit: Bools) -> float:
        """Soft L1 loss, as materials are fitted with.

        A reading without a path is predicted somewhat below the weakest one that has one.
        """
        survey, level = self._survey.rows(fit), level[fit]
        predicted = Levels(level, np.zeros((len(level), 0)))
        residual, _, offset = residuals_db(survey, self._groups[fit], predicted)
        heard = np.isfinite(level)
        floor_dbm = float(level[heard].min()) - BELOW_DB if heard.any() else SILENT_DBM
        missed = ~heard & ~survey.is_censored
        above = survey.rss_dbm[missed] - offset[missed] - floor_dbm
        residual[missed] = np.maximum(above, 0.0)
        return float(np.sum(np.sqrt(1.0 + (residual / NOISE_DB) ** 2) - 1.0))
