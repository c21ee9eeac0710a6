"""Steps of paths in the layout of the kernels that evaluate them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from raytrace.arrays import Complexes, Floats, Ints
from raytrace.kernels.field_tables import FieldTables
from raytrace.kernels.lanes import WIDTH
from raytrace.kernels.step_gains import DIFFRACTED, StepLanes, write_gains
from raytrace.kernels.steps import DIFFRACTION, REFLECTION, TRANSMISSION, Steps


def step_lanes(steps: Steps) -> tuple[StepLanes, Ints]:
    """Sort paths by their interactions, those with a diffraction last, in blocks of eight.

    Returns
    -------
    lanes
        The steps of n blocks.
    path
        (n, 8) which path each is; -1 for what fills up the last block.
    """
    code = _codes(steps)
    is_diffracted = (steps.kind == DIFFRACTION).any(axis=1)
    order = np.lexsort([*np.sign(code).T[::-1], is_diffracted])
    path = np.concatenate(
        [_filled(order[~is_diffracted[order]]), _filled(order[is_diffracted[order]])]
    )
    n_plain = len(_filled(np.flatnonzero(~is_diffracted)))
    path_or_last = np.where(path < 0, path[_last_real(path)], path)
    diffracted = path_or_last[n_plain:]
    used = int((steps.kind != 0).sum(axis=1).max(initial=0))
    return StepLanes(
        blocks_of(code[path_or_last, :used]),
        blocks_of(steps.frame[path_or_last, :used]),
        blocks_of(steps.ends[path_or_last]),
        blocks_of(steps.wedge[diffracted]),
        blocks_of(np.maximum(steps.face[diffracted], 0).astype(np.float64)),
    ), path.reshape(-1, WIDTH)


def blocks_of(paths: Floats) -> Floats:
    """Bring what n * 8 paths have (n * 8, ...) into blocks (n, ..., 8)."""
    blocks = paths.reshape(len(paths) // WIDTH, WIDTH, *paths.shape[1:])
    return np.ascontiguousarray(np.moveaxis(blocks, 1, -1))


def _codes(steps: Steps) -> Floats:
    """Codes (n, most) of interactions, see `StepLanes.code`."""
    number = steps.slab + 1.0
    code = np.where(steps.kind == REFLECTION, number, 0.0)
    code = np.where(steps.kind == TRANSMISSION, -number, code)
    return np.where(steps.kind == DIFFRACTION, DIFFRACTED, code)


def _filled(order: Ints) -> Ints:
    """Fill a list up to a multiple of eight with -1."""
    return np.concatenate([order, np.full(-len(order) % WIDTH, -1, dtype=np.int64)])


def _last_real(path: Ints) -> Ints:
    """Index (n,) of the last path at or before each place that is none of those that fill up."""
    return np.maximum.accumulate(np.where(path >= 0, np.arange(len(path)), 0))


def gains_of(tables: Sequence[FieldTables], steps: Steps) -> tuple[Complexes, Complexes | None]:
    """Compute gains, both antennas included, from steps.

    Returns
    -------
    gain
        (n,) those of all tables together: the powers are added, and the phase is that of the
        strongest gain.
    pair_gains
        (n, k) those of each of k tables; None of one.
    """
    lanes, path = step_lanes(steps)
    is_real = path >= 0
    gains = np.zeros((len(tables), len(steps.kind)), dtype=np.complex128)
    for of_one, found in zip(tables, gains, strict=True):
        real, imag = np.zeros(path.shape), np.zeros(path.shape)
        write_gains(of_one, lanes, np.empty((0, 4, WIDTH)), real, imag)
        found[path[is_real]] = (real + 1j * imag)[is_real]
    return with_all_pairs(gains.T)


def with_all_pairs(pairs: Complexes) -> tuple[Complexes, Complexes | None]:
    """Return the gains of all pairs of polarisations (n, k) together, and the pairs if k > 1.

    The powers are added, and the phase is that of the strongest gain.
    """
    if pairs.shape[1] == 1:
        return pairs[:, 0], None
    size = np.abs(pairs)
    strongest = np.take_along_axis(pairs, size.argmax(axis=1)[:, None], axis=1)[:, 0]
    together = np.sqrt((size**2).sum(axis=1)) * np.exp(1j * np.angle(strongest))
    return together, np.ascontiguousarray(pairs)
