"""Damage to the structure of HDF5 files: every dataset and attribute as something else."""

from __future__ import annotations

import io
from collections.abc import Iterator

import h5py
import numpy as np

VALUES = (
    np.zeros(0),
    np.zeros((3, 3), dtype=complex),
    np.full((2, 2, 2), 7),
    np.array([b"text"]),
    np.zeros(3, dtype="V8"),
    np.zeros(2, dtype=[("a", "f8"), ("b", "i4")]),
    "text",
    True,
    -7,
    2**63,
    1e308,
    np.nan,
    np.inf,
    h5py.Empty("f8"),
)
"""What takes the place of a dataset or an attribute."""

_NOT_READ = ("units", "long_name", "CLASS", "NAME", "DIMENSION_LIST", "REFERENCE_LIST")

IN_PLACE = (np.nan, np.inf, -np.inf, -7, 1e6)
"""What takes the place of the first value of an array."""


def damaged(content: bytes) -> Iterator[tuple[tuple[str, str], bytes]]:
    """Yield what is damaged, its name first, and the file with the damage."""
    with h5py.File(io.BytesIO(content)) as file:
        names: list[str] = []
        file.visit(names.append)
        arrays = {name: file[name][()] for name in names if isinstance(file[name], h5py.Dataset)}
        attributes = [("/", key) for key in file.attrs]
        attributes += [(n, key) for n in names for key in file[n].attrs if key not in _NOT_READ]
    for name in names:
        for k, value in enumerate((*VALUES, *_links(), None)):
            yield (
                (name, f"as {k}"),
                changed(content, lambda file, n=name, v=value: _put(file, n, v)),
            )
    for name, array in arrays.items():
        for k, variant in enumerate(_variants(array)):
            yield (
                (name, f"variant {k}"),
                changed(content, lambda file, n=name, v=variant: _put(file, n, v)),
            )
    for owner, key in attributes:
        for k, value in enumerate((*VALUES, None)):
            yield (
                (key, f"of {owner} as {k}"),
                changed(
                    content, lambda file, o=owner, n=key, v=value: _put_attribute(file[o], n, v)
                ),
            )


def changed(content: bytes, change) -> bytes:
    """Return a file after a change, without the hash that it ended with."""
    buffer = io.BytesIO(content)
    with h5py.File(buffer, "r+") as file:
        change(file)
    return buffer.getvalue()


def _links() -> tuple[object, ...]:
    return (h5py.SoftLink("/"), h5py.SoftLink("/none"), h5py.ExternalLink("/dev/zero", "/"))


def _put(file: h5py.File, name: str, value: object) -> None:
    del file[name]
    if value is None:
        file.create_dataset(name, (1 << 20, 1 << 20), "f8", chunks=True)
    elif value is not True:
        file[name] = value


def _put_attribute(owner: h5py.HLObject, key: str, value: object) -> None:
    del owner.attrs[key]
    if value is not None:
        owner.attrs[key] = value


def _variants(array: np.ndarray) -> Iterator[np.ndarray]:
    """Yield an array of other sizes, and with another first value."""
    if not array.ndim or not array.size:
        return
    yield array[:-1]
    yield np.concatenate((array, array[:1]))
    yield array[..., None]
    yield array[::-1].copy()
    for value in IN_PLACE:
        other = array.astype(np.float64) if array.dtype.kind in "iu" else array.copy()
        if other.dtype.kind == "f":
            other.flat[0] = value
            yield other if array.dtype.kind == "f" or not np.isfinite(value) else other.astype(int)
