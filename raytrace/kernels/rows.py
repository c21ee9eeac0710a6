"""Rows of arrays: copies, and arrays that grow."""

from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from raytrace.kernels.compiling import jit

Rows = TypeVar("Rows", bound=NDArray[Any])


@jit()
def resized(rows: Rows, n: int) -> Rows:
    """Copy of the first rows of an array, with capacity for n; one kernel for all that grow."""
    more: Any = np.empty((n, rows.shape[1]), rows.dtype)
    for i in range(min(n, rows.shape[0])):
        for k in range(rows.shape[1]):
            more[i, k] = rows[i, k]
    return more


@jit()
def enlarged(rows: Rows) -> Rows:
    """Copy of an array with capacity for twice as many rows."""
    return resized(rows, 2 * len(rows))


@jit(inner=True)
def copy_row(rows: NDArray[Any], to: int, origin: int) -> None:
    """rows[to] = rows[origin], much faster to compile."""
    for k in range(rows.shape[1]):
        rows[to, k] = rows[origin, k]
