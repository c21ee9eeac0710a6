"""The columns that identify the configuration of a row."""

from __future__ import annotations

from rssnav.experiments.paper.data import AGENT_LABELS, Configuration
from rssnav.experiments.tables import Cell, Column

CONFIGURATION_COLUMNS = (
    Column("scenario", "Scenario"),
    Column("agent", "Agent"),
    Column("speed_mps", "Speed [m/s]"),
)


def configuration_cells(key: Configuration) -> tuple[Cell, ...]:
    """Return a configuration's cells in :data:`CONFIGURATION_COLUMNS`."""
    return key.scenario, AGENT_LABELS[key.agent], key.speed
