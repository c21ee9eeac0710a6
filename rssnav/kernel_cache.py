"""Where numba keeps the compiled kernels, and whether they are there."""

from pathlib import Path
from types import ModuleType
from typing import NamedTuple

from numba.core import config

import raytrace.kernels
import rssnav.kernels
from rssnav.kernels.compiling import cache_folder


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
    return _cache_of(raytrace.kernels, Path(getattr(config, "CACHE_DIR", "")))


def learning_cache() -> KernelCache:
    """State of the kernels of the learning loops."""
    return _cache_of(rssnav.kernels, cache_folder())


def _cache_of(package: ModuleType, folder: Path) -> KernelCache:
    """Look for a package's kernels in its cache folder."""
    modules = {source.stem for source in Path(package.__path__[0]).glob("*.py")}
    files = [f for f in folder.rglob("*.nb[ci]") if f.name.split(".")[0] in modules]
    indices = [file for file in files if file.suffix == ".nbi"]
    return KernelCache(folder, len(indices), sum(file.stat().st_size for file in files))
