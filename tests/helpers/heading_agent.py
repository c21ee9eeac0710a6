"""An agent whose state is a cell and a heading, and that pays for turns."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rssnav import DecisionProcess, GridWorld, QLearning

N_HEADINGS = 8


@dataclass(frozen=True)
class HeadingAgent:
    """A step costs its length and a price per 45 degrees of turn.

    State ``8 cell + heading``: the heading is the action that led to the cell.
    """

    price_per_turn: float = 2.0
    goal_distance_m: float = 2.0
    first_heading: int = 0

    @property
    def name(self) -> str:
        return "heading"

    def decision_process(self, world: GridWorld, learning: QLearning) -> DecisionProcess:
        cell = np.repeat(np.arange(world.n_states, dtype=np.int32), N_HEADINGS)
        heading = np.tile(np.arange(N_HEADINGS), world.n_states)
        arrived = world.next_state[cell]
        next_state = np.where(arrived >= 0, N_HEADINGS * arrived + np.arange(8), -1)
        near = world.distance_m < self.goal_distance_m
        reward = -world.step_length_m - self.price_per_turn * turns(heading)
        reward = reward + np.where(near[arrived], learning.goal_reward, 0.0)
        return DecisionProcess(
            next_state=next_state.astype(np.int32),
            reward=np.where(arrived >= 0, reward, 0.0),
            terminal=near[cell],
            start=N_HEADINGS * world.start_state + self.first_heading,
            cell_of_state=cell,
        )


def turns(heading: np.ndarray) -> np.ndarray:
    """Turns of 45 degrees (n, 8) from headings (n,) to each action."""
    difference = np.abs(heading[:, None] - np.arange(8))
    return np.minimum(difference, 8 - difference)
