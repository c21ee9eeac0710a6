"""The best that can be done in a mission whose modes are seen: value iteration on its chain.

States are (heading, mode, cell). A step from cell s leads to cell s' and then the mode changes from
m to m' with probability P(m, m'), so with costs c > 0 the least expected cost to the goal solves

    V(h, m, s) = min_a  c(h, a) + sum_m' P(m, m') V(a, m', s'(m, s, a)),    V = 0 in goal cells

(Bertsekas, Dynamic Programming and Optimal Control, 4th ed., vol. II, section 3: stochastic
shortest paths). Costs are seconds, or joules where headings count.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from rssnav.arguments import require
from rssnav.missions.mission import Mission
from rssnav.missions.observation import Observation
from rssnav.missions.policy import GreedyTable
from rssnav.missions.task import Task

_NEVER = 1e9


@dataclass(frozen=True, eq=False)
class Plan:
    """Least expected costs, and the policy that attains them.

    Attributes
    ----------
    cost : (H, M, S) float64
        Expected seconds or joules to the goal; at least 1e9 where it cannot be reached. H is 1, or
        9 where headings count; the last is that of a flight that begins.
    policy : GreedyTable
        Acts on `observation`.
    observation : Observation
        What the policy must see: cell and mode, and the heading where headings count.
    expected : float
        Cost from the mission's starts, averaged over starts and first modes; those that begin in
        the goal cost nothing.
    """

    cost: NDArray[np.float64]
    policy: GreedyTable
    observation: Observation
    expected: float


def plan_mission(
    mission: Mission,
    task: Task,
    minimise: Literal["steps", "energy"] = "steps",
    *,
    tolerance: float = 1e-6,
    max_sweeps: int = 100_000,
) -> Plan:
    """Plan with the true modes in sight: an oracle for agents that only read RSS.

    Parameters
    ----------
    mission : Mission
        World; its readings do not matter.
    task : Task
        Its goal cells end a flight; limits of time and battery are left out.
    minimise : {"steps", "energy"}
        Seconds, or the energy of the task's model.
    tolerance : float
        Sweeps stop when no cost changes more than this.
    max_sweeps : int
        Most sweeps.

    Raises
    ------
    ValueError
        For energy without a model, and for what can not be minimised.
    WorldError
        When the task cannot be done in the mission.
    """
    require(minimise in ("steps", "energy"), "minimise", minimise, "'steps' or 'energy'")
    goal = task.check(mission)
    if minimise == "energy" and task.energy is None:
        raise ValueError("minimise: 'energy' needs a task with a model of energy")
    energy = minimise == "energy"
    step_cost = task.energy_j(mission) if energy else np.ones((1, 8))
    steps = mission.next_state[mission.layout_of_mode]  # (M, S, 8)
    cost, q = least_costs(goal, steps, mission.modes.transition, step_cost, tolerance, max_sweeps)
    first = cost[-1][:, mission.starts] @ mission.start_probability
    name = "least energy" if energy else "fewest steps"
    return Plan(
        cost=cost,
        policy=GreedyTable(-q.reshape(-1, 8), name=name),
        observation=Observation(None, cell=True, heading=energy, mode=True),
        expected=float(mission.modes.initial @ first),
    )


def least_costs(
    goal: NDArray[np.bool_],
    steps: NDArray[np.int32],
    transition: NDArray[np.float64],
    step_cost: NDArray[np.float64],
    tolerance: float,
    max_sweeps: int,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Least costs (H, M, S) and costs of each action (H, M, S, 8) by value iteration.

    Parameters
    ----------
    goal : (M, S) bool
        Where a flight ends.
    steps : (M, S, 8) int32
        Cell after each action, -1 where it is impossible.
    transition : (M, M) float64
        Of the modes, per second.
    step_cost : (H, 8) float64
        Cost of each action, after each heading where these count.
    tolerance, max_sweeps
        When sweeps stop.
    """
    cost = np.zeros((step_cost.shape[0], *goal.shape))
    for _ in range(max_sweeps):
        q = _q(cost, step_cost, steps, transition)
        new = np.where(goal, 0.0, np.minimum(q.min(axis=-1), _NEVER))
        change = float(np.max(np.abs(new - cost)))
        cost = new
        if change < tolerance:
            break
    return cost, _q(cost, step_cost, steps, transition)


def _q(
    cost: NDArray[np.float64],
    step_cost: NDArray[np.float64],
    steps: NDArray[np.int32],
    transition: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Cost of each action (H, M, S, 8), as one application of the Bellman operator."""
    onward = np.einsum("mn,hns->hms", transition, cost)  # before the mode changes
    m = np.arange(steps.shape[0])[:, None]
    q = np.empty((*cost.shape, 8))
    for a in range(8):
        after = onward[a if cost.shape[0] > 1 else 0][m, steps[:, :, a]]
        q[..., a] = np.where(steps[:, :, a] < 0, np.inf, step_cost[:, a, None, None] + after)
    return q
