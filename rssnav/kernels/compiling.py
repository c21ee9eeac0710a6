"""How the loops are compiled."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import numba

from raytrace.kernels.cache import keep_compiled

Function = TypeVar("Function", bound=Callable[..., Any])

_SOURCES = Path(__file__).parent


def jit(*, inline: bool = False, allocates: bool = False) -> Callable[[Function], Function]:
    """Compile a loop or a part of one: cached, without the interpreter lock.

    Parameters
    ----------
    inline
        Whether it is always inlined, as the small parts of inner loops are.
    allocates
        Whether it creates arrays, which few loops here do, unlike the tracer's. Otherwise it does
        without reference counting (see `raytrace.kernels.compiling.jit`).
    """

    def compiled(function: Function) -> Function:
        dispatcher: Any = numba.njit(  # pyright: ignore[reportCallIssue]
            nogil=True,
            inline="always" if inline else "never",
            _nrt=allocates,  # pyright: ignore[reportArgumentType]
        )(function)
        keep_compiled(dispatcher, _SOURCES)
        return dispatcher

    return compiled
