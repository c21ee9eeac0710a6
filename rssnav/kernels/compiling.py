"""How the loops are compiled."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import numba

from raytrace.kernels.cache import keep_compiled

Function = TypeVar("Function", bound=Callable[..., Any])

_SOURCES = Path(__file__).parent


def jit(
    *, inline: bool = False, fused: bool = False, allocates: bool = False
) -> Callable[[Function], Function]:
    """Compile a loop or a part of one: cached, without the interpreter lock.

    Parameters
    ----------
    inline
        Whether it is always inlined, as the small parts of inner loops are.
    fused
        Whether LLVM inlines it, not numba: it is typed once by itself, so large functions compile
        faster, and where a branch is left out its types do not matter.
    allocates
        Whether it creates arrays, which few loops here do, unlike the tracer's. Otherwise it does
        without reference counting (see `raytrace.kernels.compiling.jit`).
    """

    def compiled(function: Function) -> Function:
        dispatcher: Any = numba.njit(  # pyright: ignore[reportCallIssue]
            nogil=True,
            inline="always" if inline else "never",
            forceinline=fused,
            _nrt=allocates,  # pyright: ignore[reportArgumentType]
        )(function)
        keep_compiled(dispatcher, _SOURCES)
        return dispatcher

    return compiled
