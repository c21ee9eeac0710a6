"""How the loops are compiled, and where their machine code is kept.

Numba's cache notices a change of the file that holds a function, but not of a function that it
calls in another file. So the loops are kept in a folder whose name holds a hash of all of their
sources: a change anywhere compiles them anew.
"""

from __future__ import annotations

import hashlib
import os
import tempfile
from collections.abc import Callable, Generator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Any, Literal, TypeVar

import numba
from numba.core import config

Function = TypeVar("Function", bound=Callable[..., Any])


def sources_digest(folder: Path) -> str:
    """Hash of the Python files of a folder and of numba's version."""
    digest = hashlib.sha256(numba.__version__.encode())
    for source in sorted(folder.glob("*.py")):
        digest.update(source.name.encode() + b"\0" + source.read_bytes() + b"\0")
    return digest.hexdigest()[:16]


@cache
def cache_folder() -> Path:
    """Folder for the machine code of these sources; the user may choose it for all of numba."""
    chosen = os.environ.get("NUMBA_CACHE_DIR")
    if chosen:
        return Path(chosen)
    name = f"learning-{sources_digest(Path(__file__).parent)}"
    root = Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache"))
    folder = root / "rssnav" / "kernels" / name
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:
        folder = Path(tempfile.gettempdir()) / f"rssnav-{name}"
    return folder


@contextmanager
def _own_cache() -> Generator[None, None, None]:
    """Point numba at that folder, and nobody else's functions: it looks while decorating."""
    settings: Any = config  # filled in when numba is imported
    before = settings.CACHE_DIR
    settings.CACHE_DIR = str(cache_folder())
    try:
        yield
    finally:
        settings.CACHE_DIR = before


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
        compile_it: Any = numba.njit(  # pyright: ignore[reportCallIssue]
            cache=True,
            nogil=True,
            inline=inline,
            _nrt=allocates,  # pyright: ignore[reportArgumentType]
        )
        with _own_cache():
            return compile_it(function)

    return compiled
