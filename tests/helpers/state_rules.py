"""Rules for discrete states, applied to readings outside of a training."""

import numpy as np

from rssnav import Fluctuation
from rssnav.discrete_states import GoalRule, reading_states
from rssnav.kernels import q_learning_from_readings as kernel
from rssnav.kernels.common import N_COUNTERS, N_DISCRETE_STATES

GOAL = GoalRule(terminal_dbm=-21.0, reward=1000.0, replaces=False)


def states_of(rule, readings):
    """Discrete states that a rule gives to readings (which also span its range) as they come."""
    readings = np.array(readings, dtype=float)
    states = reading_states(rule, Fluctuation(), readings, GOAL)
    known = kernel.KnownStates(
        np.full(states.n_bins, -1, dtype=np.int32),
        np.zeros(states.max_discrete_states),
        np.zeros(1),
        np.full(1, -1, dtype=np.int32),
    )
    counters = np.zeros(N_COUNTERS, dtype=np.int64)
    counters[N_DISCRETE_STATES] = states.n_initial
    return [
        kernel.discrete_state_of(states.sensor, known, counters, cell, reading)
        for cell, reading in enumerate(readings)
    ]
