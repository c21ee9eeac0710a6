"""Who flies: the policies that come with the benchmark, and those of others."""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from hashlib import sha256
from importlib import import_module
from importlib.metadata import version
from pathlib import Path
from typing import Any, Literal, cast, get_args

import numpy as np
from numpy.typing import NDArray

from rssnav.benchmark.buildings import Building
from rssnav.benchmark.errors import BenchmarkError, check
from rssnav.benchmark.protocol import Condition
from rssnav.missions import HOVER, Layout, Mission, Policy, RandomPolicy, Seen, plan_mission
from rssnav.policies import (
    DistanceSearch,
    FrontierSearch,
    GaussianProcessSearch,
    Hypotheses,
    Infotaxis,
    Likelihood,
    MapParticleFilter,
    MapSearch,
    Qmdp,
)

Knows = Literal["RSS", "plan", "maps", "places", "world"]
"""Tracks: what a policy is told beside the task, its own cell and the size of the building."""


@dataclass(frozen=True, eq=False)
class Briefing:
    """What a policy is told before it flies in a building.

    A policy reads `condition`, `layout` and, as far as its track allows, `hypotheses` and `world`.
    """

    condition: Condition
    knows: Knows
    _building: Building = field(repr=False)
    _mission: Mission = field(repr=False)

    @cached_property
    def layout(self) -> Layout:
        """Size of the grid and positions of cells; the steps (S, 8) only if the plan is known.

        Without the plan all steps are -1: a policy learns them from the masks.
        """
        layout = self._building.layout
        if self.knows == "RSS":
            return replace(layout, next_state=np.full_like(layout.next_state, -1))
        return layout

    @cached_property
    def hypotheses(self) -> Hypotheses:
        """Places of the transmitter with maps: a step from each other, or where it truly may be.

        The track "maps" has coarse maps of places all over the building; "places" has the true
        places, their true maps, and how the transmitter moves among them.
        """
        if self.knows == "maps":
            return self._building.hypotheses
        if self.knows == "places":
            return Hypotheses.of_mission(self.world_of("places"), self.condition.task)
        raise ValueError(f"hypotheses: a policy of the track {self.knows!r} has no maps")

    def world_of(self, track: Knows) -> Mission:
        """Return the mission itself, to a policy of this track."""
        if self.knows != track:
            raise ValueError(f"world: a policy of the track {self.knows!r} must not see it")
        return self.condition.world(self._mission)


@dataclass(frozen=True)
class Entrant:
    """A policy that takes part.

    Parameters
    ----------
    name : str
        In tables and files.
    knows : {"RSS", "plan", "maps", "places", "world"}
        Track.
    make : callable
        Policy for a building and task, from a `Briefing`.
    source : str
        Hash of its program; flights of another program are not resumed.
    """

    name: str
    knows: Knows
    make: Callable[[Briefing], Policy]
    source: str = version("rssnav")


class Oracle:
    """Value iteration with the transmitter in sight: the fewest steps, or the least energy.

    In a cell of the goal that readings did not confirm it flies on to the highest RSS around.
    """

    def __init__(self, minimise: Literal["steps", "energy"], briefing: Briefing) -> None:
        self._mission = briefing.world_of("world")
        plan = plan_mission(self._mission, briefing.condition.task, minimise)
        self.name = plan.policy.name
        self._q = plan.policy.q.reshape(*plan.cost.shape, 8)
        self._goal = briefing.condition.task.goal.cells(self._mission)

    def begin(self, generator: np.random.Generator) -> None:
        """Nothing is kept from flight to flight."""

    def act(self, observation: Seen, mask: NDArray[np.bool_]) -> int:
        """Return the best action."""
        mode, cell = observation.mode, observation.cell
        if not self._goal[mode, cell]:
            heading = observation.heading if self._q.shape[0] > 1 else 0
            return int(np.argmax(np.where(mask, self._q[heading, mode, cell], -np.inf)))
        there = np.append(self._mission.layout.next_state[cell], cell)  # HOVER is the last action
        rss_dbm = np.where(there >= 0, self._mission.rss_dbm[mode, there], -np.inf)
        return int(np.argmax(rss_dbm))


def _random(_: Briefing) -> Policy:
    return RandomPolicy()


def _on_layout(make: Callable[..., Policy], briefing: Briefing, **settings: Any) -> Policy:
    return make(briefing.layout, **settings)


def _on_maps(make: Callable[..., Policy], briefing: Briefing, **settings: Any) -> Policy:
    return make(briefing.hypotheses, **settings)


def _on_places(make: Callable[..., Policy], briefing: Briefing) -> Policy:
    exact = Likelihood(sigma_db=max(briefing.condition.sigma_db, 1.0), temper=1.0)
    return make(briefing.hypotheses, likelihood=exact)


_LAW = partial(_on_layout, DistanceSearch)
_THOMPSON = {"targets": "thompson"}

ENTRANTS = (
    Entrant("random walk", "RSS", _random),
    Entrant("frontier search", "RSS", partial(_on_layout, FrontierSearch)),
    Entrant(
        "Gaussian process", "RSS", partial(_on_layout, GaussianProcessSearch, steps_to_choose=1)
    ),
    Entrant("distance law, Thompson", "RSS", partial(_LAW, steps_to_draw=40, **_THOMPSON)),
    Entrant("distance law, greedy", "RSS", partial(_LAW, steps_to_draw=1)),
    Entrant("distance law, greedy", "plan", partial(_LAW, steps_to_draw=1, plan_known=True)),
    Entrant("particle filter", "maps", partial(_on_maps, MapParticleFilter)),
    Entrant("maps, Thompson", "maps", partial(_on_maps, MapSearch, **_THOMPSON)),
    Entrant("maps, greedy", "maps", partial(_on_maps, MapSearch)),
    Entrant("QMDP", "maps", partial(_on_maps, Qmdp)),
    Entrant("infotaxis", "maps", partial(_on_maps, Infotaxis, space_aware=False)),
    Entrant("space-aware infotaxis", "maps", partial(_on_maps, Infotaxis)),
    Entrant("maps, greedy", "places", partial(_on_places, MapSearch)),
    Entrant("QMDP", "places", partial(_on_places, Qmdp)),
    Entrant("oracle, fewest steps", "world", partial(Oracle, "steps")),
    Entrant("oracle, least energy", "world", partial(Oracle, "energy")),
)
"""The policies that come with the benchmark. Their settings were chosen in buildings of the split
"train"."""


def entrants_of(track: str | None) -> tuple[Entrant, ...]:
    """Policies that come with the benchmark: all, or those of a track.

    Raises
    ------
    BenchmarkError
        For an unknown track.
    """
    return tuple(e for e in ENTRANTS if track is None or e.knows == _known(track))


def _known(track: str) -> Knows:
    check(track in get_args(Knows), "track", track, ", ".join(map(repr, get_args(Knows))))
    return cast(Knows, track)


def entrant_of(text: str, knows: str, name: str | None = None) -> Entrant:
    """Entrant of a function ``module:function`` that makes a policy from a `Briefing`.

    Raises
    ------
    BenchmarkError
        Unless there is such a function and track.
    """
    track = _known(knows)
    module, _, function = text.partition(":")
    if "" not in sys.path:
        sys.path.insert(0, "")  # modules of the current folder
    try:
        program = import_module(module)
        make = getattr(program, function)
    except (ImportError, AttributeError, ValueError) as error:
        raise BenchmarkError(
            f"policy {text!r}: {error}; expected module:function with a function that takes a "
            "Briefing and returns a policy"
        ) from error
    file = getattr(program, "__file__", None)
    source = sha256(Path(file).read_bytes()).hexdigest() if file else ""
    return Entrant(name or function, track, make, source)


class Guarded:
    """A policy whose impossible actions are counted as collisions and become hovering.

    Parameters
    ----------
    policy : Policy
        Who acts.
    """

    def __init__(self, policy: Policy) -> None:
        for method in ("begin", "act"):
            holds = callable(getattr(policy, method, None))
            check(holds, "policy", policy, f"an object with a method {method}")
        self._policy, self.collisions = policy, 0

    @property
    def name(self) -> str:
        """Name of the policy, if it has one."""
        return getattr(self._policy, "name", "policy")

    def begin(self, generator: np.random.Generator) -> None:
        """Begin a flight."""
        self._policy.begin(generator)

    def act(self, observation: Seen, mask: NDArray[np.bool_]) -> int:
        """Return the policy's action, or hover where it is impossible."""
        action = int(self._policy.act(observation, mask))
        if action == HOVER or (0 <= action < mask.size and mask[action]):
            return action
        self.collisions += 1
        return HOVER
