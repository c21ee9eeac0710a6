"""Where the machine code of compiled kernels is kept.

Numba's own cache notices a change of the file that holds a function, but not of a function that it
calls in another file. So the folder of a package's kernels carries a hash of all their sources.
Files are checked when they are read: a damaged one is compiled again. Nothing is written beside the
sources, and `numba.config` stays as it is for the user's own functions.
"""

import hashlib
import os
import pickle
import stat
import sys
import tempfile
import warnings
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from typing import Any

import numba
from numba.core.caching import CompileResultCacheImpl, FunctionCache, IndexDataCacheFile
from numba.core.serialize import dumps

_DIGEST_BYTES = 32


def sources_digest(sources: Path) -> str:
    """Hash of the Python files of a folder and of numba's version."""
    digest = hashlib.sha256(numba.__version__.encode())
    for source in sorted(sources.glob("*.py")):
        digest.update(source.name.encode() + b"\0" + source.read_bytes() + b"\0")
    return digest.hexdigest()[:16]


@cache
def cache_folder(sources: Path) -> Path | None:
    """Folder for the machine code of the kernels in a folder of sources.

    It lies in ``NUMBA_CACHE_DIR``, ``XDG_CACHE_HOME`` or ``~/.cache``, or in a folder for temporary
    files that only this user can read and write, whichever can be written first. None if none can.
    One that another user owns, besides the system's administrator, or that all may write is not
    used, since its files are code.
    """
    name = f"{sources.parent.name}-{sources_digest(sources)}"
    preferred = [root / name for root in _roots()]
    for folder in preferred:
        if _is_usable(folder):
            return folder
    private = Path(tempfile.gettempdir()) / f"rssnav-{_user()}"
    folder = private / name if _is_private(private) else None
    if preferred and folder is not None and _is_usable(folder):
        reason = "belongs to others" if _is_foreign(preferred[0]) else "cannot be written"
        _warn(f"{preferred[0]} {reason}: compiled kernels are kept in {folder}")
        return folder
    if folder is not None and _is_usable(folder):
        return folder
    _warn("no folder for compiled kernels can be written: they are compiled at every start")
    return None


def _roots() -> Iterator[Path]:
    chosen = os.environ.get("NUMBA_CACHE_DIR")
    if chosen:
        yield Path(chosen)
        return
    caches = os.environ.get("XDG_CACHE_HOME")
    if caches and os.path.isabs(caches):  # the specification has relative ones ignored
        yield Path(caches) / "rssnav" / "kernels"
        return
    try:
        yield Path.home() / ".cache" / "rssnav" / "kernels"
    except RuntimeError:  # neither HOME nor an entry in the user database
        return


def _user() -> str:
    return str(os.getuid()) if hasattr(os, "getuid") else os.environ.get("USERNAME", "user")


def _is_usable(folder: Path) -> bool:
    """Create a folder; whether it can be written, or holds kernels that can be read."""
    try:
        folder.parent.mkdir(parents=True, exist_ok=True)
        folder.mkdir(mode=0o755, exist_ok=True)
        if _is_foreign(folder):
            return False
        return os.access(folder, os.W_OK) or any(folder.iterdir())
    except OSError:
        return False


def _is_foreign(folder: Path) -> bool:
    """Whether others than this user and the administrator may put files into a folder."""
    try:
        found = folder.stat()
    except OSError:
        return False
    if not hasattr(os, "getuid"):
        return False
    return found.st_uid not in (os.getuid(), 0) or bool(found.st_mode & stat.S_IWOTH)


def _is_private(folder: Path) -> bool:
    """Create a folder that only this user may open; whether it is one: its files are code."""
    try:
        folder.mkdir(mode=0o700, exist_ok=True)
        found = folder.lstat()
    except OSError:
        return False
    if not hasattr(os, "getuid"):
        return stat.S_ISDIR(found.st_mode)
    mine = found.st_uid == os.getuid() and not stat.S_IMODE(found.st_mode) & 0o077
    return mine and stat.S_ISDIR(found.st_mode)


@cache
def _warn(message: str) -> None:
    warnings.warn(message, RuntimeWarning, stacklevel=2)


def _warn_of_damage(folder: str) -> None:
    _warn(f"{folder}: damaged kernels are compiled again")


def keep_compiled(dispatcher: Any, sources: Path) -> None:
    """Keep what a numba dispatcher compiles in the folder of its sources, if there is one."""
    folder = cache_folder(sources)
    if folder is not None:
        dispatcher._cache = KernelCache(dispatcher.py_func, folder)


class KernelCache(FunctionCache):
    """Numba's cache of one function, in a given folder, with checked files."""

    def __init__(self, py_func: Callable[..., Any], folder: Path) -> None:
        self._name = repr(py_func)
        self._py_func = py_func
        self._impl: Any = _Implementation(py_func, folder)
        self._cache_path = str(folder)
        self._cache_file = _CheckedFiles(str(folder), self._impl.filename_base, folder.name)
        self.enable()

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Load a compiled function; None, so that it is compiled, where it cannot be read."""
        try:
            return super().load_overload(sig, target_context)
        except Exception:
            _warn_of_damage(self._cache_path)
            return None

    def save_overload(self, sig: Any, data: Any) -> None:
        """Save a compiled function where there is room for it."""
        try:
            super().save_overload(sig, data)
        except OSError as error:
            _warn(f"{self._cache_path}: compiled kernels cannot be kept ({error.strerror})")


class _Implementation(CompileResultCacheImpl):
    """How a compiled function is written; its place is given instead of searched for."""

    def __init__(self, py_func: Callable[..., Any], folder: Path) -> None:
        self._lineno = py_func.__code__.co_firstlineno
        self._locator: Any = _Locator(py_func, folder)
        module = py_func.__module__.rpartition(".")[2]
        self._filename_base = self.get_filename_base(
            f"{module}.{py_func.__qualname__}", getattr(sys, "abiflags", "")
        )


class _Locator:
    """Where the files of a function are, as numba asks for it."""

    def __init__(self, py_func: Callable[..., Any], folder: Path) -> None:
        self._py_file = py_func.__code__.co_filename
        self._lineno = py_func.__code__.co_firstlineno
        self._folder = folder

    def ensure_cache_path(self) -> None:
        self._folder.mkdir(parents=True, exist_ok=True)

    def get_cache_path(self) -> str:
        return str(self._folder)

    def get_source_stamp(self) -> str:
        return self._folder.name

    def get_disambiguator(self) -> str:
        return str(self._lineno)


class _CheckedFiles(IndexDataCacheFile):
    """Index and machine code of a function; each file begins with a hash of the rest."""

    def _load_index(self) -> dict[Any, str]:
        try:
            return self._read(self._index_path)
        except OSError:
            return {}
        except Exception:
            _warn_of_damage(self._cache_path)
            return {}

    def _save_index(self, overloads: dict[Any, str]) -> None:
        self._write(self._index_path, overloads)

    def _load_data(self, name: str) -> Any:
        return self._read(self._data_path(name))

    def _save_data(self, name: str, data: Any) -> None:
        self._write(self._data_path(name), data)

    def _read(self, path: str) -> Any:
        content = Path(path).read_bytes()
        digest, pickled = content[:_DIGEST_BYTES], content[_DIGEST_BYTES:]
        if hashlib.sha256(pickled).digest() != digest:
            raise ValueError(f"{Path(path).name} has another hash than when it was written")
        return pickle.loads(pickled)

    def _write(self, path: str, data: Any) -> None:
        pickled = dumps(data)
        with self._open_for_write(path) as file:
            file.write(hashlib.sha256(pickled).digest() + pickled)
