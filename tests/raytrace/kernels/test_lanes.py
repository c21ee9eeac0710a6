"""Vectors of eight: what is compiled does what the functions of `lanes` say in NumPy."""

from collections.abc import Callable

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from raytrace.kernels import lanes
from raytrace.kernels.compiling import jit
from raytrace.kernels.lanes import (
    WIDTH,
    Floats,
    absolute,
    all_false,
    all_of,
    any_of,
    complex_of,
    copysign,
    elements_of,
    floor,
    imag_of,
    lane,
    lanes_of,
    load,
    matrix_of,
    maximum,
    minimum,
    real_of,
    row_of,
    sqrt,
    squared_size,
    store,
    where,
    where_complex,
)

Kernel = Callable[[Floats, Floats, Floats], None]


@jit()
def arithmetic(a: Floats, b: Floats, out: Floats) -> None:
    x, y = load(a), load(b)
    store(out[0], x + y * 2.0 - 3.0 / (x + 5.0))
    store(out[1], -x * y + (1.0 - y) / 2.0)
    store(out[2], sqrt(absolute(x)) + floor(y) + lanes_of(0.25))
    store(out[3], minimum(x, y) + maximum(x, 0.5) * copysign(lanes_of(3.0), y))
    x += y
    x *= 2.0
    store(out[4], x)


@jit()
def choices(a: Floats, b: Floats, out: Floats) -> None:
    x, y = load(a), load(b)
    store(out[0], where((x < y) & (y > 0.0), x, -1.0))
    store(out[1], where((x >= y) | ~(y <= 0.5), lanes_of(2.0), y))
    store(out[2], where((x == y) | all_false(), lanes_of(1.0), 0.0))
    store(out[3], where(x != x, lanes_of(1.0), 0.0))
    out[4, 0] = 1.0 if any_of(x < y) else 0.0
    out[4, 1] = 1.0 if all_of(x < y) else 0.0
    out[4, 2] = 1.0 if any_of(all_false()) else 0.0
    out[4, 3] = 1.0 if all_of(x == x) else 0.0
    for k in range(WIDTH - 4):
        out[4, 4 + k] = lane(x, k)


@jit()
def complex_numbers(a: Floats, b: Floats, out: Floats) -> None:
    x, y = load(a), load(b)
    u, v = complex_of(x, y), complex_of(y, 2.0)
    w = u * v - v * 3.0 + x * u + complex(0.5, -1.0) * v
    w = where_complex(x > y, w + 1j, -w * y)
    store(out[0], real_of(w))
    store(out[1], imag_of(w))


@jit()
def matrices(a: Floats, b: Floats, out: Floats) -> None:
    x, y = load(a), load(b)
    row = row_of(complex_of(x, y), complex_of(y, 1.0)) * complex_of(y, x) - row_of(
        complex_of(x, x), complex_of(y, y)
    )
    m = matrix_of(row * 0.5, -(x * row)) * complex(0.5, -2.0)
    m = where_complex(x > y, m + m * y, complex_of(lanes_of(1.0), 2.0))
    for k, element in enumerate(elements_of(m)):
        store(out[k], real_of(element) + 3.0 * imag_of(element))
    store(out[4], squared_size(m) + squared_size(complex_of(x, y)))


@pytest.mark.parametrize("kernel", [arithmetic, choices, complex_numbers, matrices])
def test_compiled_operations_are_those_of_numpy(kernel: Kernel) -> None:
    rng = np.random.default_rng(7)
    for _ in range(20):
        a, b = rng.normal(size=(2, WIDTH)).round(1) * 2.0
        compiled, in_python = np.zeros((5, WIDTH)), np.zeros((5, WIDTH))
        kernel(a, b, compiled)
        kernel.py_func(a, b, in_python)  # pyright: ignore[reportFunctionMemberAccess]
        assert_allclose(compiled, in_python, rtol=1e-15, atol=1e-15)
        assert np.any(in_python)


def test_a_choice_between_infinite_numbers_and_none_is_exact() -> None:
    a = np.array([np.inf, -np.inf, np.nan, 0.0, -0.0, 1.0, 2.0, 3.0])
    b = np.array([1.0, 1.0, 1.0, np.nan, 0.0, np.inf, 2.0, -3.0])
    compiled, in_python = np.zeros((5, WIDTH)), np.zeros((5, WIDTH))
    choices(a, b, compiled)
    choices.py_func(a, b, in_python)
    assert_array_equal(compiled[:4], in_python[:4])


GATHERS = {
    "gather2": (2, 2),
    "gather_pairs1": (1, 2),
    "gather_pairs2": (2, 4),
    "gather_pairs4": (4, 8),
}


@pytest.mark.parametrize("name", GATHERS)
def test_gathers_take_the_rows_that_are_asked_for(name: str) -> None:
    columns, taken = GATHERS[name]
    gather = getattr(lanes, name)

    @jit()
    def gathered(table: Floats, rows: Floats, out: Floats) -> None:
        for k, column in enumerate(gather(table, load(rows))):
            store(out[k], column)

    table = np.random.default_rng(3).normal(size=(50, columns))
    rows = np.array([0.0, 48.0, 7.9, 7.0, 1.0, 30.0, 31.0, 2.0])
    out = np.zeros((taken, WIDTH))
    gathered(table[:, 0].copy() if columns == 1 else table, rows, out)
    flat = table.ravel()
    expected = [flat[columns * int(row) : columns * int(row) + taken] for row in rows]
    assert_array_equal(out.T, expected)
    assert_array_equal(np.array(gather(table, rows)).T, expected)


def test_minimum_takes_the_second_where_one_is_no_number() -> None:
    """What keeps look-ups within their tables, whatever an angle has become."""

    @jit()
    def clamped(a: Floats, out: Floats) -> None:
        store(out, maximum(minimum(load(a), 5.0), 0.0))

    out = np.zeros(WIDTH)
    clamped(np.array([np.nan, np.inf, -np.inf, 2.0, 7.0, -1.0, 5.0, 0.0]), out)
    assert_array_equal(out, [5.0, 5.0, 0.0, 2.0, 5.0, 0.0, 5.0, 0.0])
