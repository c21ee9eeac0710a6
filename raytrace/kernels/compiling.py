"""How the kernels are compiled."""

import inspect
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, TypeVar

import numba
from numba.core import types
from numba.extending import overload

from raytrace.kernels import vectors as vectors  # registers the types with numba
from raytrace.kernels.cache import keep_compiled

Function = TypeVar("Function", bound=Callable[..., Any])

FAST = {"nsz", "arcp", "contract", "afn"}
"""Floating-point freedoms of the field kernels: none that assumes away infinities."""

_SOURCES = Path(__file__).parent


def jit(
    *, fast: bool = False, allocates: bool = True, inner: bool = False, inline: bool = False
) -> Callable[[Function], Function]:
    """Compile a kernel: cached, without the interpreter lock, divisions as in C.

    Parameters
    ----------
    fast
        Allow `FAST` in place of strict IEEE arithmetic.
    allocates
        Whether it creates arrays. Otherwise it does without reference counting, which takes most
        of the time of a loop that passes arrays in tuples.
    inner
        Whether only kernels call it, so that no wrapper for Python is compiled. It must not create
        arrays.
    inline
        Whether it is an inner function that is always inlined.
    """
    inner = inner or inline

    def compiled(function: Function) -> Function:
        dispatcher: Any = numba.njit(  # pyright: ignore[reportCallIssue]
            nogil=True,
            error_model="numpy",
            fastmath=FAST if fast else False,
            forceinline=inline,
            no_cpython_wrapper=inner,
            no_cfunc_wrapper=True,
            _nrt=allocates and not inner,
        )(function)
        widen_integers(dispatcher)
        keep_compiled(dispatcher, _SOURCES)
        return dispatcher

    return compiled


def widen_integers(dispatcher: Any) -> None:
    """Compile a function once for all whole numbers that kernels call it with.

    By itself numba compiles it anew for 32-bit numbers and for each constant.
    """
    template_of = dispatcher.get_call_template

    def get_call_template(args: Sequence[types.Type], kws: Mapping[str, types.Type]) -> Any:
        return template_of(
            [_widened(kind) for kind in args], {name: _widened(kws[name]) for name in kws}
        )

    dispatcher.get_call_template = get_call_template


def _widened(kind: types.Type) -> types.Type:
    """Return the type that a kernel is compiled for in place of another."""
    kind = types.unliteral(kind)
    if isinstance(kind, types.Integer):
        return types.int64
    if isinstance(kind, types.Tuple | types.UniTuple):
        return types.Tuple([_widened(part) for part in kind.types])
    return kind


def chosen_by_type(field: str, absent: Function, present: Function) -> Callable[[Function], None]:
    """Let kernels call one of two functions for another, by the type of its first argument.

    Numba types both branches of an ``if``; this compiles only what is called.

    Parameters
    ----------
    field
        Of the first argument, a NamedTuple.
    absent, present
        What is called where the field is None, and where it is not; with the same parameters as the
        function. They are inlined.
    """
    options: Any = {"nogil": True, "error_model": "numpy", "forceinline": True, "_nrt": False}

    def register(function: Function) -> None:
        def choose(*arguments: Any) -> Callable[..., Any]:
            fields: Any = arguments[0]
            is_absent = fields.types[fields.fields.index(field)] == types.none
            return absent if is_absent else present

        choose.__signature__ = inspect.signature(function)  # pyright: ignore[reportFunctionMemberAccess]
        overload(function, jit_options=options, strict=False)(choose)

    return register
