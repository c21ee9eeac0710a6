"""Damaged HDF5 files: in the structure, and in the bytes with and without a right hash."""

from __future__ import annotations

import hashlib
import io
from contextlib import suppress
from typing import Any

import h5py
import numpy as np
from hypothesis import strategies as st

from fuzz.mutations import NUMBERS, TEXTS, mutated_bytes

_MARK = b"rssnav sha256 "
_MAX_READ_BYTES = 1 << 20  # an earlier change may have made a dataset of terabytes
_FLOATS = (*(float(n) for n in NUMBERS if abs(n) < 10**300 or n != n), np.inf, -np.inf)
ARRAYS: tuple[Any, ...] = (
    np.zeros(0), np.zeros((0, 3)), np.zeros((3, 3), dtype=complex), np.zeros(()), np.zeros((2, 2,
    2)),
    np.full((4, 6), np.nan), np.full((4, 6), np.inf), np.arange(6.0), np.arange(6)[::-1],
    np.array([b"text"]), np.zeros(3, dtype=bool), np.zeros(3, dtype="V8"),
    np.zeros(2, dtype=[("a", "f8"), ("b", "i4")]), np.full(6, -(2**62)), np.full(6, 2**63,
    dtype="u8"),
    np.zeros((4, 6), dtype="f2"), np.zeros((4, 6), dtype=">f8"), "text", 0, -1, 1.5, np.nan,
)  # fmt: skip


def without_hash(content: bytes) -> bytes:
    """Remove the hash behind the file, as another program that changes it does."""
    body, mark, _ = content.rpartition(_MARK)
    return body if mark else content


def with_hash(content: bytes) -> bytes:
    """Append the right hash, as an attacker would."""
    return content + _MARK + hashlib.sha256(content).digest()


@st.composite
def damaged_hdf5(draw: st.DrawFn, sample: bytes) -> bytes:
    """Damage the bytes of a file as it is, without hash or with a right one, or its structure."""
    match draw(st.integers(0, 7)):
        case 0:
            return draw(mutated_bytes(sample))
        case 1:
            return draw(mutated_bytes(without_hash(sample)))
        case 2:
            return with_hash(draw(mutated_bytes(without_hash(sample))))
        case _:
            return draw(restructured(sample))


@st.composite
def restructured(draw: st.DrawFn, sample: bytes) -> bytes:
    """Replace, remove, link or resize datasets and attributes."""
    buffer = io.BytesIO(without_hash(sample))
    with h5py.File(buffer, "r+") as file:
        for _ in range(draw(st.integers(1, 2))):
            with suppress(KeyError, MemoryError, OSError, RuntimeError, TypeError, ValueError):
                _change(draw, file)  # HDF5 may refuse a change after an earlier one
    content = buffer.getvalue()
    return with_hash(content) if draw(st.booleans()) else content


def _change(draw: st.DrawFn, file: h5py.File) -> None:
    names: list[str] = []
    file.visit(names.append)
    owner = file if not names else file[draw(st.sampled_from(["/", *names]))]
    attributes = sorted(owner.attrs)
    if attributes and draw(st.booleans()):
        _change_attribute(draw, owner, draw(st.sampled_from(attributes)))
    elif names:
        _change_member(draw, file, draw(st.sampled_from(names)))


def _change_attribute(draw: st.DrawFn, owner: Any, name: str) -> None:
    match draw(st.integers(0, 5)):
        case 0:
            del owner.attrs[name]
        case 1:
            owner.attrs[name] = draw(st.sampled_from(ARRAYS))
        case 2:
            owner.attrs[name] = draw(st.sampled_from(TEXTS)).replace("\x00", "?")
        case 3:
            owner.attrs[name] = h5py.Empty("f8")
        case 4:
            other = draw(st.sampled_from(sorted(owner.attrs)))
            value = owner.attrs[other]
            owner.attrs[name] = value
        case _:
            owner.attrs[name] = draw(st.sampled_from(_FLOATS))


def _change_member(draw: st.DrawFn, file: h5py.File, name: str) -> None:
    found = file[name]
    is_small = isinstance(found, h5py.Dataset) and found.nbytes <= _MAX_READ_BYTES
    old = found[()] if is_small else None
    match draw(st.integers(0, 7)):
        case 0:
            del file[name]
        case 1:
            _replace(file, name, draw(st.sampled_from(ARRAYS)))
        case 2:
            del file[name]
            file.create_group(name)
        case 3:
            del file[name]
            file[name] = draw(
                st.sampled_from(
                    (h5py.SoftLink("/"), h5py.SoftLink("/nowhere"), h5py.SoftLink(f"/{name}"),
                     h5py.ExternalLink("/etc/hostname", "/"), h5py.ExternalLink("other.h5", "/x"))
                )
            )  # fmt: skip
        case 4:
            huge = draw(st.sampled_from(((2**40,), (2**20, 2**20), (2**31, 2), (1, 2**33))))
            del file[name]
            file.create_dataset(name, shape=huge, dtype="f8", chunks=True)
        case 5 if isinstance(old, np.ndarray) and old.size:
            _replace(file, name, _with_other_value(draw, old))
        case 6 if isinstance(old, np.ndarray) and old.ndim:
            _replace(file, name, old[:-1])
        case _ if isinstance(old, np.ndarray) and old.dtype.kind in "fiu":
            kinds = ("f4", "i8", "u1", "c16", ">i4", "S5", "f2")
            with np.errstate(all="ignore"):
                _replace(file, name, old.astype(draw(st.sampled_from(kinds))))
        case _:
            _replace(file, name, draw(st.sampled_from(ARRAYS)))


def _replace(file: h5py.File, name: str, value: Any) -> None:
    attributes = [(k, v) for k, v in file[name].attrs.items() if k not in _SCALE_ATTRIBUTES]
    del file[name]
    file[name] = value
    for key, kept in attributes:
        file[name].attrs[key] = kept


_SCALE_ATTRIBUTES = ("REFERENCE_LIST", "DIMENSION_LIST", "CLASS")


def _with_other_value(draw: st.DrawFn, old: Any) -> Any:
    changed = old.copy()
    at = draw(st.integers(0, changed.size - 1))
    if changed.dtype.kind == "f":
        changed.flat[at] = draw(st.sampled_from(_FLOATS))
    elif changed.dtype.kind in "iu":
        limits = np.iinfo(changed.dtype)
        changed.flat[at] = draw(st.sampled_from((limits.min, limits.max, 0, 1)))
    return changed
