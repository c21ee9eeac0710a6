"""Flights of a policy in a mission, and what they cost."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rssnav.arguments import is_whole, require
from rssnav.kernels import fleet as kernel
from rssnav.kernels import stepping
from rssnav.missions.mission import Mission
from rssnav.missions.observation import Observation
from rssnav.missions.policy import HOVER, Policy, Seen
from rssnav.missions.tables import mission_moves, sensor_tables
from rssnav.missions.task import Task

_STREAM = 1 << 33  # added to the numbers of flights: streams that no training uses


@dataclass(frozen=True, eq=False)
class Flights:
    """Flights of a policy (N of them).

    Attributes
    ----------
    found : (N,) bool
        Whether the episode ended where the transmitter is, by the mission's fields.
    false_alarm : (N,) bool
        Whether it ended elsewhere, by a fluctuation of the reading.
    steps : (N,) int64
        Seconds flown, hovering included.
    length_m : (N,) float64
        Length flown [m].
    energy_kj : (N,) float64
        Energy [kJ]; 0 without a model.
    turns : (N,) int64
        Changes of direction.
    turned_deg : (N,) float64
        Their sum [degrees].
    reward : (N,) float64
        Sum of the rewards.
    mode : (N, 2) int64
        Mode at the begin and at the end.
    cells : tuple of (n + 1,) int32
        Cell after each action, the start first.
    modes : tuple of (n + 1,) int32
        Mode of the reading in each of them.
    """

    found: NDArray[np.bool_]
    false_alarm: NDArray[np.bool_]
    steps: NDArray[np.int64]
    length_m: NDArray[np.float64]
    energy_kj: NDArray[np.float64]
    turns: NDArray[np.int64]
    turned_deg: NDArray[np.float64]
    reward: NDArray[np.float64]
    mode: NDArray[np.int64]
    cells: tuple[NDArray[np.int32], ...]
    modes: tuple[NDArray[np.int32], ...]

    @property
    def actions(self) -> NDArray[np.int64]:
        """Steps and hovering that the policy chose (N,): all but the readings that confirm."""
        return np.array([len(cells) - 1 for cells in self.cells], dtype=np.int64)

    def spl(self, shortest: NDArray[np.float64]) -> float:
        """Success weighted by path length (Anderson et al. 2018, arXiv:1807.06757).

        Lengths are counted in actions, so readings that confirm the goal add nothing.

        Parameters
        ----------
        shortest : (N,) float64
            Fewest steps that each flight could have taken.
        """
        return weighted_by_length(self.found, shortest, self.actions)


def weighted_by_length(
    found: NDArray[np.bool_], shortest: NDArray[np.float64], flown: NDArray[np.int64]
) -> float:
    """Success weighted by path length, see `Flights.spl`, of N flights."""
    return float(np.mean(found * shortest / np.maximum(shortest, flown)))


class Flyer:
    """One flight at a time in a mission.

    Parameters
    ----------
    mission, task, observation
        World, aim and senses.
    """

    def __init__(self, mission: Mission, task: Task, observation: Observation) -> None:
        self.mission, self.task, self.observation = mission, task, observation
        self.moves = mission_moves(mission)
        self.sensor = sensor_tables(mission, task, observation).of_one_run()
        self.fleet = kernel.Fleet.of_size(1)
        self._row = np.zeros(1, dtype=np.int64)
        self._masks = mission.next_state >= 0

    def begin(self, generator: NDArray[np.uint64]) -> Seen:
        """Begin an episode whose random numbers come from a xoshiro256++ state (4,)."""
        self.fleet.generator[0], self.fleet.real[0] = generator, 0.0
        kernel.begin_all(self.moves, self.sensor, self.fleet)
        return self.seen()

    def step(self, action: int) -> tuple[float, int]:
        """Fly an action: (reward, RUNNING, FOUND or TRUNCATED).

        Raises
        ------
        ValueError
            For what is no action; an impossible one leaves the UAV where it is.
        """
        if not is_whole(action, 0, HOVER):
            raise ValueError(f"action {action!r}: expected a whole number from 0 to 7, or HOVER")
        kernel.step_running(self.moves, self.sensor, self.fleet, np.array([action]))
        return float(self.fleet.reward[0]), int(self.fleet.status[0])

    @property
    def energy_kj(self) -> float:
        """Energy used since the episode began [kJ]; 0 without a model."""
        return float(self.fleet.real[0, stepping.ENERGY_J]) / 1000.0

    def mask(self) -> NDArray[np.bool_]:
        """Possible actions (8,), a copy."""
        mode, cell = self.fleet.whole[0, :2]
        return self._masks[self.mission.layout_of_mode[mode], cell].copy()

    def seen(self) -> Seen:
        """What the agent sees."""
        kernel.rows_of(self.sensor, self.fleet, self._row)
        mode, cell, heading, memory, seconds = self.fleet.whole[0].tolist()
        observes, doors = self.observation, self.sensor.doors.n_doors
        return Seen(
            reading_dbm=float(self.fleet.real[0, stepping.READING_DBM]),
            row=int(self._row[0]),
            cell=cell if observes.cell else -1,
            heading=heading if observes.heading else -1,
            mode=mode if observes.mode else -1,
            doors_seen=memory >> doors if observes.doors else -1,
            doors_closed=memory & ((1 << doors) - 1) if observes.doors else -1,
            seconds=seconds,
        )


def fly(
    mission: Mission,
    task: Task,
    observation: Observation,
    policy: Policy,
    *,
    episodes: int = 100,
    seed: int = 0,
    progress: Callable[[int, int], None] | None = None,
) -> Flights:
    """Fly a policy in a mission.

    Parameters
    ----------
    mission, task, observation
        World, aim and senses.
    policy : Policy
        Who acts.
    episodes : int
        Number N of flights.
    seed : int
        Same seed, same flights. The world's random numbers do not depend on the policy's.
    progress : callable, optional
        Called as ``progress(done, episodes)``.

    Raises
    ------
    ValueError
        For less than one episode, and when the policy returns what is no action.
    """
    require(is_whole(episodes, 1, _STREAM), "episodes", episodes, "a whole number of at least 1")
    flyer, goal = Flyer(mission, task, observation), task.goal.cells(mission)
    flown: list[_Flown] = []
    for episode in range(episodes):
        seeds = np.random.SeedSequence(seed, spawn_key=(_STREAM + episode,))
        words = seeds.generate_state(4, np.uint64).astype(np.uint64)
        policy.begin(np.random.default_rng(seeds.spawn(1)[0]))
        flown.append(_one(flyer, policy, words))
        if progress is not None:
            progress(episode + 1, episodes)
    return _flights(mission, goal, flown)


@dataclass(frozen=True, eq=False)
class _Flown:
    actions: list[int]
    cells: list[int]
    rewards: float
    modes: list[int]
    status: int
    seconds: int
    energy_j: float


def _one(flyer: Flyer, policy: Policy, generator: NDArray[np.uint64]) -> _Flown:
    seen = flyer.begin(generator)
    whole = flyer.fleet.whole[0]
    modes, cells = [int(whole[stepping.MODE])], [int(whole[stepping.CELL])]
    actions: list[int] = []
    total, status = 0.0, stepping.RUNNING
    while status == stepping.RUNNING:
        action = policy.act(seen, flyer.mask())
        reward, status = flyer.step(action)
        total += reward
        actions.append(action)
        cells.append(int(whole[stepping.CELL]))
        modes.append(int(whole[stepping.MODE]))
        seen = flyer.seen()
    return _Flown(
        actions,
        cells,
        total,
        modes,
        status,
        int(whole[stepping.SECONDS]),
        float(flyer.fleet.real[0, stepping.ENERGY_J]),
    )


def _flights(mission: Mission, goal: NDArray[np.bool_], flown: list[_Flown]) -> Flights:
    ended = np.array([f.status == stepping.FOUND for f in flown])
    there = np.array([goal[f.modes[-1], f.cells[-1]] for f in flown])
    turned = [_turned_deg(f.actions) for f in flown]
    length_m = np.append(mission.layout.step_length_m, 0.0)
    moved = [np.diff(f.cells) != 0 for f in flown]
    return Flights(
        found=ended & there,
        false_alarm=ended & ~there,
        steps=np.array([f.seconds for f in flown], dtype=np.int64),
        length_m=np.array(
            [length_m[np.array(f.actions)[m]].sum() for f, m in zip(flown, moved, strict=True)]
        ),
        energy_kj=np.array([f.energy_j / 1000.0 for f in flown]),
        turns=np.array([np.count_nonzero(t) for t in turned], dtype=np.int64),
        turned_deg=np.array([t.sum() for t in turned]),
        reward=np.array([f.rewards for f in flown]),
        mode=np.array([(f.modes[0], f.modes[-1]) for f in flown], dtype=np.int64),
        cells=tuple(np.array(f.cells, dtype=np.int32) for f in flown),
        modes=tuple(np.array(f.modes, dtype=np.int32) for f in flown),
    )


def _turned_deg(actions: list[int]) -> NDArray[np.float64]:
    """Angle between successive steps [degrees]; hovering keeps the direction."""
    flown = np.array([a for a in actions if a != stepping.HOVER], dtype=np.int64)
    difference = np.abs(np.diff(flown))
    return 45.0 * np.minimum(difference, 8 - difference)
