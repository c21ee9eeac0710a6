"""The best that can be done by one who knows where the transmitter is, but doors only by sight.

Doors stay as they are while a flight lasts. A state is (place, memory, cell): the memory holds
which doors were seen, and which of them are closed. Arriving in a cell s' from where doors are seen
that were not before, the memory becomes u' with the probability that these are so, given what it
held. With g the probability that the transmitter is found in s', the fewest expected steps solve

    V(p, u, s) = min_a  1 + sum_u' P(u' | p, u, s') (1 - g(p, u', s')) V(p, u', s').

That it was not found in s' teaches nothing here. A memory of more doors is solved first.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from rssnav.missions.layout import WorldError
from rssnav.missions.mission import Mission
from rssnav.missions.observation import Observation
from rssnav.missions.policy import Seen
from rssnav.missions.task import Task

_NEVER = 1e9
_TOLERANCE, _MOST_SWEEPS = 1e-9, 10_000

Memory = tuple[int, int]
"""Bits of the doors that were seen, and of those of them that are closed."""


@dataclass(frozen=True, eq=False)
class DoorPlan:
    """Fewest expected steps with a memory of doors, and the policy that attains them.

    Attributes
    ----------
    expected : float
        Steps from the mission's starts, averaged over starts and first modes.
    policy : DoorPolicy
        Acts on `observation`.
    observation : Observation
        Cell, doors seen, and the mode, of which the policy uses the transmitter's place only.
    """

    expected: float
    policy: DoorPolicy
    observation: Observation


@dataclass(eq=False)
class DoorPolicy:
    """The best action by place, doors seen and cell.

    Parameters
    ----------
    place_of_mode : (M,) int64
        Number of the transmitter's place.
    action_cost : dict
        Expected steps of each action (P, S, 8) by memory.
    """

    place_of_mode: NDArray[np.int64]
    action_cost: dict[Memory, NDArray[np.float64]] = field(repr=False)
    name: str = "fewest steps, doors by sight"

    def begin(self, generator: np.random.Generator) -> None:
        """Nothing is kept from flight to flight."""

    def act(self, observation: Seen, mask: NDArray[np.bool_]) -> int:
        """Return the best possible action."""
        costs = self.action_cost[observation.doors_seen, observation.doors_closed]
        place = self.place_of_mode[observation.mode]
        return int(np.argmin(np.where(mask, costs[place, observation.cell], np.inf)))


def plan_by_sight(mission: Mission, task: Task) -> DoorPlan:
    """Plan the fewest steps with the transmitter's place in sight, and doors only when seen.

    Parameters
    ----------
    mission : Mission
        With doors, and modes that stay as they are.
    task : Task
        Its goal cells end a flight; limits of time and battery are left out.

    Raises
    ------
    WorldError
        When modes change during a flight, or the task cannot be done.
    """
    if mission.modes.changes:
        raise WorldError(
            f"mission {mission.name!r}: its modes change during a flight; planning by sight needs "
            "doors and a transmitter that stay as they are"
        )
    return _Planner(mission, task).plan()


class _Planner:
    def __init__(self, mission: Mission, task: Task) -> None:
        self.mission, self.goal = mission, task.check(mission)
        n_doors = mission.closed.shape[1]
        bits = 1 << np.arange(n_doors, dtype=np.int64)
        self.sees = (mission.sees @ bits) if n_doors else np.zeros(mission.n_states, np.int64)
        self.closed = (mission.closed @ bits) if n_doors else np.zeros(mission.n_modes, np.int64)
        _, self.place = np.unique(mission.source, axis=0, return_inverse=True)
        self.n_places = int(self.place.max()) + 1
        self.arriving: dict[Memory, NDArray[np.float64]] = {}
        self.action_cost: dict[Memory, NDArray[np.float64]] = {}
        self.memories = sorted(
            {
                (seen, int(closed) & seen)
                for seen in range(2**n_doors)
                for closed in np.unique(self.closed)
            },
            key=lambda memory: -memory[0].bit_count(),
        )

    def plan(self) -> DoorPlan:
        for memory in self.memories:
            self._solve(memory)
        starts, weights = self.mission.starts, self.mission.start_probability
        arrived = self._after((0, 0))[:, starts] @ weights
        share = np.bincount(self.place, self.mission.modes.initial, self.n_places)
        return DoorPlan(
            expected=float(share @ arrived),
            policy=DoorPolicy(self.place, self.action_cost),
            observation=Observation(None, cell=True, doors=True, mode=True),
        )

    def _weights(self, memory: Memory) -> NDArray[np.float64]:
        """Probability of each mode given place and memory, shape (P, M)."""
        seen, closed = memory
        likely = np.where(self.closed & seen == closed, self.mission.modes.initial, 0.0)
        weights = np.zeros((self.n_places, likely.size))
        weights[self.place, np.arange(likely.size)] = likely
        return weights / np.maximum(weights.sum(axis=1, keepdims=True), 1e-300)

    def _after(self, memory: Memory) -> NDArray[np.float64]:
        """Steps expected on arrival in each cell (P, S) where all doors in sight were seen, else 0.

        Where others come into sight, they are weighed by the memories that these lead to.
        """
        seen, closed = memory
        weights = self._weights(memory)
        expected = np.zeros((self.n_places, self.sees.size))
        for fresh in np.unique(self.sees & ~seen):
            cells = self.sees & ~seen == fresh
            if not fresh and memory in self.arriving:
                expected[:, cells] = self.arriving[memory][:, cells]
            for state in np.unique(self.closed & fresh) if fresh else ():
                chance = weights @ (self.closed & fresh == state)
                onward = self.arriving[seen | int(fresh), closed | int(state)]
                expected[:, cells] += chance[:, None] * onward[:, cells]
        return expected

    def _solve(self, memory: Memory) -> None:
        """Solve for one memory, given all that hold more doors."""
        seen, closed = memory
        elsewhere, known = self._after(memory), self.sees & ~seen == 0
        missed = 1.0 - self._weights(memory) @ self.goal  # (P, S) probability not to find it here
        which = int(np.argmax(self.closed & seen == closed))
        steps = self.mission.next_state[self.mission.layout_of_mode[which]]
        value, arriving, costs = np.zeros_like(elsewhere), elsewhere, elsewhere
        for _ in range(_MOST_SWEEPS):
            arriving = np.where(known, missed * value, elsewhere)
            costs = np.where(steps < 0, np.inf, 1.0 + arriving[:, steps])
            new = np.minimum(costs.min(axis=-1), _NEVER)
            change = np.max(np.abs(new - value))
            value = new
            if change < _TOLERANCE:
                break
        self.arriving[memory] = arriving
        self.action_cost[memory] = costs
