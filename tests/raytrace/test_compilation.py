"""What is compiled is counted and timed, wherever in a call it happens."""

import time

import numba
import numpy as np
import pytest

from raytrace.compilation import Compilation, watched_compilation
from raytrace.kernels.compiling import widen_integers


def fresh_pair():
    """A function that is not compiled, and calls another."""
    inner = numba.njit(lambda x: x + 1.0)
    return numba.njit(lambda x: inner(x) * 2.0)


def test_every_function_is_counted_and_timed() -> None:
    outer, reports = fresh_pair(), []
    started = time.perf_counter()
    with watched_compilation(reports.append) as compilation:
        assert outer(1.0) == 4.0
        took_s = time.perf_counter() - started
    assert compilation.n_compiled == 2
    assert reports == [0, 1, 2]
    assert 0.0 < compilation.seconds <= took_s


def test_what_is_compiled_already_counts_nothing() -> None:
    outer = fresh_pair()
    outer(1.0)
    with watched_compilation(pytest.fail) as compilation:
        outer(2.0)
    assert (compilation.n_compiled, compilation.seconds) == (0, 0.0)


def test_an_end_without_a_start_is_not_counted() -> None:
    compilation = Compilation()
    compilation.on_end(None)  # type: ignore[arg-type]
    assert (compilation.n_compiled, compilation.seconds) == (0, 0.0)


def test_a_kernel_is_compiled_once_for_all_whole_numbers() -> None:
    next_of = numba.njit(lambda values, i, step: values[i + step])  # not kept from an earlier run
    widen_integers(next_of)

    @numba.njit
    def some_of(values, numbers):
        constants = next_of(values, 0, 1) + next_of(values, len(values), -2)
        return constants + next_of(values, numbers[0], 0)

    assert some_of(np.array([1.0, 20.0, 300.0]), np.array([2], np.int32)) == 340.0
    assert len(next_of.signatures) == 1
