"""Guards of kernels: what is left of the memory, and errors where a guard has ended one."""

from typing import Any

import numpy as np

from raytrace.errors import MemoryLimitError, TraceStoppedError
from raytrace.kernels.guard import Guard


def check_whole(guard: Guard, is_whole: bool, what: str) -> None:
    """Raise an error where a kernel has ended before its work was done.

    Parameters
    ----------
    guard
        As the kernel had it.
    is_whole
        Whether the work was done.
    what
        What it makes, for the message.

    Raises
    ------
    TraceStoppedError
        Where the trace was stopped.
    MemoryLimitError
        Where there was not enough memory.
    """
    if guard.stop[0]:
        raise TraceStoppedError("the trace was stopped before its end")
    if not is_whole:
        raise MemoryLimitError(what, guard.max_bytes + 1, guard.max_bytes)


def taking(guard: Guard, needed_bytes: int, what: str) -> Guard:
    """Return a guard with less memory, as arrays are made that take the rest.

    Raises
    ------
    MemoryLimitError
        Where that much is not left.
    """
    if needed_bytes > guard.max_bytes:
        raise MemoryLimitError(what, needed_bytes, guard.max_bytes)
    return guard._replace(max_bytes=guard.max_bytes - needed_bytes)


def nbytes(arrays: Any, shared: Any = ()) -> int:
    """Size of the arrays in nested tuples, without those that are in other ones too."""
    known = {id(array) for array in _flat(shared)}
    return sum(array.nbytes for array in _flat(arrays) if id(array) not in known)


def _flat(arrays: Any) -> list[Any]:
    if isinstance(arrays, tuple):
        return [array for part in arrays for array in _flat(part)]
    return [arrays] if isinstance(arrays, np.ndarray) else []
