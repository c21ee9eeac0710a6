"""Where numba keeps the compiled kernels, and whether they are there."""

from pathlib import Path
from types import ModuleType
from typing import NamedTuple

from numba.core import config

import raytrace.kernels
import rssnav.kernels


class KernelCache(NamedTuple):
    """State of the compiled kernels of a package.

    Attributes
    ----------
    folder
        Where new ones are kept.
    n_compiled
        Functions that are compiled.
    n_bytes
        What they take [bytes].
    """

    folder: Path
    n_compiled: int
    n_bytes: int


def tracer_cache() -> KernelCache:
    """State of the tracer's kernels."""
    return _cache_of(raytrace.kernels)


def learning_cache() -> KernelCache:
    """State of the kernels of the learning loops."""
    return _cache_of(rssnav.kernels)


def _cache_of(package: ModuleType) -> KernelCache:
    """Look for a package's kernels in numba's cache folder and beside the sources."""
    sources = Path(package.__path__[0])
    modules = {source.stem for source in sources.glob("*.py")}
    cache_dir = getattr(config, "CACHE_DIR", "")
    chosen = Path(cache_dir) if cache_dir else sources / "__pycache__"
    files = {
        file
        for folder in (chosen, sources / "__pycache__")
        for file in folder.rglob("*.nb[ci]")
        if file.name.split(".")[0] in modules
    }
    indices = [file for file in files if file.suffix == ".nbi"]
    return KernelCache(chosen, len(indices), sum(file.stat().st_size for file in files))
