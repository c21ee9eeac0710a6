"""How the kernels are compiled, and where the machine code is kept.

Numba's cache notices a change of the file that holds a function, but not of a function that
it calls in another file. So the cache folder carries a hash of all kernel sources.
"""

import hashlib
import os
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import numba
from numba.core import config

from raytrace.kernels import vectors as vectors  # numba is to know them

Function = TypeVar("Function", bound=Callable[..., Any])

FAST = {"nsz", "arcp", "contract", "afn"}
"""Floating-point freedoms of the field kernels: none that assumes away infinities."""


def _use_own_cache() -> None:
    """Point numba at a cache folder of this version, unless the user has chosen one."""
    if os.environ.get("NUMBA_CACHE_DIR"):
        return
    digest = hashlib.sha256(numba.__version__.encode())
    for source in sorted(Path(__file__).parent.glob("*.py")):
        digest.update(source.read_bytes())
    root = Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache"))
    folder = root / "rssnav" / "kernels" / digest.hexdigest()[:16]
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:
        folder = Path(tempfile.gettempdir()) / f"rssnav-kernels-{digest.hexdigest()[:16]}"
    config.CACHE_DIR = str(folder)  # pyright: ignore[reportAttributeAccessIssue]


_use_own_cache()


def jit(
    *, fast: bool = False, allocates: bool = True, inner: bool = False, inline: bool = False
) -> Callable[[Function], Function]:
    """Compile a kernel: cached, without the interpreter lock, divisions as in C.

    Parameters
    ----------
    fast
        Allow `FAST` in place of strict IEEE arithmetic.
    allocates
        Whether it makes arrays. One that does not is spared the counting of references, which
        otherwise takes most of the time of a loop that passes arrays in tuples.
    inner
        Whether only kernels call it, which saves compiling a way in from Python. It must not
        make arrays.
    inline
        Whether it is moreover one of the small functions of inner loops, and always inlined.
    """
    inner = inner or inline
    return numba.njit(  # pyright: ignore[reportCallIssue]
        cache=True,
        nogil=True,
        error_model="numpy",
        fastmath=FAST if fast else False,
        forceinline=inline,
        no_cpython_wrapper=inner,
        no_cfunc_wrapper=True,
        _nrt=allocates and not inner,
    )
