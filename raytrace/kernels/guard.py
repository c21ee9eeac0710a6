"""What ends a kernel before its work is done: a stop flag, and a limit on memory."""

from typing import Any, NamedTuple

import numpy as np
from llvmlite import ir
from numba.core import types
from numba.extending import intrinsic

from raytrace.arrays import Bytes
from raytrace.kernels.compiling import jit


class Guard(NamedTuple):
    """What ends a kernel before its work is done.

    Attributes
    ----------
    stop
        (1,) kernels end where it is not 0; other threads may write it at any time.
    max_bytes
        Kernels end before the arrays that they enlarge take more than this.
    """

    stop: Bytes
    max_bytes: int


def no_guard() -> Guard:
    """Return a guard that never ends a kernel."""
    return Guard(np.zeros(1, np.uint8), 1 << 62)


@intrinsic
def _loaded_atomically(_typing_context: Any, flags: types.Array) -> Any:
    """Load the first byte of an array; the compiler must not move the load out of a loop."""

    def write(context: Any, builder: ir.IRBuilder, sig: Any, args: Any) -> Any:
        array = context.make_array(sig.args[0])(context, builder, value=args[0])
        return builder.load_atomic(array.data, "monotonic", 1)

    return types.uint8(flags), write


@jit(inline=True)
def is_stopped(guard: Guard) -> bool:
    """Whether a kernel must end."""
    return _loaded_atomically(guard.stop) != 0  # pyright: ignore[reportCallIssue]


@jit(inner=True)
def may_hold(guard: Guard, needed: int, capacity: int, row_bytes: int) -> bool:
    """Whether arrays may be enlarged, by factors of two, until they hold the needed rows."""
    while capacity < needed:
        if 3 * capacity * row_bytes > guard.max_bytes:  # the arrays and their larger copies
            return False
        capacity *= 2
    return True
