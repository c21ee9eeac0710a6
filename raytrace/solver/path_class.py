"""What the solver knows of a path finder: classes of paths that can be summed and listed."""

import hashlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import NamedTuple, Protocol

import numpy as np

from raytrace.arrays import Floats, Ints
from raytrace.kernels.field_tables import FieldTables, FrequencyTables, OtherTables
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

    @property
    def shapes(self) -> tuple[object, ...]:
        """Equal for tables that the same kernel can take together."""
        tables = self.tables
        arrays = tables.reflection, tables.transmission, tables.transmit, *tables.patterns
        return *(array.shape for array in arrays), tables.azimuths, tables.unknown

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


class Evaluations(NamedTuple):
    """Evaluations of the same paths.

    Attributes
    ----------
    numbers
        Which of all evaluations they are.
    first
        The first one: by its tables paths are compared with thresholds.
    every
        The tables of all.
    """

    numbers: tuple[int, ...]
    first: Evaluation
    every: FrequencyTables


@lru_cache(maxsize=2)
def grouped(evaluations: tuple[Evaluation, ...], by_first: bool) -> list[Evaluations]:
    """Divide evaluations into those of the same paths, whose tables have equal shapes.

    Where a power limits the paths, each evaluation has its own, unless `by_first` says that they
    are limited by the first one. The result is kept, as all classes of a trace ask for the same.
    """
    groups: dict[object, list[int]] = {}
    for k, each in enumerate(evaluations):
        alone = k if each.min_power > 0.0 and not by_first else -1
        groups.setdefault((alone, each.shapes), []).append(k)
    return [
        Evaluations(tuple(ks), evaluations[ks[0]], _joined(*(evaluations[k].tables for k in ks)))
        for ks in groups.values()
    ]


def _joined(first: FieldTables, *others: FieldTables) -> FrequencyTables:
    if not others:
        return FrequencyTables(first)
    return FrequencyTables(
        first,
        OtherTables(
            np.array([one.wavelength for one in others]),
            np.stack([one.reflection for one in others]),
            np.stack([one.transmission for one in others]),
            np.stack([one.transmit for one in others]),
            np.stack([one.receive for one in others]),
            (
                np.stack([one.patterns[0] for one in others]),
                np.stack([one.patterns[1] for one in others]),
            ),
        ),
    )


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
        """Sum the paths with each of several evaluations; the beams are grown once.

        Where a dynamic range limits the paths, they are those of the first one.
        """
        ...

    def list_paths(self, evaluation: Evaluation, strongest: int | None = None) -> Paths:
        """List the paths one by one, or only so many of each receiver, the strongest."""
        ...

    def keep_paths(self, evaluation: Evaluation) -> KeptRecord:
        """Find the paths one by one, without their points."""
        ...
