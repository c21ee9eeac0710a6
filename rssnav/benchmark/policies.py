"""Who flies: the policies that come with the benchmark, and those of others."""

from __future__ import annotations

import sys
from collections.abc import Callable
from copy import deepcopy
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from hashlib import sha256
from importlib import import_module
from importlib.metadata import version
from operator import index
from pathlib import Path
from typing import Any, Literal, cast, get_args

import numpy as np
from numpy.typing import NDArray

from rssnav.benchmark.buildings import Building
from rssnav.benchmark.errors import BenchmarkError, check
from rssnav.benchmark.protocol import Condition
from rssnav.missions import HOVER, Layout, Mission, Policy, RandomPolicy, Seen, plan_mission
from rssnav.missions.door_planning import plan_by_sight
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

Track = Literal["RSS", "plan", "maps", "places", "world"]
"""What a policy is told beside the condition, its own cell and the size of the building."""


@dataclass(frozen=True, eq=False)
class Briefing:
    """What a policy is told before it flies in a building.

    A policy reads `condition`, `layout` and, as far as its track allows, `hypotheses` and
    `world_of`. What it gets are copies: it may write into them, and no other policy sees that.
    """

    condition: Condition
    track: Track
    _building: Building = field(repr=False)
    _mission: Mission = field(repr=False)

    @cached_property
    def layout(self) -> Layout:
        """Size of the grid and positions of cells; the steps (S, 8) only if the plan is known.

        Without the plan all steps are -1: a policy learns them from the masks. Where doors open and
        close, the steps are those with all of them open.
        """
        layout = deepcopy(self._building.layout)
        if self.track == "RSS":
            return replace(layout, next_state=np.full_like(layout.next_state, -1))
        return layout

    @cached_property
    def hypotheses(self) -> Hypotheses:
        """Places of the transmitter with maps: a step from each other, or where it truly may be.

        The track "maps" has coarse maps of places all over the building; "places" has the true
        places, their true maps in each state of the doors, and how the transmitter moves among
        them.
        """
        if self.track == "maps":
            _ = self._building.hypotheses.hops  # found once, for all policies
            return deepcopy(self._building.hypotheses)
        if self.track == "places":
            return Hypotheses.of_mission(self.world_of("places"), self.condition.task)
        raise ValueError(f"hypotheses: a policy of the track {self.track!r} has no maps")

    def world_of(self, track: Track) -> Mission:
        """Return the mission itself, to a policy of this track."""
        if self.track != track:
            raise ValueError(f"world: a policy of the track {self.track!r} must not see it")
        return deepcopy(self.condition.world(self._mission))


@dataclass(frozen=True)
class PolicySpec:
    """How a policy that takes part is made.

    Parameters
    ----------
    name : str
        In tables and files.
    track : {"RSS", "plan", "maps", "places", "world"}
        Track.
    make : callable
        Policy for a building and condition, from a `Briefing`.
    source : str
        Hash of its program; flights of another program are not resumed.
    """

    name: str
    track: Track
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


def _by_sight(briefing: Briefing) -> Policy:
    """Oracle for the transmitter alone: doors are known only where they were seen."""
    mission = briefing.world_of("world")
    if not mission.closed.size:
        return Oracle("steps", briefing)
    return plan_by_sight(mission, briefing.condition.task).policy


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

POLICIES = (
    PolicySpec("random walk", "RSS", _random),
    PolicySpec("frontier search", "RSS", partial(_on_layout, FrontierSearch)),
    PolicySpec(
        "Gaussian process", "RSS", partial(_on_layout, GaussianProcessSearch, steps_to_choose=1)
    ),
    PolicySpec("distance law, Thompson", "RSS", partial(_LAW, steps_to_draw=40, **_THOMPSON)),
    PolicySpec("distance law, greedy", "RSS", partial(_LAW, steps_to_draw=1)),
    PolicySpec("distance law, greedy", "plan", partial(_LAW, steps_to_draw=1, plan_known=True)),
    PolicySpec(
        "distance law, doors forgotten",
        "plan",
        partial(_LAW, steps_to_draw=1, plan_known=True, remembers=False),
    ),
    PolicySpec("particle filter", "maps", partial(_on_maps, MapParticleFilter)),
    PolicySpec("maps, Thompson", "maps", partial(_on_maps, MapSearch, **_THOMPSON)),
    PolicySpec("maps, greedy", "maps", partial(_on_maps, MapSearch)),
    PolicySpec("QMDP", "maps", partial(_on_maps, Qmdp)),
    PolicySpec("infotaxis", "maps", partial(_on_maps, Infotaxis, space_aware=False)),
    PolicySpec("space-aware infotaxis", "maps", partial(_on_maps, Infotaxis)),
    PolicySpec("maps, greedy", "places", partial(_on_places, MapSearch)),
    PolicySpec("QMDP", "places", partial(_on_places, Qmdp)),
    PolicySpec("oracle, fewest steps", "world", partial(Oracle, "steps")),
    PolicySpec("oracle, doors by sight", "world", _by_sight),
    PolicySpec("oracle, least energy", "world", partial(Oracle, "energy")),
)
"""The policies that come with the benchmark. Their settings were chosen in buildings of the split
"train"."""


def policies_of(track: str | None) -> tuple[PolicySpec, ...]:
    """Policies that come with the benchmark: all, or those of a track.

    Raises
    ------
    BenchmarkError
        For an unknown track.
    """
    return tuple(spec for spec in POLICIES if track is None or spec.track == _known(track))


def _known(track: str) -> Track:
    check(track in get_args(Track), "track", track, ", ".join(map(repr, get_args(Track))))
    return cast(Track, track)


def policy_of(text: str, track: str, name: str | None = None) -> PolicySpec:
    """Specification of a function ``module:function`` that makes a policy from a `Briefing`.

    Raises
    ------
    BenchmarkError
        Unless there is such a function and track.
    """
    known = _known(track)
    module, _, function = text.partition(":")
    if "" not in sys.path:
        sys.path.insert(0, "")  # modules of the current folder
    try:
        program = import_module(module)
        make = getattr(program, function)
    except (ImportError, AttributeError, ValueError, SystemExit) as error:
        raise BenchmarkError(
            f"policy {text!r}: {error}; expected module:function with a function that takes a "
            "Briefing and returns a policy"
        ) from error
    check(callable(make), "policy", text, "a function that takes a Briefing and returns a policy")
    file = getattr(program, "__file__", None)
    source = sha256(Path(file).read_bytes()).hexdigest() if file else ""
    return PolicySpec(name or function, known, make, source)


def _exited(name: str, exit_: SystemExit) -> BenchmarkError:
    """Error of a policy that would end the benchmark without a word."""
    return BenchmarkError(f"policy {name!r}: it called exit({exit_.code!r}); expected it to return")


class Guarded:
    """A policy whose impossible actions are counted as collisions and become hovering.

    Parameters
    ----------
    policy : Policy
        Who acts.
    """

    @classmethod
    def made(cls, spec: PolicySpec, briefing: Briefing) -> Guarded:
        """Make a policy.

        Raises
        ------
        BenchmarkError
            When it calls exit.
        """
        try:
            return cls(spec.make(briefing))
        except SystemExit as exit_:
            raise _exited(spec.name, exit_) from exit_

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
        """Begin a flight.

        Raises
        ------
        BenchmarkError
            When the policy calls exit.
        """
        try:
            self._policy.begin(generator)
        except SystemExit as exit_:
            raise _exited(self.name, exit_) from exit_

    def act(self, observation: Seen, mask: NDArray[np.bool_]) -> int:
        """Return the policy's action, or hover where it is impossible.

        Raises
        ------
        BenchmarkError
            For what is no whole number, and when the policy calls exit.
        """
        try:
            chosen: object = self._policy.act(observation, mask.copy())
        except SystemExit as exit_:
            raise _exited(self.name, exit_) from exit_
        try:
            action = index(chosen)  # pyright: ignore[reportArgumentType]
        except TypeError:
            raise BenchmarkError(
                f"policy {self.name!r}: action {chosen!r}; expected a whole number, 0 to 7 or HOVER"
            ) from None
        if action == HOVER or (0 <= action < mask.size and mask[action]):
            return action
        self.collisions += 1
        return HOVER
