"""Single paths, recorded as keys from which their points can be computed."""

from typing import NamedTuple

import numpy as np

from raytrace.arrays import Complexes, Floats, Int32s, Ints
from raytrace.kernels.compiling import jit
from raytrace.kernels.lanes import (
    ComplexLanes,
    Lanes,
    MatrixLanes,
    elements_of,
    imag_of,
    lane,
    real_of,
)


class Record(NamedTuple):
    """Arrays for n single paths.

    Attributes
    ----------
    key
        (n, 5) hit; leg to the edge; height images before and behind the edge, -1 where the path
        has none; number of the one-sided evaluation (see `raytrace.kernels.validity`).
    gain, weight
        (n, k) complex path gain, or those between k pairs of polarisations (see `Sums.field`); and
        (n,) weight of a grazing path.
    used
        (1,) number of paths found, which may exceed n; -1 if paths are not recorded.
    """

    key: Int32s
    gain: Complexes
    weight: Floats
    used: Ints


def new_record(n_paths: int, n_pairs: int = 1) -> Record:
    """Record with capacity for a number of paths, and gains between so many pairs each."""
    return Record(
        np.empty((n_paths, 5), np.int32),
        np.empty((n_paths, n_pairs), np.complex128),
        np.empty(n_paths),
        np.zeros(1, np.int64),
    )


def no_record() -> Record:
    """Record that no path is written to."""
    record = new_record(0)
    record.used[0] = -1
    return record


@jit(inner=True)
def record_paths(
    record: Record,
    hits: tuple[int, int],
    leg: int,
    images: tuple[int, int, int],
    gain: ComplexLanes | MatrixLanes,
    weight: Lanes,
) -> None:
    """Record the paths of a block that have a weight, up to the record's capacity.

    Parameters
    ----------
    record
        Written to.
    hits
        First hit of the block, and how many.
    leg, images
        See `Record.key`: the leg to the edge; both height images and the evaluation.
    gain, weight
        Of the paths.
    """
    for j in range(hits[1]):
        if lane(weight, j) == 0.0:
            continue
        k = record.used[0]
        if k < len(record.gain):
            record.key[k, 0], record.key[k, 1] = hits[0] + j, leg
            record.key[k, 2], record.key[k, 3], record.key[k, 4] = images
            for pair, part in enumerate(elements_of(gain)):
                record.gain[k, pair] = complex(lane(real_of(part), j), lane(imag_of(part), j))
            record.weight[k] = lane(weight, j)
        record.used[0] = k + 1
