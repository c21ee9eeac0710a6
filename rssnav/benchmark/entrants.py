"""Who flies: the policies that come with the benchmark, and those of others."""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property
from importlib import import_module
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from rssnav.benchmark.buildings import Building
from rssnav.missions import HOVER, Layout, Policy, RandomPolicy, Seen
from rssnav.policies import (
    DistanceSearch,
    FrontierSearch,
    GaussianProcessSearch,
    Hypotheses,
    Infotaxis,
    MapParticleFilter,
    MapSearch,
    Qmdp,
)

Knows = Literal["RSS", "plan", "maps"]


@dataclass(frozen=True, eq=False)
class Briefing:
    """What a policy is told of a building before it flies there.

    Parameters
    ----------
    building : Building
        The building; a policy reads the properties below, as far as its track allows.
    knows : {"RSS", "plan", "maps"}
        Its track.
    """

    _building: Building = field(repr=False)
    knows: Knows

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
        """Maps of a transmitter in every cell or a step from it, if maps are known."""
        if self.knows != "maps":
            raise ValueError(f"hypotheses: a policy of the track {self.knows!r} has no maps")
        return self._building.hypotheses


@dataclass(frozen=True)
class Entrant:
    """A policy that takes part.

    Parameters
    ----------
    name : str
        In tables and files.
    knows : {"RSS", "plan", "maps"}
        Track.
    make : callable
        Policy for a building, from a `Briefing`.
    """

    name: str
    knows: Knows
    make: Callable[[Briefing], Policy]


ENTRANTS = (
    Entrant("random walk", "RSS", lambda _: RandomPolicy()),
    Entrant("frontier search", "RSS", lambda b: FrontierSearch(b.layout)),
    Entrant("Gaussian process", "RSS", lambda b: GaussianProcessSearch(b.layout)),
    Entrant(
        "distance law, Thompson",
        "RSS",
        lambda b: DistanceSearch(b.layout, targets="thompson", steps_to_draw=40),
    ),
    Entrant("distance law, greedy", "RSS", lambda b: DistanceSearch(b.layout)),
    Entrant(
        "distance law, greedy, plan", "plan", lambda b: DistanceSearch(b.layout, plan_known=True)
    ),
    Entrant("particle filter", "maps", lambda b: MapParticleFilter(b.hypotheses)),
    Entrant("maps, Thompson", "maps", lambda b: MapSearch(b.hypotheses, targets="thompson")),
    Entrant("maps, greedy", "maps", lambda b: MapSearch(b.hypotheses)),
    Entrant("QMDP", "maps", lambda b: Qmdp(b.hypotheses)),
    Entrant("infotaxis", "maps", lambda b: Infotaxis(b.hypotheses, space_aware=False)),
    Entrant("space-aware infotaxis", "maps", lambda b: Infotaxis(b.hypotheses)),
)
"""The policies that come with the benchmark."""


def entrant_of(text: str, knows: str) -> Entrant:
    """Entrant of a function ``module:function`` that makes a policy from a `Briefing`.

    Raises
    ------
    ValueError
        Unless there is such a function and track.
    """
    if knows not in get_args(Knows):
        raise ValueError(f"track: {knows!r}; expected one of {', '.join(get_args(Knows))}")
    module, _, name = text.partition(":")
    if "" not in sys.path:
        sys.path.insert(0, "")  # modules of the current folder
    try:
        make = getattr(import_module(module), name)
    except (ImportError, AttributeError, ValueError) as error:
        raise ValueError(
            f"policy {text!r}: {error}; expected module:function with a function that takes a "
            "Briefing and returns a policy"
        ) from error
    track = next(track for track in get_args(Knows) if track == knows)
    return Entrant(name, track, make)


class Guarded:
    """A policy whose impossible actions are counted as collisions and become hovering.

    Parameters
    ----------
    policy : Policy
        Who acts.
    """

    def __init__(self, policy: Policy) -> None:
        self._policy, self.collisions = policy, 0

    @property
    def name(self) -> str:
        """Name of the policy."""
        return self._policy.name

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
