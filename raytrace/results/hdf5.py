"""HDF5 files built in memory, with checksums and a hash of their content."""

import hashlib
from collections.abc import Callable
from typing import Any
from uuid import uuid4

import h5py
from numpy.typing import NDArray

from raytrace.results.superblock import with_checksum

HASH_MARK = b"rssnav sha256 "
"""Stands behind the content and before its hash."""


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
        content = with_checksum(file.id.get_file_image())
    return content + HASH_MARK + hashlib.sha256(content).digest()


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
