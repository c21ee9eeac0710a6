"""HDF5 files read without trust in what they say.

A stranger's file, or one that a disk has damaged, can claim anything: shapes of terabytes, links to
other files, strings where numbers belong, chunks that decompress without end. `Checked` looks at
kind, shape and size of everything before it allocates, and at the numbers before it returns them.
Sizes that must agree have a name: the first array to use it sets it, and every later one must have
the same.

A file with a hash behind its content is refused where they differ, before HDF5 sees it. A file that
other programs have changed has lost this hash, and is read all the same.
"""

import io
import sys
from collections.abc import Generator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from h5py import h5l  # pyright: ignore[reportAttributeAccessIssue]
from numpy.typing import NDArray

from raytrace.results.hdf5_content import Hdf5ContentError, check_storage, sound_content

Shape = tuple[int | str, ...]
"""A shape; a name stands for a size that all arrays with this name share."""

MAX_TEXT_BYTES = 1 << 26
"""Most bytes of one attribute."""
MAX_TEXTS = 1000
"""Most texts of one dataset."""
LARGEST = sys.float_info.max
"""Bound of finite numbers."""
LARGEST_INTEGER = 2**64 - 1

_KINDS = {
    "f": ("f", "floating-point numbers"),
    "i": ("iu", "integers"),
    "b": ("b", "booleans"),
    "c": ("c", "complex numbers"),
}
_READ_ERRORS = (OSError, RuntimeError, LookupError, TypeError, ValueError, OverflowError)
"""What h5py raises for damaged content."""


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
    content = sound_content(path)
    try:
        with h5py.File(io.BytesIO(content), "r") as file:
            yield Checked(file)
    except Hdf5ContentError:
        raise
    except (*_READ_ERRORS, MemoryError) as error:
        raise Hdf5ContentError(str(error) or type(error).__name__) from error


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

    def _path(self, name: str) -> str:
        """Name of a member or an attribute from the file's root."""
        return f"{self.group.name}/{name}".lstrip("/")

    def _error(self, word: str, name: str, problem: str) -> Hdf5ContentError:
        return Hdf5ContentError(f"{word} {self._path(name)!r}: {problem}")

    def __contains__(self, name: str) -> bool:
        return self.group.id.links.exists(name.encode())

    @property
    def names(self) -> list[str]:
        """Names of the datasets and groups within this group."""
        return [str(name) for name in self.group]

    def is_group(self, name: str) -> bool:
        """Return whether a name is that of a group."""
        return isinstance(self._member(name, h5py.HLObject, "member"), h5py.Group)

    def within(self, name: str) -> "Checked":
        """Return a group within this one."""
        return Checked(self._member(name, h5py.Group, "group"), self.sizes)

    def array(
        self,
        name: str,
        dtype: type[np.generic] | str,
        shape: Shape,
        *,
        low: float = -np.inf,
        high: float = np.inf,
    ) -> NDArray[Any]:
        """Read a dataset.

        Parameters
        ----------
        name
            Its name.
        dtype
            What is returned; the file may hold another type of the same kind.
        shape
            Its shape; a name in it is a size shared with other arrays.
        low, high
            Bounds of its values; NaN is never within them. Complex numbers must be finite.

        Raises
        ------
        Hdf5ContentError
            Where it is missing or is something else.
        """
        dataset = self._member(name, h5py.Dataset, "dataset")
        wanted = np.dtype(dtype)
        kinds, words = _KINDS[wanted.kind]
        if dataset.dtype.kind not in kinds:
            raise self._error("dataset", name, f"has type {dataset.dtype}, expected {words}")
        check_storage(self._path(name), dataset)
        self._check_shape(name, dataset.shape, shape)
        found = self._read(name, dataset)
        with np.errstate(all="ignore"):
            array = found.astype(wanted)
        if not _within(array, low, high) or not _is_exact(found, array):
            raise self._error(
                "dataset",
                name,
                f"has values from {found.min()} to {found.max()}, expected "
                f"{words}{_bounds(low, high)}",
            )
        return array

    def values(self, name: str) -> NDArray[Any]:
        """Read a dataset of numbers or booleans of any shape, NaN included."""
        dataset = self._member(name, h5py.Dataset, "dataset")
        if dataset.dtype.kind not in "biufc":
            raise self._error("dataset", name, f"has type {dataset.dtype}, expected numbers")
        check_storage(self._path(name), dataset)
        return self._read(name, dataset)

    def _read(self, name: str, dataset: h5py.Dataset) -> NDArray[Any]:
        try:
            found = np.asarray(dataset[()])
        except _READ_ERRORS as error:
            raise self._error("dataset", name, f"cannot be read ({error})") from error
        return found.astype(found.dtype.newbyteorder("="), copy=False)

    def holds_texts(self, name: str) -> bool:
        """Return whether a name is that of a dataset of texts."""
        dataset = self._member(name, h5py.Dataset, "dataset")
        return h5py.check_string_dtype(dataset.dtype) is not None

    def attributes_of(self, name: str) -> "Checked":
        """Return a dataset within this group, for its attributes."""
        return Checked(self._member(name, h5py.Dataset, "dataset"))

    def texts(self, name: str) -> tuple[str, ...]:
        """Read a dataset of texts, shape (n,)."""
        dataset = self._member(name, h5py.Dataset, "dataset")
        check_storage(self._path(name), dataset)
        if (
            h5py.check_string_dtype(dataset.dtype) is None
            or dataset.ndim != 1
            or dataset.size > MAX_TEXTS
        ):
            raise self._error(
                "dataset",
                name,
                f"has type {dataset.dtype} and shape {dataset.shape}, expected "
                f"at most {MAX_TEXTS} texts",
            )
        try:
            texts = [
                _decoded(dataset[k], f"dataset {self._path(name)!r}") for k in range(dataset.size)
            ]
        except (OSError, RuntimeError) as error:
            raise self._error("dataset", name, f"cannot be read ({error})") from error
        if sum(map(len, texts)) > MAX_TEXT_BYTES:
            raise self._error("dataset", name, f"more than {MAX_TEXT_BYTES} characters")
        return tuple(texts)

    def number(self, name: str, *, low: float = -LARGEST, high: float = LARGEST) -> float:
        """Read an attribute that is a number within bounds."""
        return self.numbers(name, 1, low=low, high=high)[0]

    def numbers(
        self, name: str, count: int | None = None, *, low: float = -LARGEST, high: float = LARGEST
    ) -> tuple[float, ...]:
        """Read an attribute of numbers within bounds; of any number of them without `count`."""
        found = self._numeric(name, "fiu", "finite number(s)", low, high, count)
        return tuple(float(value) for value in found)

    def integer(self, name: str, *, low: int = 0, high: int = LARGEST_INTEGER) -> int:
        """Read an attribute that is an integer within bounds."""
        return self.integers(name, 1, low=low, high=high)[0]

    def integers(
        self, name: str, count: int | None = None, *, low: int = 0, high: int = LARGEST_INTEGER
    ) -> tuple[int, ...]:
        """Read an attribute of integers within bounds; of any number of them without `count`."""
        found = self._numeric(name, "iu", "integer(s)", low, high, count)
        return tuple(int(value) for value in found)

    def boolean(self, name: str) -> bool:
        """Read an attribute that is a boolean."""
        return bool(self._numeric(name, "b", "boolean", 0, 1, 1)[0])

    def text(self, name: str) -> str:
        """Read an attribute that is a text."""
        value = self.attribute(name)
        if not isinstance(value, str):
            raise self._error("attribute", name, f"{_short(value)}, expected a text")
        return value

    def _numeric(
        self, name: str, kinds: str, words: str, low: float, high: float, count: int | None
    ) -> NDArray[Any]:
        """Read an attribute as an array (count,)."""
        value = self.attribute(name)
        found = np.atleast_1d(np.asarray(value))
        if not found.size and count is None:
            return found
        if (
            found.dtype.kind not in kinds
            or found.ndim != 1
            or (count is not None and found.size != count)
            or not _within(found, low, high)
        ):
            many = "" if count is None else f"{count} "
            raise self._error(
                "attribute", name, f"{_short(value)}, expected {many}{words}{_bounds(low, high)}"
            )
        return found

    @property
    def attribute_names(self) -> list[str]:
        """Names of all attributes."""
        return [str(name) for name in self.group.attrs]

    def attributes(self) -> dict[str, Any]:
        """Read all attributes; see `attribute`."""
        return {name: self.attribute(name) for name in self.attribute_names}

    def attribute(self, name: str) -> Any:
        """Read an attribute as a plain Python value, numbers as an array, None if it is empty.

        Raises
        ------
        Hdf5ContentError
            For one that is missing, neither numbers nor text, or too large.
        """
        if name not in self.group.attrs:
            raise self._error("attribute", name, "missing")
        try:
            return self._attribute(name)
        except _READ_ERRORS as error:
            if isinstance(error, Hdf5ContentError):
                raise
            raise self._error("attribute", name, f"cannot be read ({error})") from error

    def _attribute(self, name: str) -> Any:
        found = self.group.attrs.get_id(name)
        if found.shape is None:
            return None
        is_text = h5py.check_string_dtype(found.dtype) is not None
        n_bytes = found.dtype.itemsize * np.prod(found.shape, dtype=np.float64)
        if n_bytes > MAX_TEXT_BYTES or not (
            (is_text and found.shape == ()) or found.dtype.kind in "fiub"
        ):
            raise self._error("attribute", name, "expected a number, numbers or a text")
        value: Any = self.group.attrs[name]
        if is_text:
            return _decoded(value, f"attribute {self._path(name)!r}")
        return value.item() if isinstance(value, np.generic) else value

    def _member(self, name: str, kind: type[Any], word: str) -> Any:
        """Return what has a name, if it is of a kind and within the file."""
        if name not in self:
            raise self._error(word, name, "missing")
        if self.group.id.links.get_info(name.encode()).type != h5l.TYPE_HARD:
            raise self._error(word, name, "a link to another place is not followed")
        try:
            found = self.group[name]
        except _READ_ERRORS as error:
            raise self._error(word, name, f"cannot be read ({error})") from error
        if not isinstance(found, kind):
            raise self._error("member", name, f"expected a {word}")
        return found

    def _check_shape(self, name: str, found: tuple[int, ...], wanted: Shape) -> None:
        if len(found) == len(wanted):
            for size, want in zip(found, wanted, strict=True):
                if isinstance(want, str):
                    self.sizes.setdefault(want, size)
            if found == self._sizes_of(wanted):
                return
        raise self._error(
            "dataset", name, f"has shape {found}, expected {_shown(wanted, self.sizes)}"
        )

    def _sizes_of(self, shape: Shape) -> tuple[int, ...]:
        return tuple(self.sizes[size] if isinstance(size, str) else size for size in shape)


def _within(array: NDArray[Any], low: float, high: float) -> bool:
    if array.dtype.kind == "c":
        return bool(np.isfinite(array).all())
    if array.dtype.kind == "b":
        return bool((array.view(np.uint8) <= 1).all())
    return bool(((array >= low) & (array <= high)).all())


def _bounds(low: float, high: float) -> str:
    """Return bounds as a message gives them; those of all finite numbers go without saying."""
    least = f", at least {low:g}" if abs(low) < LARGEST else ""
    most = f", at most {high:g}" if abs(high) < LARGEST_INTEGER else ""
    return least + most


def _is_exact(found: NDArray[Any], array: NDArray[Any]) -> bool:
    """Whether a conversion of integers has kept their values."""
    return found.dtype.kind not in "iu" or bool((found == array).all())


def _decoded(text: str | bytes, where: str) -> str:
    """Return a text that h5py has read; it passes bytes that are no UTF-8 on as they are."""
    try:
        content = text if isinstance(text, bytes) else text.encode("utf-8", "surrogateescape")
        return content.decode("utf-8")
    except UnicodeError as error:
        raise Hdf5ContentError(f"{where}: not UTF-8") from error


def _short(value: object) -> str:
    """Return a value as it is shown in a message."""
    text = repr(value)
    return text if len(text) <= 60 else f"{text[:60]}..."


def _shown(shape: Shape, sizes: Mapping[str, int]) -> str:
    parts = [str(sizes.get(size, size) if isinstance(size, str) else size) for size in shape]
    return f"({', '.join(parts)})"
