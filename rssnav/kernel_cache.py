"""Where numba keeps the compiled kernels, and whether they are there."""

from pathlib import Path
from types import ModuleType
from typing import NamedTuple

import raytrace.kernels
import rssnav.kernels
from raytrace.kernels.cache import cache_folder


class CacheState(NamedTuple):
    """State of the compiled kernels of a package.

    Attributes
    ----------
    folder
        Where new ones are kept; None where no folder can be written.
    n_compiled
        Functions that are compiled.
    n_bytes
        What they take [bytes].
    """

    folder: Path | None
    n_compiled: int
    n_bytes: int


def tracer_cache() -> CacheState:
    """State of the tracer's kernels."""
    return _cache_of(raytrace.kernels)


def learning_cache() -> CacheState:
    """State of the kernels of the learning loops."""
    return _cache_of(rssnav.kernels)


def _cache_of(package: ModuleType) -> CacheState:
    folder = cache_folder(Path(package.__path__[0]))
    files = [] if folder is None else list(folder.glob("*.nb[ci]"))
    n_compiled = sum(file.suffix == ".nbi" for file in files)
    return CacheState(folder, n_compiled, sum(file.stat().st_size for file in files))
