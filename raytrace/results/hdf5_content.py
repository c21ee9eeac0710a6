"""What an HDF5 file claims, against the bytes it has.

HDF5 allocates what a dataset claims and decompresses each chunk without a limit, so both are
checked before it reads.
"""

import hashlib
import re
import struct
import zlib
from pathlib import Path

import h5py
import numpy as np

from raytrace.results.hdf5 import HASH_MARK

MAX_FILE_BYTES = 1 << 32
"""Largest file that is read."""
MAX_VALUES = 1 << 27
"""Most values of one dataset."""

_FILTERS = (h5py.h5z.FILTER_SHUFFLE, h5py.h5z.FILTER_DEFLATE, h5py.h5z.FILTER_FLETCHER32)
"""The filters that are read, in the order in which they are applied, each at most once."""
_CHECKSUM_BYTES = 4
HDF5_SIGNATURE = b"\x89HDF\r\n\x1a\n"
_HASH_BYTES = 32


class Hdf5ContentError(ValueError):
    """A file does not hold what it should; the message names the dataset or attribute."""


def sound_content(path: Path) -> bytes:
    """Read a file; find damage before the HDF5 library sees it.

    The library can loop for ever in a damaged heap of texts.

    Raises
    ------
    Hdf5ContentError
        For a damaged file, one that is too large, or no file.
    OSError
        Where the system cannot read it.
    """
    if not path.is_file():
        raise Hdf5ContentError("not a file")
    size = path.stat().st_size
    if size > MAX_FILE_BYTES:
        raise Hdf5ContentError(f"{size} bytes; at most {MAX_FILE_BYTES} are read")
    content = path.read_bytes()
    body, mark, digest = content.rpartition(HASH_MARK)
    if mark and len(digest) == _HASH_BYTES:
        if hashlib.sha256(body).digest() != digest:
            raise Hdf5ContentError("the content has changed since it was written")
    elif not content.startswith(HDF5_SIGNATURE):
        raise Hdf5ContentError("not an HDF5 file")
    elif _end_of_hdf5(content) not in (None, len(content)):
        raise Hdf5ContentError("the end of the file is damaged")
    for found in re.finditer(rb"GCOL\x01", content):
        if not _is_sound_heap(content, found.start()):
            raise Hdf5ContentError("a heap of texts is damaged")
    return content


def _end_of_hdf5(content: bytes) -> int | None:
    """End of the file by its superblock of version 2 or 3 (HDF5 specification, II.A)."""
    known = content.startswith(HDF5_SIGNATURE) and content[8:9] in (b"\x02", b"\x03")
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
        if length > end - at - 16:
            return False
        at += 16 + (length + 7) // 8 * 8
    return True


def check_storage(name: str, dataset: h5py.Dataset) -> None:
    """Refuse a dataset kept elsewhere, or one that claims more than the file holds."""
    if dataset.is_virtual or dataset.external is not None:
        raise Hdf5ContentError(f"dataset {name!r}: data in other files is not read")
    if dataset.shape is None:
        raise Hdf5ContentError(f"dataset {name!r}: has no values")
    sizes = [np.prod(shape, dtype=np.float64) for shape in (dataset.shape, dataset.chunks or ())]
    stored, held = dataset.id.get_storage_size(), dataset.file.id.get_filesize()
    sound = max(sizes) <= MAX_VALUES and stored <= held
    if sound and dataset.chunks is None:
        sound = sizes[0] * dataset.dtype.itemsize <= stored
    elif sound:
        sound = sizes[0] == 0 or _has_sound_chunks(dataset, int(sizes[1]))
    if not sound:
        raise Hdf5ContentError(
            f"dataset {name!r}: claims shape {dataset.shape}, {stored} bytes are stored"
        )


def _has_sound_chunks(dataset: h5py.Dataset, chunk_size: int) -> bool:
    """Whether all chunks are stored, and each gives exactly as many bytes as it should."""
    properties = dataset.id.get_create_plist()
    filters = [properties.get_filter(k)[0] for k in range(properties.get_nfilters())]
    if filters != [known for known in _FILTERS if known in filters]:
        return False
    n_chunks = np.prod(
        [-(-n // m) for n, m in zip(dataset.shape, dataset.chunks or (), strict=True)]
    )
    if dataset.id.get_num_chunks() != n_chunks:
        return False
    n_bytes = chunk_size * dataset.dtype.itemsize
    return all(_is_sound_chunk(dataset, k, filters, n_bytes) for k in range(int(n_chunks)))


def _is_sound_chunk(dataset: h5py.Dataset, index: int, filters: list[int], n_bytes: int) -> bool:
    info = dataset.id.get_chunk_info(index)
    if info.size > dataset.file.id.get_filesize():
        return False
    skipped, stored = dataset.id.read_direct_chunk(info.chunk_offset)
    applied = [known for k, known in enumerate(filters) if not skipped >> k & 1]
    if h5py.h5z.FILTER_DEFLATE in applied:
        try:
            return len(zlib.decompressobj().decompress(stored, n_bytes + 1)) == n_bytes
        except zlib.error:
            return False
    checksum = _CHECKSUM_BYTES if h5py.h5z.FILTER_FLETCHER32 in applied else 0
    return len(stored) == n_bytes + checksum
