"""HDF5 files built in memory, and read without trust in what they say.

A stranger's file, or one that a disk has damaged, can claim anything: shapes of terabytes, links to
other files, strings where numbers belong. `Checked` looks at kind, shape and size of everything
before it allocates, and at the numbers before it returns them. Sizes that must agree have a name:
the first array to use it sets it, and every later one must have the same.

A file ends with a hash of its content, so that damage is found before HDF5 sees it. A file that
other programs have changed has lost this hash, and is read all the same.
"""

import hashlib
import io
import re
import struct
from collections.abc import Callable, Generator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from uuid import uuid4

import h5py
import numpy as np
from numpy.typing import NDArray

Shape = tuple[int | str, ...]
"""A shape; a name stands for a size that all arrays with this name share."""

MAX_FILE_BYTES = 1 << 32
"""Largest file that is read."""
MAX_VALUES = 1 << 27
"""Most values of one dataset."""
MAX_TEXT_BYTES = 1 << 26
"""Most bytes of one attribute."""

_EXPANSION = 1100
"""No stored byte gives more than so many: deflate reaches 1032."""
_SIGNATURE = b"\x89HDF\r\n\x1a\n"
_MARK = b"rssnav sha256 "
_HASH_BYTES = 32
_KINDS = {"f": "floating-point numbers", "i": "integers", "u": "integers", "b": "booleans"}


class Hdf5ContentError(ValueError):
    """A file does not hold what it should; the message names the dataset or attribute."""


def hdf5_bytes(fill: Callable[[h5py.File], None]) -> bytes:
    """Build an HDF5 file in memory.

    The HDF5 library may crash the process when a disk fills up while it writes to a file. Bytes
    that are written afterwards fail with an ordinary `OSError`. The file has checksums on its
    metadata (format of HDF5 1.10), and a hash of its content behind its end.

    Parameters
    ----------
    fill
        Called with the empty file.
    """
    with h5py.File(
        uuid4().hex, "w", driver="core", backing_store=False, libver=("v110", "v110")
    ) as file:
        fill(file)
        file.flush()
        content = file.id.get_file_image()
    return content + _MARK + hashlib.sha256(content).digest()


def write_array(
    group: h5py.Group, name: str, array: NDArray[Any], units: str, long_name: str
) -> h5py.Dataset:
    """Write a dataset with its units, compressed and with checksums where it has any values."""
    if array.size and array.ndim:
        options: dict[str, Any] = {"compression": "gzip", "fletcher32": True}
    else:
        options = {}
    dataset = group.create_dataset(name, data=array, **options)
    dataset.attrs.update(units=units, long_name=long_name)
    return dataset


@contextmanager
def open_checked(path: Path) -> Generator["Checked"]:
    """Open an HDF5 file that is not trusted.

    Parameters
    ----------
    path
        The file.

    Raises
    ------
    Hdf5ContentError
        Where it cannot be read, or what is made of it within the block raises an error for it.
    OSError
        Where the system cannot read it.
    """
    size = path.stat().st_size
    if size > MAX_FILE_BYTES:
        raise Hdf5ContentError(f"{size} bytes; at most {MAX_FILE_BYTES} are read")
    content = path.read_bytes()
    _check_content(content)
    try:
        with h5py.File(io.BytesIO(content), "r") as file:
            yield Checked(file)
    except Hdf5ContentError:
        raise
    except (OSError, RuntimeError, KeyError, TypeError, ValueError, OverflowError) as error:
        raise Hdf5ContentError(str(error)) from error


def _check_content(content: bytes) -> None:
    """Find damage before the HDF5 library sees it, which can loop for ever in damaged heaps."""
    body, mark, digest = content.rpartition(_MARK)
    if mark and len(digest) == _HASH_BYTES:
        if hashlib.sha256(body).digest() != digest:
            raise Hdf5ContentError("the content has changed since it was written")
    elif _end_of_hdf5(content) not in (None, len(content)):
        raise Hdf5ContentError("the end of the file is damaged")
    for found in re.finditer(rb"GCOL\x01", content):
        if not _is_sound_heap(content, found.start()):
            raise Hdf5ContentError("a heap of texts is damaged")


def _end_of_hdf5(content: bytes) -> int | None:
    """End of the file by its superblock of version 2 or 3 (HDF5 specification, II.A)."""
    known = content.startswith(_SIGNATURE) and content[8:9] in (b"\x02", b"\x03")
    return struct.unpack_from("<Q", content, 28)[0] if known and len(content) >= 36 else None


def _is_sound_heap(content: bytes, at: int) -> bool:
    """Whether the objects of a global heap fill it (HDF5 File Format Specification, III.E)."""
    header = content[at : at + 16]
    if len(header) < 16:
        return False
    size = struct.unpack_from("<Q", header, 8)[0]
    if not 16 < size <= len(content) - at:
        return False
    end, at = at + size, at + 16
    while at + 16 <= end:
        index, length = struct.unpack_from("<H6xQ", content, at)
        if index == 0:
            return length == end - at
        if length == 0 or length > end - at - 16:
            return False
        at += 16 + (length + 7) // 8 * 8
    return True


@dataclass(frozen=True)
class Checked:
    """A group of an HDF5 file that is not trusted.

    Attributes
    ----------
    group
        The group.
    sizes
        Sizes by name, as far as they are known.
    """

    group: h5py.Group
    sizes: dict[str, int] = field(default_factory=dict[str, int])

    def __contains__(self, name: str) -> bool:
        return name in self.group

    def within(self, name: str) -> "Checked":
        """Return a group within this one."""
        found = self._member(name, h5py.Group, "group")
        return Checked(found, self.sizes)

    def array(
        self, name: str, kinds: str, shape: Shape, *, low: float = -np.inf, high: float = np.inf
    ) -> NDArray[Any]:
        """Read a dataset.

        Parameters
        ----------
        name
            Its name.
        kinds
            Which of NumPy's ``dtype.kind`` it may have, such as ``"iu"``.
        shape
            Its shape; a name in it is a size shared with other arrays.
        low, high
            Bounds of its values; NaN is never within them.

        Raises
        ------
        Hdf5ContentError
            Where it is missing or is something else.
        """
        dataset = self._member(name, h5py.Dataset, "dataset")
        self._check_storage(name, dataset)
        if dataset.dtype.kind not in kinds or dataset.dtype.names is not None:
            wanted = _KINDS.get(kinds[0], "text")
            raise Hdf5ContentError(f"dataset {name!r}: has type {dataset.dtype}, expected {wanted}")
        self._check_shape(name, dataset.shape, shape)
        array = np.asarray(dataset[()])
        array = array.astype(array.dtype.newbyteorder("="), copy=False)
        if array.size and array.dtype.kind in "fiu" and not _within(array, low, high):
            raise Hdf5ContentError(
                f"dataset {name!r}: has values from {array.min()} to {array.max()}, expected "
                f"{low:g} to {high:g} without NaN"
            )
        return array

    def attributes(self) -> dict[str, Any]:
        """Read all attributes as plain Python values; arrays of numbers stay arrays.

        Raises
        ------
        Hdf5ContentError
            For one that is neither numbers nor text, or too large.
        """
        return {str(name): self._attribute(str(name)) for name in self.group.attrs}

    def _attribute(self, name: str) -> Any:
        found = self.group.attrs.get_id(name)
        is_text = h5py.check_string_dtype(found.dtype) is not None
        n_bytes = found.dtype.itemsize * np.prod(found.shape or (1,), dtype=np.float64)
        if (
            found.shape is None
            or n_bytes > MAX_TEXT_BYTES
            or not (is_text or found.dtype.kind in "fiub")
        ):
            raise Hdf5ContentError(f"attribute {name!r}: expected a number, numbers or text")
        value = self.group.attrs[name]
        if isinstance(value, bytes):
            value = value.decode("utf-8", "replace")
        if isinstance(value, np.ndarray) and value.dtype.kind == "O":
            raise Hdf5ContentError(f"attribute {name!r}: expected one text, found {value.shape}")
        return value.item() if isinstance(value, np.generic) else value

    def _member(self, name: str, kind: type[Any], word: str) -> Any:
        """Return what has a name, if it is of a kind and within the file."""
        try:
            link = self.group.get(name, getlink=True)
        except (KeyError, RuntimeError) as error:
            raise Hdf5ContentError(f"{word} {name!r} cannot be read") from error
        if link is None:
            raise Hdf5ContentError(f"{word} {name!r} is missing")
        if not isinstance(link, h5py.HardLink):
            raise Hdf5ContentError(f"{word} {name!r}: a link to another place is not followed")
        found = self.group[name]
        if not isinstance(found, kind):
            raise Hdf5ContentError(f"{name!r}: expected a {word}")
        return found

    def _check_storage(self, name: str, dataset: h5py.Dataset) -> None:
        """Refuse a dataset kept elsewhere, or one that claims more than the file can hold."""
        if dataset.is_virtual or dataset.external is not None:
            raise Hdf5ContentError(f"dataset {name!r}: data in other files is not read")
        if dataset.shape is None:
            raise Hdf5ContentError(f"dataset {name!r}: has no values")
        item = dataset.dtype.itemsize
        claimed = [
            np.prod(shape, dtype=np.float64) for shape in (dataset.shape, dataset.chunks or ())
        ]
        stored = dataset.id.get_storage_size()
        if max(claimed) > MAX_VALUES or claimed[0] * item > _EXPANSION * stored:
            raise Hdf5ContentError(
                f"dataset {name!r}: claims shape {dataset.shape}, {stored} bytes are stored"
            )

    def _check_shape(self, name: str, found: tuple[int, ...], wanted: Shape) -> None:
        if len(found) == len(wanted):
            for size, want in zip(found, wanted, strict=True):
                if isinstance(want, str):
                    self.sizes.setdefault(want, size)
            if found == self._sizes_of(wanted):
                return
        raise Hdf5ContentError(
            f"dataset {name!r}: has shape {found}, expected {_shown(wanted, self.sizes)}"
        )

    def _sizes_of(self, shape: Shape) -> tuple[int, ...]:
        return tuple(self.sizes[size] if isinstance(size, str) else size for size in shape)


def _within(array: NDArray[Any], low: float, high: float) -> bool:
    return bool(((array >= low) & (array <= high)).all())


def _shown(shape: Shape, sizes: Mapping[str, int]) -> str:
    parts = [str(sizes.get(size, size) if isinstance(size, str) else size) for size in shape]
    return f"({', '.join(parts)})"
