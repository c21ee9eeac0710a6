"""Nothing that a file claims is believed before it is checked."""

import io
from pathlib import Path
from tempfile import TemporaryDirectory

import h5py
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from raytrace.results.checked_hdf5 import Checked, Hdf5ContentError, open_checked
from raytrace.results.hdf5 import hdf5_bytes, write_array
from raytrace.results.superblock import with_checksum


def fill(file: h5py.File) -> None:
    write_array(file, "x", np.arange(4.0), "m", "x")
    write_array(file, "layer", np.arange(12.0).reshape(3, 4), "dBm", "layer")
    write_array(file, "none", np.empty((0, 4)), "m", "nothing")
    file.attrs["name"], file.attrs["count"] = "flat", 3
    file.create_group("world").attrs["speed"] = 2


def opened(content: bytes) -> Checked:
    return Checked(h5py.File(io.BytesIO(content)))


@pytest.fixture
def file(tmp_path) -> h5py.File:
    path = tmp_path / "file.h5"
    path.write_bytes(hdf5_bytes(fill))
    return h5py.File(path, "r+")


def test_what_is_written_comes_back() -> None:
    checked = opened(hdf5_bytes(fill))
    np.testing.assert_array_equal(
        checked.array("layer", np.float64, ("y", "x")), np.arange(12.0).reshape(3, 4)
    )
    np.testing.assert_array_equal(checked.array("x", np.float64, ("x",)), np.arange(4.0))
    assert checked.array("none", np.float64, (0, "x")).shape == (0, 4)
    assert checked.attributes() == {"name": "flat", "count": 3}
    assert checked.within("world").attributes() == {"speed": 2}


@pytest.mark.parametrize("count", [0, 3, 70_000])
def test_the_checksum_of_a_superblock_is_that_of_the_hdf5_library(tmp_path, count: int) -> None:
    with h5py.File(tmp_path / "file.h5", "w", libver=("v110", "v110")) as file:
        file["x"] = np.arange(count)
    content = (tmp_path / "file.h5").read_bytes()
    damaged = bytearray(content)
    damaged[44:48] = bytes(4)
    assert with_checksum(bytes(damaged)) == content
    with pytest.raises(OSError, match="checksum"):
        opened(bytes(damaged))


def test_sizes_of_one_name_must_agree() -> None:
    checked = opened(hdf5_bytes(fill))
    checked.array("x", np.float64, ("n",))
    with pytest.raises(Hdf5ContentError, match=r"'layer': has shape \(3, 4\), expected \(4, 4\)"):
        checked.array("layer", np.float64, ("n", "n"))


@pytest.mark.parametrize(
    ("read", "message"),
    [
        (lambda c: c.array("y", np.float64, ("y",)), "dataset 'y': missing"),
        (lambda c: c.array("world", np.float64, ("y",)), "expected a dataset"),
        (lambda c: c.within("x"), "expected a group"),
        (lambda c: c.array("x", np.int64, ("x",)), "has type float64, expected integers"),
        (lambda c: c.array("x", np.float64, ("y", "x")), r"has shape \(4,\)"),
        (
            lambda c: c.array("x", np.float64, ("x",), high=2.0),
            "values from 0.0 to 3.0, expected floating-point numbers, at most 2",
        ),
    ],
)
def test_what_is_not_as_expected_is_named(read, message) -> None:
    with pytest.raises(Hdf5ContentError, match=message):
        read(opened(hdf5_bytes(fill)))


def test_nan_is_within_no_bounds() -> None:
    content = hdf5_bytes(lambda f: write_array(f, "x", np.array([0.0, np.nan]), "m", "x"))
    with pytest.raises(Hdf5ContentError, match="values from nan"):
        opened(content).array("x", np.float64, ("x",))


def test_links_are_not_followed(file, tmp_path) -> None:
    with h5py.File(tmp_path / "other.h5", "w") as other:
        other["x"] = np.arange(4.0)
    del file["x"]
    file["x"] = h5py.ExternalLink("other.h5", "x")
    file["soft"] = h5py.SoftLink("/layer")
    for name in ("x", "soft"):
        with pytest.raises(Hdf5ContentError, match="not followed"):
            Checked(file).array(name, np.float64, ("x",))


def test_data_in_other_files_is_not_read(file, tmp_path) -> None:
    (tmp_path / "raw").write_bytes(bytes(32))
    file.create_dataset("raw", (4,), "f8", external=[(str(tmp_path / "raw"), 0, 32)])
    layout = h5py.VirtualLayout((4,), "f8")
    layout[:] = h5py.VirtualSource(str(tmp_path / "other.h5"), "x", (4,))
    file.create_virtual_dataset("virtual", layout)
    for name in ("raw", "virtual"):
        with pytest.raises(Hdf5ContentError, match="other files"):
            Checked(file).array(name, np.float64, (4,))


@pytest.mark.parametrize("shape", [(1 << 40,), (1 << 26, 1), (5000,)])
def test_sizes_that_the_file_cannot_hold_are_refused_before_they_are_allocated(file, shape) -> None:
    file.create_dataset("huge", shape, "f8", chunks=True)
    with pytest.raises(Hdf5ContentError, match="0 bytes are stored"):
        Checked(file).array("huge", np.float64, shape)


def test_a_bomb_within_one_chunk_is_refused(file) -> None:
    file.create_dataset("bomb", (1 << 28,), "i1", chunks=(1 << 28,), compression="gzip")
    file["bomb"][:10] = 1
    with pytest.raises(Hdf5ContentError, match="claims shape"):
        Checked(file).array("bomb", np.int8, (1 << 28,))


@pytest.mark.parametrize(
    "value", [np.array([(1, 2.0)], [("a", "i4"), ("b", "f8")]), 1j, ["one", "two"], b"\xff"]
)
def test_attributes_of_other_kinds_are_refused(file, value) -> None:
    file.attrs["odd"] = value
    with pytest.raises(Hdf5ContentError, match="attribute 'odd'"):
        Checked(file).attributes()


def read(path) -> tuple[np.ndarray, dict]:
    with open_checked(path) as checked:
        return checked.array("layer", np.float64, ("y", "x")), checked.attributes()


def test_a_flipped_bit_anywhere_is_noticed(tmp_path) -> None:
    path = tmp_path / "file.h5"
    content = hdf5_bytes(fill)
    for at in range(0, len(content) - 46, 97):
        damaged = bytearray(content)
        damaged[at] ^= 0x10
        path.write_bytes(damaged)
        with pytest.raises(Hdf5ContentError, match="changed since"):
            read(path)


@pytest.mark.parametrize("lost", [1, 20, 45, 50])
def test_a_file_that_lost_its_end_is_refused(tmp_path, lost) -> None:
    path = tmp_path / "file.h5"
    path.write_bytes(hdf5_bytes(fill)[:-lost])
    with pytest.raises(Hdf5ContentError):
        read(path)


def test_a_file_that_others_have_changed_is_read(tmp_path) -> None:
    path = tmp_path / "file.h5"
    path.write_bytes(hdf5_bytes(fill))
    with h5py.File(path, "r+") as file:
        file.attrs["comment"] = "mine"
    assert read(path)[1]["comment"] == "mine"


@given(st.integers(0, 2**32), st.lists(st.integers(0, 255), min_size=1, max_size=4), st.booleans())
def test_damage_without_a_hash_ends_in_an_error_or_right_numbers(at, damage, in_heap) -> None:
    """Checksums on metadata and data, and the check of heaps: no hang, no wrong number."""
    whole = hdf5_bytes(fill)[:-46]
    damaged = bytearray(whole)
    heap = whole.index(b"GCOL")
    at = heap + at % 256 if in_heap else at % (len(whole) - 4)
    damaged[at : at + len(damage)] = bytes(damage)
    with TemporaryDirectory() as folder:
        path = Path(folder) / "file.h5"
        path.write_bytes(damaged)
        try:
            layer, _ = read(path)
        except Hdf5ContentError:
            return
    np.testing.assert_array_equal(layer, np.arange(12.0).reshape(3, 4))
