"""What the solver knows of a path finder: classes of paths that can be summed and listed."""

import hashlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple, Protocol

import numpy as np

from raytrace.arrays import Floats, Ints
from raytrace.kernels.field_tables import FieldTables
from raytrace.kernels.steps import Steps
from raytrace.kernels.sums import PAIRS, Sums
from raytrace.results.paths import Paths
from raytrace.solver.slab_bounds import shadow_bounds


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

    @property
    def n_pairs(self) -> int:
        """Pairs of polarisations that each path has gains between, see `sums.Sums`."""
        return 1 if self.tables.unknown is None else PAIRS

    @cached_property
    def digest(self) -> bytes:
        """Digest of the tables."""
        found = hashlib.sha256()
        for entry in self.tables:
            for part in entry if isinstance(entry, tuple) else (entry,):
                array = np.ascontiguousarray(part if part is not None else [])
                found.update(repr((array.shape, array.dtype)).encode() + array.tobytes())
        return found.digest()

    def check_beams(self, grown_for: bytes | None) -> None:
        """Check that beams hold all that is strong with these materials and antennas.

        Parameters
        ----------
        grown_for
            See `Tracing`.

        Raises
        ------
        ValueError
            Where a loss limits them that was computed with others.
        """
        if grown_for is not None and grown_for != self.digest:
            raise ValueError(
                "beams that a loss limits are grown for the materials, antennas and frequency of "
                "their trace: expected the same ones, or a new trace"
            )

    @cached_property
    def shadow(self) -> Floats:
        """Bounds on the shadows of sheets, see `slab_bounds.shadow_bounds`."""
        return shadow_bounds(self.tables)


class KeptRecord(NamedTuple):
    """The paths of a class, n of them, of which some are to be kept.

    Attributes
    ----------
    receiver
        (n,) which receiver each path reaches.
    power, weight
        (n,) what each adds to the sum of powers there [fraction of the transmitted], and its
        weight.
    steps_of
        Returns the steps of some of them.
    """

    receiver: Ints
    power: Floats
    weight: Floats
    steps_of: Callable[[Ints], Steps]


class PathClass(Protocol):
    """Some of the paths from a transmitter to receivers.

    Their beams depend on the geometry alone, so that one set of beams can be evaluated with any
    materials, antennas and frequencies; unless a loss limits them, which is refused then.
    """

    def grow(self) -> int:
        """Grow the beams and keep them for later evaluations; return how many there are.

        Without this call each evaluation grows the beams and drops them afterwards.
        """
        ...

    def sum_paths(self, evaluation: Evaluation, beams: Ints | None = None) -> Sums:
        """Sum the paths at each receiver, or only those of some of the beams."""
        ...

    def sum_each(self, evaluations: Sequence[Evaluation]) -> list[Sums]:
        """Sum the paths with each of several evaluations; the beams are grown once."""
        ...

    def list_paths(self, evaluation: Evaluation, strongest: int | None = None) -> Paths:
        """List the paths one by one, or only so many of each receiver, the strongest."""
        ...

    def keep_paths(self, evaluation: Evaluation) -> KeptRecord:
        """Find the paths one by one, without their points."""
        ...
