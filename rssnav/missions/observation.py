"""What an agent sees."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from rssnav.arguments import require
from rssnav.discrete_states import (
    AGENT_SENSITIVITY_DBM,
    ExactStates,
    Fluctuation,
    StateRule,
)


@dataclass(frozen=True)
class Observation:
    """What an agent sees, as a row of a table (tabular learners) or as numbers (environments).

    Parameters
    ----------
    reading : ExactStates, ToleranceStates, IntervalStates or None
        How a reading becomes a discrete state; None where the reading is not used.
    cell : bool
        Whether the agent knows its cell.
    heading : bool
        Whether it knows the direction it came from.
    doors : bool
        Whether it remembers the doors that it saw.
    mode : bool
        Whether it knows the mode: place of the transmitter and state of the doors.
    fluctuation : Fluctuation
        How readings differ from the map.
    sensitivity_dbm : float
        Readings that are not above it are "no signal", and equal it [dBm].

    Raises
    ------
    ValueError
        For exact states of readings that fluctuate, a reading beside the mode, and a sensitivity
        that is no number below infinity.
    """

    reading: StateRule | None = field(default_factory=ExactStates)
    cell: bool = False
    heading: bool = False
    doors: bool = False
    mode: bool = False
    fluctuation: Fluctuation = field(default_factory=Fluctuation)
    sensitivity_dbm: float = AGENT_SENSITIVITY_DBM

    def __post_init__(self) -> None:
        proper = self.sensitivity_dbm < math.inf
        require(proper, "sensitivity_dbm", self.sensitivity_dbm, "a number below infinity [dBm]")
        if self.fluctuation.sigma_db > 0.0 and isinstance(self.reading, ExactStates):
            raise ValueError(
                f"states: with readings that fluctuate (sigma_db = {self.fluctuation.sigma_db:g}) "
                "every reading would be a new exact state; use ToleranceStates or IntervalStates"
            )
        if self.mode and self.reading is not None:
            raise ValueError("mode: an agent that knows the mode needs no reading; give None")
