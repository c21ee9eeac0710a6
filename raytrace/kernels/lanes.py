"""Eight numbers side by side: what the field kernels compute with.

A kernel that takes `Lanes` evaluates eight paths at once, in the vector registers of the processor.
In Python they are arrays of eight; the functions here define each operation in NumPy, and
`raytrace.kernels.vectors` compiles them, and the operators, to single vector instructions.
`tests/raytrace/kernels/test_lanes.py` compares the two.
"""

from typing import Any

import numpy as np

from raytrace.arrays import Bools, Complexes, Floats

WIDTH = 8
"""Number of lanes: a 512-bit register, or two of 256 bits."""

Lanes = Floats
Mask = Bools
ComplexLanes = Complexes
RowLanes = Complexes
MatrixLanes = Complexes
"""Eight rows of two complex numbers, and eight matrices of two rows (docs/theory.md, eq. 48): in
Python arrays (2, 8) and (4, 8). Operators with eight complex numbers, or real ones, apply to each
element."""

Number = Any
"""A float or `Lanes`, in kernels that are compiled for both."""


def lanes_of(x: float) -> Lanes:
    """Eight equal numbers."""
    return np.full(WIDTH, x)


def load(row: Floats) -> Lanes:
    """First eight numbers of a contiguous array."""
    return row[:WIDTH].copy()


def store(row: Floats, x: Lanes) -> None:
    """Write eight numbers to the beginning of a contiguous array."""
    row[:WIDTH] = x


def lane(x: Lanes, k: int) -> float:
    """Number k of the eight."""
    return x[k]


def sqrt(x: Lanes) -> Lanes:
    """Square roots."""
    return np.sqrt(x)


def floor(x: Lanes) -> Lanes:
    """Round down to integers."""
    return np.floor(x)


def absolute(x: Lanes) -> Lanes:
    """Absolute values."""
    return np.abs(x)


def minimum(a: Lanes, b: Lanes | float) -> Lanes:
    """Smaller number of each pair; the second where the first is NaN."""
    return np.where(a < b, a, b)


def maximum(a: Lanes, b: Lanes | float) -> Lanes:
    """Larger number of each pair; the second where the first is NaN."""
    return np.where(a > b, a, b)


def copysign(a: Lanes | float, b: Lanes) -> Lanes:
    """Magnitudes of the first with the signs of the second."""
    return np.copysign(a, b)


def where(chosen: Mask, a: Lanes | float, b: Lanes | float) -> Lanes:
    """Numbers of the first where chosen, of the second elsewhere."""
    return np.where(chosen, a, b)


def where_complex(chosen: Mask, a: ComplexLanes, b: ComplexLanes) -> ComplexLanes:
    """`where` for complex numbers."""
    return np.where(chosen, a, b)


def all_false() -> Mask:
    """Mask of eight false."""
    return np.zeros(WIDTH, np.bool_)


def any_of(chosen: Mask) -> bool:
    """Whether at least one is true."""
    return bool(chosen.any())


def all_of(chosen: Mask) -> bool:
    """Whether all eight are true."""
    return bool(chosen.all())


def complex_of(real: Lanes, imag: Lanes | float) -> ComplexLanes:
    """Complex numbers from their parts."""
    return np.asarray(real + 1j * np.asarray(imag), np.complex128)


def real_of(x: ComplexLanes) -> Lanes:
    """Real parts."""
    return x.real


def imag_of(x: ComplexLanes) -> Lanes:
    """Imaginary parts."""
    return x.imag


def row_of(one: ComplexLanes, other: ComplexLanes) -> RowLanes:
    """Rows of two complex numbers."""
    return np.stack([one, other])


def matrix_of(one: RowLanes, other: RowLanes) -> MatrixLanes:
    """Matrices of two rows."""
    return np.concatenate([one, other])


def elements_of(x: ComplexLanes | MatrixLanes) -> tuple[ComplexLanes, ...]:
    """Elements of matrices, row by row; complex numbers are their only element."""
    return tuple(np.atleast_2d(x))


def squared_size(x: ComplexLanes | MatrixLanes) -> Lanes:
    """Squared magnitudes, of matrices those of all elements together."""
    return (np.atleast_2d(x.real) ** 2 + np.atleast_2d(x.imag) ** 2).sum(axis=0)


def gather2(table: Floats, row: Lanes) -> tuple[Lanes, Lanes]:
    """Two numbers from each of eight rows of a table of two columns."""
    at = 2 * row.astype(np.int32)
    flat = table.reshape(-1)
    return flat[at], flat[at + 1]


def gather_pairs1(table: Floats, row: Lanes) -> tuple[Lanes, Lanes]:
    """The numbers at eight places of a table of one column, and the next ones."""
    at = row.astype(np.int32)
    flat = table.reshape(-1)
    return flat[at], flat[at + 1]


def gather_pairs2(table: Floats, row: Lanes) -> tuple[Lanes, Lanes, Lanes, Lanes]:
    """Two numbers from each of eight rows of a table of two columns, and from the next rows."""
    at = 2 * row.astype(np.int32)
    flat = table.reshape(-1)
    return flat[at], flat[at + 1], flat[at + 2], flat[at + 3]


def gather_pairs4(
    table: Floats, row: Lanes
) -> tuple[Lanes, Lanes, Lanes, Lanes, Lanes, Lanes, Lanes, Lanes]:
    """Four numbers from each of eight rows of a table of four columns, and from the next rows."""
    at = 4 * row.astype(np.int32)
    flat = table.reshape(-1)
    return (
        flat[at], flat[at + 1], flat[at + 2], flat[at + 3],
        flat[at + 4], flat[at + 5], flat[at + 6], flat[at + 7],
    )  # fmt: skip
