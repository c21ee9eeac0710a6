"""What a path's gain depends on: the surface, angle and polarisation of each of its interactions.

A path that is recorded with its steps can be evaluated for other materials, antennas and
frequencies without its geometry (docs/theory.md, section 15).
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from raytrace.arrays import Floats, Int8s, Int32s, Ints
from raytrace.kernels.compiling import jit

NOTHING, REFLECTION, DIFFRACTION, TRANSMISSION = 0, 1, 2, 3
"""Interactions, as in `Steps.kind`."""

COSINE, ALONG, ACROSS = range(3)
"""Columns of `Steps.frame`."""

LAUNCH_X, LAUNCH_Y, LAUNCH_SINE, ARRIVAL_X, ARRIVAL_Y, ARRIVAL_SINE, LENGTH, SPREADING = range(8)
"""Columns of `Steps.ends`."""

(
    FACTOR_0, SIZE_0, FACTOR_1, SIZE_1, FACTOR_2, SIZE_2, FACTOR_3, SIZE_3, ROOT_2KL, COSINE_O,
    SQUARED_O, MIXED_O, COSINE_N, SQUARED_N, MIXED_N, SHADOWS, MIXED_SHADOW, IN_ALONG, IN_ACROSS,
    OUT_ALONG, OUT_ACROSS,
) = range(21)  # fmt: skip
"""Columns of `Steps.wedge`."""

N_WEDGE = 21
STEP_BYTES, PATH_BYTES = 1 + 4 + 3 * 8, 8 * 8 + (N_WEDGE * 8 + 2 * 4)
"""Size of a step, and of a path without its steps."""


class Steps(NamedTuple):
    """What the gains of n paths depend on besides materials, antennas and frequency.

    Attributes
    ----------
    kind
        (n, most) int8 interactions, see `Paths.interactions`.
    slab
        (n, most) int32 slab of each reflection and transmission; -1 for others.
    frame
        (n, most, 3) of each reflection and transmission: the cosine of incidence, and the
        components of the arriving V and H polarisations along the normal of the plane of incidence
        times the sine of incidence.
    ends
        (n, 8) horizontal direction and sine of elevation at the transmitter; horizontal direction
        that the path comes from, and sine of elevation, at the receiver; length [m]; spreading,
        which is the gain of lossless interactions over wavelength / 4 pi.
    wedge
        (n, 21) of the diffraction, 0 for paths without: the four terms of the coefficient as pairs
        of what multiplies sqrt(2 k L) in the transition function's argument and in front of it;
        sqrt(2 k L) for a wavelength of 1 m; for the o-face and the n-face, the cosine of incidence
        and the turn of the plane of incidence (`utd.incidence_turn`); whether the sheet's shadow
        holds the transmitted field, and its turn; rotations into the edge's polarisations and back.
    face
        (n, 2) int32 slabs of the o-face and the n-face; -1 for paths without diffraction.
    """

    kind: Int8s
    slab: Int32s
    frame: Floats
    ends: Floats
    wedge: Floats
    face: Int32s


def new_steps(n_paths: int, n_max: int) -> Steps:
    """Steps of paths with up to `n_max` interactions, none of them filled in."""
    return Steps(
        np.zeros((n_paths, n_max), np.int8),
        np.full((n_paths, n_max), -1, np.int32),
        np.zeros((n_paths, n_max, 3)),
        np.zeros((n_paths, 8)),
        np.zeros((n_paths, N_WEDGE)),
        np.full((n_paths, 2), -1, np.int32),
    )


@jit(inner=True)
def write_step(
    steps: Steps, path: int, k: int, kind: int, slab: int, frame: tuple[float, float, float]
) -> None:
    """Write interaction k of a path."""
    steps.kind[path, k] = kind
    steps.slab[path, k] = slab
    for column in range(3):
        steps.frame[path, k, column] = frame[column]


@jit(inner=True)
def write_ends(
    steps: Steps,
    path: int,
    launch: tuple[float, float, float],
    arrival: tuple[float, float, float],
    length: float,
    spreading: float,
) -> None:
    """Write what a path is at its ends, see `Steps.ends`."""
    row = steps.ends[path]
    row[LAUNCH_X], row[LAUNCH_Y], row[LAUNCH_SINE] = launch
    row[ARRIVAL_X], row[ARRIVAL_Y], row[ARRIVAL_SINE] = arrival
    row[LENGTH], row[SPREADING] = length, spreading


def rows_of(steps: Steps, rows: Ints) -> Steps:
    """Return the steps of some of the paths."""
    return Steps._make(array[rows] for array in steps)


def joined(parts: Sequence[Steps]) -> Steps:
    """Return the steps of the paths of several lists, with columns for the longest one."""
    most = max(part.kind.shape[1] for part in parts)
    wide: list[Steps] = []
    for part in parts:
        n, width = part.kind.shape
        whole = new_steps(n, most)
        whole.kind[:, :width], whole.slab[:, :width] = part.kind, part.slab
        whole.frame[:, :width] = part.frame
        wide.append(part._replace(kind=whole.kind, slab=whole.slab, frame=whole.frame))
    return Steps._make(np.concatenate(arrays) for arrays in zip(*wide, strict=True))
