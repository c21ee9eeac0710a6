"""Keyword options of the environments -> mission, task, observation."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from numbers import Real
from typing import Any, Literal

import numpy as np

import floorplans
from floorplans import FloorPlan
from rssnav.arguments import is_whole, require
from rssnav.discrete_states import AGENT_SENSITIVITY_DBM, Fluctuation, IntervalStates
from rssnav.doors import shut_doors, with_changed
from rssnav.maps import make_map
from rssnav.missions import (
    Mission,
    ModeProcess,
    MultirotorEnergy,
    Observation,
    ReadingAbove,
    Task,
    Within,
)
from rssnav.missions.doors import MOST_DOORS, detour_doors, mission_of_doors
from rssnav.missions.layout import WorldError
from rssnav.missions.places import mission_of_places, reachable_layout, spread_places
from rssnav.presets import PRESETS, Preset, default_preset
from rssnav.world import GridWorld

ObservationKind = Literal["rss", "history", "cell", "dict"]
_OF_THE_PAPER = ("scenario1", "scenario2")
KINDS = ("rss", "history", "cell", "dict")
_MAPS_KEPT = 8
_KINDS_OF = (("plan", str | FloorPlan, "a name or a FloorPlan"), ("hover", bool, "True or False"))
_WHOLE = {
    "seed_of_plan": (0, 2**63 - 1),
    "speed": (1, 1_000_000),
    "history": (1, 10_000),
    "places": (1, 10_000),
    "doors": (0, MOST_DOORS),
    "confirmations": (1, 2**31 - 1),
    "max_steps": (1, 2**31 - 1),
}
_OPTIONAL = ("battery_kj", "goal_dbm", "confirmation_error")
_NUMBERS = (
    *_OPTIONAL,
    *("goal_reward", "per_second", "per_kj", "goal_m", "sigma_db", "correlation"),
    "sensitivity_dbm",
    *("jump_probability", "closed_probability", "toggle_probability"),
)


@dataclass(frozen=True, kw_only=True)
class EnvOptions:
    """Options of all environments.

    Parameters
    ----------
    plan : str
        A built-in plan's name, a TOML file, or "office" for a generated office.
    seed_of_plan : int
        Of a generated office.
    speed : int
        Cells moved along an axis in one step.
    observation : {"rss", "history", "cell", "dict"}
        The latest reading, the latest ``history`` readings, the cell's number, or a dictionary of
        reading, position and mask of actions.
    history : int
        Readings in a history, the latest last.
    reward : {"rss", "closeness", "none"}
        See `rssnav.missions.Task`, also for the next four.
    goal_reward, per_second, per_kj : float
        Reward for finding the transmitter, of a second, of a kilojoule.
    battery_kj : float or None
        Energy after which an episode is truncated; None for no limit.
    max_steps : int
        Seconds after which it is truncated.
    goal_dbm : float or None
        Reading above which the transmitter is found [dBm]; None to find it within ``goal_m``, but
        above -21 dBm at its own place in the paper's two plans.
    goal_m : float
        Distance below which it is found if ``goal_dbm`` is None [m].
    confirmations : int
        Readings whose mean must exceed ``goal_dbm``.
    confirmation_error : float or None
        Probability of a false alarm, if a sequential test is to decide (`ReadingAbove.error`).
    sigma_db, correlation : float
        Fluctuation of readings: standard deviation and correlation in time.
    sensitivity_dbm : float
        Weakest reading that is a signal [dBm].
    places : int
        Places of the transmitter; the plan's own is the first, the others are spread over it.
    jump_probability : float
        Probability that it moves to another place, per second.
    doors : int
        Most doors that open and close: of the plan's open ones those whose closing lengthens the
        ways to the places most and cuts no cell off (`rssnav.missions.detour_doors`). A generated
        office then has doors between its rooms, too.
    closed_probability, toggle_probability : float
        Probability that a door is closed when an episode begins, and that it opens or closes, per
        second.
    hover : bool
        Whether a ninth action stays in the cell for one more reading.

    Raises
    ------
    ValueError
        For a value out of range, and for confirmations of a goal that no reading decides.
    """

    plan: str | FloorPlan
    seed_of_plan: int = 0
    speed: int = 1
    observation: ObservationKind = "rss"
    history: int = 8
    reward: Literal["rss", "closeness", "none"] = "rss"
    goal_reward: float = 1000.0
    per_second: float = 0.0
    per_kj: float = 0.0
    battery_kj: float | None = None
    max_steps: int = 20_000
    goal_dbm: float | None = None
    goal_m: float = 2.0
    confirmations: int = 1
    confirmation_error: float | None = None
    sigma_db: float = 0.0
    correlation: float = 0.0
    sensitivity_dbm: float = AGENT_SENSITIVITY_DBM
    places: int = 1
    jump_probability: float = 0.0
    doors: int = 0
    closed_probability: float = 0.5
    toggle_probability: float = 0.0
    hover: bool = False

    def __post_init__(self) -> None:
        require(self.observation in KINDS, "observation", self.observation, " or ".join(KINDS))
        for name, kind, expected in _KINDS_OF:
            value = getattr(self, name)
            require(isinstance(value, kind), name, value, expected)
        for name, (low, high) in _WHOLE.items():
            value = getattr(self, name)
            require(is_whole(value, low, high), name, value, f"a whole number from {low} to {high}")
        for name in _NUMBERS:
            value = getattr(self, name)
            missing = value is None and name in _OPTIONAL
            require(missing or isinstance(value, Real), name, value, "a number")
        for name in ("jump_probability", "closed_probability", "toggle_probability"):
            value = getattr(self, name)
            require(0.0 <= value <= 1.0, name, value, "a number in [0, 1]")
        if self.confirmations > 1 or self.confirmation_error is not None:
            by_reading = isinstance(self.task().goal, ReadingAbove)
            require(by_reading, "goal_dbm", self.goal_dbm, "a level for the readings that confirm")

    @classmethod
    def of(cls, **options: Any) -> EnvOptions:
        """Options from keywords.

        Raises
        ------
        TypeError
            For an unknown keyword, with those that there are, or without a plan.
        """
        known = cls.__dataclass_fields__
        for name in options:
            if name not in known:
                raise TypeError(f"{name}: no such option; there are {', '.join(known)}")
        if "plan" not in options:
            raise TypeError("plan: missing; give a built-in plan's name, a TOML file or 'office'")
        return cls(**options)

    def floor_plan(self) -> FloorPlan:
        """Load or generate the plan."""
        if isinstance(self.plan, FloorPlan):
            return self.plan
        if self.plan == "office":
            return _office(self.seed_of_plan, connected=self.doors > 0)
        return floorplans.load(self.plan)

    def mission(self) -> Mission:
        """World of these options; its maps are computed once in a process.

        Raises
        ------
        WorldError
            For doors, where the plan has none that can be closed.
        """
        mission = _mission(self.floor_plan(), self.preset(), self.speed, self.places, self.doors)
        n_doors = mission.closed.shape[1]
        doors = ModeProcess.switching(n_doors, self.closed_probability, self.toggle_probability)
        return mission.with_modes(
            doors.times(ModeProcess.jumping(self.places, self.jump_probability))
        )

    def preset(self) -> Literal["paper", "building"]:
        """Limits of the traces."""
        return default_preset(self.plan) if isinstance(self.plan, str) else "building"

    def task(self) -> Task:
        """Aim of these options."""
        energy = MultirotorEnergy() if self.per_kj != 0.0 or self.battery_kj is not None else None
        level = self.goal_dbm
        if level is None and self.plan in _OF_THE_PAPER and self.places == 1:
            level = -21.0
        goal = Within(self.goal_m)
        if level is not None:
            goal = ReadingAbove(level, self.confirmations, self.confirmation_error)
        return Task(
            goal=goal,
            reward=self.reward,
            goal_reward=self.goal_reward,
            per_second=self.per_second,
            per_kj=self.per_kj,
            energy=energy,
            battery_kj=float("inf") if self.battery_kj is None else self.battery_kj,
            max_steps=self.max_steps,
        )

    def senses(self) -> Observation:
        """Senses of these options; environments make their own observation of them."""
        return Observation(
            IntervalStates((0.0,)),
            cell=self.observation == "cell",
            fluctuation=Fluctuation(self.sigma_db, self.correlation),
            sensitivity_dbm=self.sensitivity_dbm,
        )


def _office(seed: int, *, connected: bool) -> FloorPlan:
    """Generate an office; a connected one has doors between rooms, and all doors are open."""
    plan = floorplans.generate(
        "office", seed, area_m2=600.0, connecting_doors=1.0 if connected else 0.0
    )
    return with_changed(plan, shut_doors(plan)) if connected else plan


@lru_cache(_MAPS_KEPT)
def _mission(
    plan: FloorPlan, preset: Literal["paper", "building"], speed: int, places: int, doors: int
) -> Mission:
    config = PRESETS[preset].config
    antenna = PRESETS[preset].antenna
    if doors > 0:
        return _mission_with_doors(plan, PRESETS[preset], speed, places, doors)
    if places == 1:
        radio_map = make_map(plan, config=config, receive_antenna=antenna)
        return GridWorld.from_map(plan, radio_map, speed).mission()
    spread = spread_places(plan, places, speed)
    return mission_of_places(plan, spread, speed, config=config, receive_antenna=antenna)


def _mission_with_doors(
    plan: FloorPlan, preset: Preset, speed: int, n_places: int, n_doors: int
) -> Mission:
    layout = reachable_layout(plan, speed)
    places = spread_places(plan, n_places, speed)
    doors = detour_doors(plan, layout, places, n_doors)
    if not doors:
        raise WorldError(
            f"doors: plan {plan.name!r} has no open door that lengthens the ways when it is closed "
            "and cuts no cell off"
        )
    return mission_of_doors(
        plan,
        layout,
        doors,
        places,
        starts=np.array([layout.nearest(*plan.require_start())]),
        config=preset.config,
        antenna=preset.antenna,
    )
