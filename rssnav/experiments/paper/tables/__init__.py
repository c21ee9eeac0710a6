"""The tables of results, a module each. To add one, write a module and list it here."""

from collections.abc import Callable

from rssnav.experiments.paper.data import PaperData
from rssnav.experiments.paper.tables import convergence, optimum, path_lengths
from rssnav.experiments.tables import Table

TABLES: tuple[Callable[[PaperData], Table], ...] = (
    convergence.table,
    path_lengths.table,
    optimum.table,
)
"""All tables, in the order of the report."""
