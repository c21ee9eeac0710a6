"""What path classes share: beams are grown, receivers within them found, and their paths summed."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import Generic, TypeVar

import numpy as np

from raytrace.arrays import Complexes, Floats, Ints
from raytrace.kernels.bounds import height_sums
from raytrace.kernels.building import TraceGeometry
from raytrace.kernels.field_tables import FieldTables
from raytrace.kernels.guard import Guard
from raytrace.kernels.horizontal_edge_legs import HorizontalEdgeBeams
from raytrace.kernels.records import Record, new_record, no_record
from raytrace.kernels.reflections import ReflectionBeams
from raytrace.kernels.steps import PATH_BYTES, STEP_BYTES, Steps, new_steps
from raytrace.kernels.sums import Sums, new_sums, sums_of
from raytrace.kernels.vertical_edge_legs import VerticalEdgeBeams
from raytrace.kernels.workspace import Collector
from raytrace.radio.tables import pairs_of
from raytrace.results.paths import Paths
from raytrace.results.step_lanes import with_all_pairs
from raytrace.solver.limits import check_whole, nbytes, taking
from raytrace.solver.path_class import Evaluation, Evaluations, KeptRecord, grouped
from raytrace.solver.setup import BEAMS, Tracing

HIT_BATCH = 1 << 17
"""Hits that are found and evaluated in one batch, which bounds the memory of large maps."""

ALL_HITS = 1 << 62

COPIES_OF_PATHS = 3
"""Most copies of a list of paths that exist at a time, while it is sorted."""

RECORD_BYTES = 3 * 56
"""Memory of a recorded path with what finding the strongest ones takes."""

HITS, PATHS = "the receivers within the beams", "the paths"

Beams = TypeVar("Beams", ReflectionBeams, VerticalEdgeBeams, HorizontalEdgeBeams)


class HeightSums:
    """`bounds.height_sums` of a trace, computed once for all of its path classes."""

    def __init__(self, geometry: TraceGeometry) -> None:
        self._geometry = geometry
        self._known: tuple[FieldTables, Floats] | None = None

    def of(self, tables: FieldTables) -> Floats:
        """Return the sums with these tables."""
        known = self._known
        if known is None or known[0] is not tables:
            known = self._known = tables, height_sums(self._geometry, tables)
        return known[1]


class BeamClass(ABC, Generic[Beams]):
    """A `PathClass` whose paths are found by beams from the transmitter or an edge."""

    def __init__(self, tracing: Tracing, heights: HeightSums | None = None) -> None:
        self._tracing = tracing
        self._heights = heights or HeightSums(tracing.geometry)
        self._kept: tuple[Beams, float] | None = None

    @abstractmethod
    def _grow(self) -> tuple[Beams, float]:
        """Grow the beams, which have no hits yet; also bound the power in those not grown."""

    @abstractmethod
    def _n_beams(self, beams: Beams) -> int:
        """Count the beams that receivers are visible from."""

    @abstractmethod
    def _hit(self, beams: Beams, numbers: Ints, max_hits: int, guard: Guard) -> tuple[Beams, int]:
        """Find receivers within some of the beams; return how many of the beams were taken."""

    @abstractmethod
    def _evaluate(self, beams: Beams, group: Evaluations, collector: Collector) -> None:
        """Evaluate the paths of all hits."""

    @abstractmethod
    def _write_points(self, beams: Beams, record: Record, points: Floats, steps: Steps) -> None:
        """Write points (n or 1, k, 3) [m] and steps of recorded paths."""

    def _beams(self) -> tuple[Beams, float]:
        return self._grow() if self._kept is None else self._kept

    def _guard_beside(self, beams: Beams) -> Guard:
        """Return the guard of what is found within these beams."""
        return taking(self._tracing.guard, nbytes(beams, self._tracing.tree), BEAMS)

    def _least(self) -> Floats:
        """See `Tracing.least`."""
        return self._tracing.least_diffracted

    def _collector(self, group: Evaluations, record: Record, guard: Guard) -> Collector:
        evaluation, n_others = group.first, len(group.numbers) - 1
        evaluation.check_beams(self._tracing.grown_for)
        geometry, least = self._tracing.geometry, self._least()
        heights = np.zeros((0, 0))
        if len(least) or evaluation.min_power > 0.0:
            heights = self._heights.of(evaluation.tables)
        n_receivers = len(geometry.receivers.xy)
        size = n_receivers, geometry.max_reflections, evaluation.n_pairs
        sums, others = new_sums(*size), new_sums(*size, (n_others,))
        return Collector(sums, others, record, evaluation.min_power, least, heights, guard)

    def grow(self) -> int:
        """See `PathClass`."""
        self._kept = self._beams()
        return self._n_beams(self._kept[0])

    def sum_paths(self, evaluation: Evaluation, beams: Ints | None = None) -> Sums:
        """See `PathClass`."""
        return self.sum_each([evaluation], beams)[0]

    def sum_each(self, evaluations: Sequence[Evaluation], beams: Ints | None = None) -> list[Sums]:
        """See `PathClass`."""
        grown, left_out = self._beams()
        guard = self._guard_beside(grown)
        groups = grouped(tuple(evaluations), len(self._tracing.least) > 0)
        collectors = [self._collector(each, no_record(), guard) for each in groups]
        numbers = np.arange(self._n_beams(grown)) if beams is None else beams
        while len(numbers):
            batch, done = self._hit(grown, numbers, HIT_BATCH, guard)
            check_whole(guard, done > 0, HITS)
            for group, collector in zip(groups, collectors, strict=True):
                self._evaluate(batch, group, collector)
            numbers = numbers[done:]
        check_whole(guard, True, HITS)
        found: dict[int, Sums] = {}
        for group, collector in zip(groups, collectors, strict=True):
            collector.sums.not_grown[0] = left_out
            collector.others.not_grown[:] = left_out
            others = (sums_of(collector.others, f) for f in range(len(group.numbers) - 1))
            found.update(zip(group.numbers, (collector.sums, *others), strict=True))
        return [found[k] for k in range(len(evaluations))]

    def list_paths(self, evaluation: Evaluation, strongest: int | None = None) -> Paths:
        """See `PathClass`; the paths are counted first, then recorded."""
        if strongest is None:
            return self._paths(*self._recorded(evaluation), evaluation)
        beams, record = self._recorded(evaluation, RECORD_BYTES)
        receiver = beams.hits.pair[record.key[:, 0], 0]
        rows = strongest_rows(receiver, record.gain, strongest)
        return self._paths(beams, _rows(record, rows), evaluation)

    def keep_paths(self, evaluation: Evaluation) -> KeptRecord:
        """See `PathClass`."""
        beams, record = self._recorded(evaluation)
        power = record.weight * (np.abs(record.gain) ** 2).sum(axis=1)
        receiver = beams.hits.pair[record.key[:, 0], 0].astype(np.int64)

        def steps_of(rows: Ints) -> Steps:
            chosen = _rows(record, rows)
            n_max = self._max_interactions(beams)
            points, steps = np.zeros((1, n_max + 2, 3)), new_steps(len(rows), n_max)
            self._write_points(beams, chosen, points, steps)
            check_whole(self._tracing.guard, True, PATHS)
            return steps

        return KeptRecord(receiver, power, record.weight, steps_of)

    def _recorded(
        self, evaluation: Evaluation, path_bytes: int | None = None
    ) -> tuple[Beams, Record]:
        """Return the beams with all their hits, and the paths of these.

        `path_bytes` is what becomes of each path takes; by default its points, steps and copies.
        """
        grown, _ = self._beams()
        guard, n_beams = self._guard_beside(grown), self._n_beams(grown)
        beams, done = self._hit(grown, np.arange(n_beams), ALL_HITS, guard)
        check_whole(guard, done == n_beams, HITS)
        (group,), n_paths, record = grouped((evaluation,), False), 0, no_record()
        for _ in range(2):
            each = self._path_bytes(beams) if path_bytes is None else path_bytes
            taking(guard, n_paths * (each + 3 * 16 * evaluation.n_pairs), PATHS)
            record = new_record(n_paths, evaluation.n_pairs)
            self._evaluate(beams, group, self._collector(group, record, guard))
            check_whole(self._tracing.guard, True, PATHS)
            n_paths = int(record.used[0])
        return beams, record

    @abstractmethod
    def _most_walls(self, beams: Beams) -> int:
        """Most walls that the paths of these beams meet."""

    def _max_interactions(self, beams: Beams) -> int:
        config, transmissions = self._tracing.config, self._tracing.config.max_transmissions
        if transmissions is None:
            transmissions = self._most_walls(beams)
        return config.max_reflections + config.max_diffractions + transmissions

    def _path_bytes(self, beams: Beams) -> int:
        """Size of a path with its record, and of all its copies."""
        n_max = self._max_interactions(beams)
        return COPIES_OF_PATHS * (24 * (n_max + 2) + STEP_BYTES * n_max + PATH_BYTES + 48)

    def _paths(self, beams: Beams, record: Record, evaluation: Evaluation) -> Paths:
        n, n_max = len(record.gain), self._max_interactions(beams)
        points, steps = np.zeros((n, n_max + 2, 3)), new_steps(n, n_max)
        self._write_points(beams, record, points, steps)
        check_whole(self._tracing.guard, True, PATHS)
        length = np.linalg.norm(np.diff(points, axis=1), axis=2).sum(axis=1)
        receiver = beams.hits.pair[record.key[:, 0], 0].astype(np.int64)
        gain, pairs = with_all_pairs(record.gain[:, pairs_of(evaluation.tables.unknown)])
        return Paths(receiver, steps.kind, points, length, gain, record.weight, steps, pairs)


def strongest_rows(receiver: Ints, gain: Complexes, count: int) -> Ints:
    """Rows of the strongest paths of each receiver, in ascending order.

    Twice as many as `count`: two halves of a grazing path become one later
    (`Paths.with_halves_joined`).
    """
    order = np.lexsort([-(np.abs(gain) ** 2).sum(axis=1), receiver])
    first = np.searchsorted(receiver[order], receiver[order])
    return np.sort(order[np.arange(len(order)) - first < 2 * count])


def _rows(record: Record, rows: Ints) -> Record:
    """Return some of the recorded paths."""
    return record._replace(key=record.key[rows], gain=record.gain[rows], weight=record.weight[rows])
