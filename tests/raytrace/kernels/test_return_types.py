"""What kernels return to Python.

Numba builds a NamedTuple by calling Python code, which fails where a signal is pending: an
interrupted trace would crash. So kernels return tuples, and functions in Python build the
NamedTuples.
"""

import importlib
import pkgutil
from collections.abc import Iterator
from typing import Any

import pytest
from numba.core import types
from numba.core.registry import CPUDispatcher
from rooms import ROOMS, SOURCE

import raytrace
from raytrace import TraceConfig, Transmitter, trace_paths


def kernels() -> Iterator[tuple[str, Any]]:
    """Every compiled function of the tracer that can be called from Python."""
    for module in pkgutil.walk_packages(raytrace.__path__, "raytrace."):
        for name, value in vars(importlib.import_module(module.name)).items():
            is_own = isinstance(value, CPUDispatcher) and value.__module__ == module.name
            if is_own and not value.targetoptions["no_cpython_wrapper"]:
                yield f"{module.name}.{name}", value


def has_named_tuple(kind: types.Type) -> bool:
    if isinstance(kind, types.NamedTuple | types.NamedUniTuple):
        return True
    return isinstance(kind, types.BaseTuple) and any(map(has_named_tuple, kind))


@pytest.fixture(scope="module")
def compiled() -> dict[str, list[Any]]:
    """Return types of the kernels that a trace with every path class compiles."""
    room = ROOMS["door with lintel"]
    config = TraceConfig(1, 1, max_transmissions=1, min_power_dbm=-150.0)
    trace_paths(room.scene, Transmitter(SOURCE), room.random_points(3, seed=1), config)
    return {name: [s.return_type for s in k.nopython_signatures] for name, k in kernels()}


def test_no_kernel_returns_a_named_tuple_to_python(compiled: dict[str, list[Any]]) -> None:
    returned = {name: kinds for name, kinds in compiled.items() if kinds}
    assert len(returned) > 10
    wrong = [name for name, kinds in returned.items() if any(map(has_named_tuple, kinds))]
    assert not wrong


def test_a_named_tuple_is_recognised() -> None:
    array = types.float64[:]
    named = types.NamedUniTuple(array, 2, raytrace.kernels.sums.Sums)
    assert has_named_tuple(types.Tuple([types.int64, named]))
    assert not has_named_tuple(types.Tuple([types.int64, types.UniTuple(array, 2)]))
