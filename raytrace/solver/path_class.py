"""What the solver knows of a path finder: classes of paths that can be summed and listed."""

from dataclasses import dataclass
from typing import Protocol

from raytrace.arrays import Ints
from raytrace.kernels.field_tables import FieldTables
from raytrace.kernels.sums import Sums
from raytrace.results.paths import Paths


@dataclass(frozen=True, eq=False)
class Evaluation:
    """What the field of paths depends on besides their geometry.

    Attributes
    ----------
    tables
        Materials, antennas and the frequency.
    min_power
        Paths whose power is known to be below this are left out [fraction of the transmitted].
    """

    tables: FieldTables
    min_power: float = 0.0


class PathClass(Protocol):
    """Some of the paths from a transmitter to receivers.

    Their beams depend on the geometry alone, so that one set of beams can be evaluated with any
    materials, antennas and frequencies.
    """

    def grow(self) -> int:
        """Grow the beams and keep them for later evaluations; return how many there are.

        Without this call each evaluation grows the beams and drops them afterwards.
        """
        ...

    def sum_paths(self, evaluation: Evaluation, beams: Ints | None = None) -> Sums:
        """Sum the paths at each receiver, or only those of some of the beams."""
        ...

    def list_paths(self, evaluation: Evaluation) -> Paths:
        """List the paths one by one."""
        ...
