"""How the loops are compiled."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, Literal, TypeVar

import numba

from raytrace.kernels.cache import keep_compiled

Function = TypeVar("Function", bound=Callable[..., Any])

_SOURCES = Path(__file__).parent


def jit(
    *, inline: Literal["never", "always"] = "never", allocates: bool = False
) -> Callable[[Function], Function]:
    """Compile a loop or a part of one: cached, without the interpreter lock.

    Parameters
    ----------
    inline
        "always" for the small parts of inner loops.
    allocates
        Whether it makes arrays. One that does not is spared the counting of references, which
        otherwise takes most of the time of a loop that hands arrays in tuples to its parts.
    """

    def compiled(function: Function) -> Function:
        dispatcher: Any = numba.njit(  # pyright: ignore[reportCallIssue]
            nogil=True,
            inline=inline,
            _nrt=allocates,  # pyright: ignore[reportArgumentType]
        )(function)
        keep_compiled(dispatcher, _SOURCES)
        return dispatcher

    return compiled
