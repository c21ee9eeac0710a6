"""The writer, and the removal of what killed writers left."""

import errno
import os
import socket
from collections.abc import Generator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import BinaryIO
from uuid import uuid4

try:
    import fcntl
except ImportError:  # Windows: no locks, so nothing is known to be abandoned
    fcntl = None

_NO_SPACE = {errno.ENOSPC, errno.EDQUOT, errno.EFBIG}
_HOST = "".join(c if c.isalnum() else "_" for c in socket.gethostname())[:32] or "host"


@contextmanager
def atomic_write(path: str | Path) -> Generator[Path]:
    """Provide a temporary file that replaces `path` when the block ends without an exception.

    Parameters
    ----------
    path : str or Path
        File to write; a link is followed. Missing folders above it are created.

    Yields
    ------
    Path
        An empty file in the same folder to write to. It has the suffix of `path`, from which many
        writers choose their format.

    Raises
    ------
    OSError
        Where the file cannot be written, or is a device or a pipe; names `path`.
    """
    path = Path(os.path.realpath(path))
    with _named(path):
        path.parent.mkdir(parents=True, exist_ok=True)
        _remove_abandoned(path)
        if path.is_dir():
            raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(path))
        if path.exists() and not path.is_file():  # a renamed file would take a device's place
            raise FileExistsError(errno.EEXIST, "is not a regular file", str(path))
        with _temporary(path) as temporary:
            yield temporary
            _flush(temporary)
            os.replace(temporary, path)
            _flush_folder(path.parent)


def atomic_write_all(contents: Mapping[Path, bytes]) -> None:
    """Write several files; none of them is replaced unless all could be written.

    Parameters
    ----------
    contents : mapping of Path to bytes
    """
    with ExitStack() as stack:
        for path, content in contents.items():
            stack.enter_context(atomic_write(path)).write_bytes(content)


@contextmanager
def _named(path: Path) -> Generator[None]:
    """Name the file in the system's errors where they name none or the temporary one."""
    try:
        yield
    except OSError as error:
        unnamed = error.filename is None and error.errno in _NO_SPACE
        if error.errno is None or not (unnamed or _is_temporary(error.filename, path)):
            raise
        raise OSError(error.errno, os.strerror(error.errno), str(path)) from error


def _is_temporary(name: object, path: Path) -> bool:
    return isinstance(name, str) and Path(name).name.startswith(_prefix(path))


def _prefix(path: Path) -> str:
    """How the temporary files that this machine makes for a file begin."""
    return f".{path.stem}.{_HOST}."


def _remove_abandoned(path: Path) -> None:
    """Remove the temporary files of writers to `path` that this machine knows to be dead."""
    if fcntl is None:
        return
    for left in temporaries(path):
        with suppress(OSError), left.open("rb") as file:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            left.unlink()


def temporaries(path: Path) -> list[Path]:
    """Return the temporary files of all writers to a path, dead ones included."""
    folder, prefix, suffix = path.parent, _prefix(path), f".part{path.suffix}"
    names = os.listdir(folder)
    return [folder / name for name in names if name.startswith(prefix) and name.endswith(suffix)]


@contextmanager
def _temporary(path: Path) -> Generator[Path]:
    """Create an empty file beside `path`, locked while it is written; remove it if it is left."""
    temporary, file = _created(path)
    while not _lock(temporary, file):  # taken for abandoned before it was locked
        file.close()
        temporary, file = _created(path)
    try:
        yield temporary
    finally:
        with suppress(OSError):
            temporary.unlink()
        file.close()


def _created(path: Path) -> tuple[Path, BinaryIO]:
    temporary = path.with_name(f"{_prefix(path)}{uuid4().hex}.part{path.suffix}")
    return temporary, temporary.open("xb")


def _lock(temporary: Path, file: BinaryIO) -> bool:
    """Show other writers that this one is alive; False if one has removed the file before."""
    if fcntl is None:
        file.close()  # so that it can be renamed
        return True
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError:  # a file system without locks, where nothing is removed
        return True
    return temporary.exists()


def _flush(path: Path) -> None:
    with path.open("rb+") as file:
        os.fsync(file.fileno())


def _flush_folder(folder: Path) -> None:
    """Make a rename durable, where the system lets a folder be flushed."""
    with suppress(OSError):
        descriptor = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)
