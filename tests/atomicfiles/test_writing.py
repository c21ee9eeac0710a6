import errno
import os
import signal
import subprocess
import sys
from multiprocessing import get_context
from pathlib import Path

import pytest

from atomicfiles import atomic_write, atomic_write_all

WRITER = """
import sys, time
from atomicfiles import atomic_write
with atomic_write(sys.argv[1]) as temporary:
    temporary.write_text("half")
    print("writing", flush=True)
    time.sleep(60)
"""


def names(folder: Path) -> list[str]:
    return sorted(os.listdir(folder))


def started_writer(path: Path) -> subprocess.Popen[str]:
    writer = subprocess.Popen(
        [sys.executable, "-c", WRITER, str(path)], stdout=subprocess.PIPE, text=True
    )
    assert writer.stdout is not None
    assert writer.stdout.readline() == "writing\n"
    return writer


def ended(writer: subprocess.Popen[str], by: signal.Signals = signal.SIGKILL) -> None:
    writer.send_signal(by)
    with writer:
        pass


def test_a_file_appears_whole_in_a_new_folder(tmp_path) -> None:
    path = tmp_path / "new" / "map.h5"
    with atomic_write(path) as temporary:
        temporary.write_bytes(b"content")
        assert temporary.suffix == ".h5"
        assert not path.exists()
    assert path.read_bytes() == b"content"
    assert names(path.parent) == ["map.h5"]


def test_an_exception_leaves_the_old_file_and_nothing_else(tmp_path) -> None:
    path = tmp_path / "plan.toml"
    path.write_text("old")
    with pytest.raises(UnicodeEncodeError), atomic_write(path) as temporary:
        temporary.write_text("new \udcff", encoding="utf-8")
    assert path.read_text() == "old"
    assert names(tmp_path) == ["plan.toml"]


def test_a_link_is_followed(tmp_path) -> None:
    (tmp_path / "target.txt").write_text("old")
    (tmp_path / "link.txt").symlink_to(tmp_path / "target.txt")
    with atomic_write(tmp_path / "link.txt") as temporary:
        temporary.write_text("new")
    assert (tmp_path / "link.txt").is_symlink()
    assert (tmp_path / "target.txt").read_text() == "new"


def test_a_killed_writer_is_cleaned_up_by_the_next_one(tmp_path) -> None:
    path = tmp_path / "map.h5"
    ended(started_writer(path))
    assert len(names(tmp_path)) == 1
    with atomic_write(path) as temporary:
        temporary.write_text("new")
    assert names(tmp_path) == ["map.h5"]


def test_a_living_writer_is_left_alone_and_the_last_one_wins(tmp_path) -> None:
    path = tmp_path / "map.h5"
    writer = started_writer(path)
    with atomic_write(path) as temporary:
        temporary.write_text("new")
    assert len(names(tmp_path)) == 2
    ended(writer)
    with atomic_write(path) as temporary:
        temporary.write_text("newer")
    assert names(tmp_path) == ["map.h5"]


def test_what_another_machine_left_is_not_touched(tmp_path, monkeypatch) -> None:
    path = tmp_path / "map.h5"
    ended(started_writer(path))
    monkeypatch.setattr("atomicfiles.writing._HOST", "elsewhere")
    with atomic_write(path) as temporary:
        temporary.write_text("new")
    assert len(names(tmp_path)) == 2


def write_many(path: Path, content: bytes) -> None:
    for _ in range(50):
        with atomic_write(path) as temporary:
            temporary.write_bytes(content)


def test_concurrent_writers_leave_one_whole_file(tmp_path) -> None:
    path = tmp_path / "map.h5"
    contents = [bytes([letter]) * 10_000 for letter in b"abc"]
    writers = [get_context("spawn").Process(target=write_many, args=(path, c)) for c in contents]
    for writer in writers:
        writer.start()
    for writer in writers:
        writer.join()
        assert writer.exitcode == 0
    assert path.read_bytes() in contents
    assert names(tmp_path) == ["map.h5"]


SMALL_DISK = """
import resource, signal, sys
from pathlib import Path
from atomicfiles import atomic_write, atomic_write_all
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))
folder = Path(sys.argv[1])
try:
    if sys.argv[2] == "one":
        with atomic_write(folder / "map.h5") as temporary:
            temporary.write_bytes(bytes(10_000))
    else:
        atomic_write_all({folder / "a.pgm": b"fits", folder / "b.yaml": bytes(10_000)})
except OSError as error:
    print(error.errno, error.filename)
"""


def on_a_small_disk(folder: Path, what: str) -> str:
    """Write in a process whose files may have 4096 bytes, as on a disk that is full."""
    command = [sys.executable, "-c", SMALL_DISK, str(folder), what]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()


def test_a_full_disk_is_an_error_that_names_the_file(tmp_path) -> None:
    path = tmp_path / "map.h5"
    path.write_text("old")
    assert on_a_small_disk(tmp_path, "one") == f"{errno.EFBIG} {path}"
    assert path.read_text() == "old"
    assert names(tmp_path) == ["map.h5"]


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no named pipes")
def test_what_is_no_file_is_not_replaced(tmp_path) -> None:
    """A file renamed over a device would take its place for all programs."""
    os.mkfifo(tmp_path / "pipe")
    pipe = tmp_path / "pipe"
    with pytest.raises(FileExistsError, match="is not a regular file"), atomic_write(pipe):
        pass
    assert pipe.is_fifo()
    assert names(tmp_path) == ["pipe"]


@pytest.mark.skipif(not Path("/proc/self").is_dir(), reason="no folder that nobody can write")
def test_an_error_names_the_file_and_not_the_temporary_one() -> None:
    with pytest.raises(OSError, match=r"'/proc/map\.h5'"), atomic_write("/proc/map.h5"):
        pass


def test_of_several_files_all_or_none_are_written(tmp_path) -> None:
    assert on_a_small_disk(tmp_path, "all") == f"{errno.EFBIG} {tmp_path / 'b.yaml'}"
    assert names(tmp_path) == []
    atomic_write_all({tmp_path / "a.pgm": b"fits", tmp_path / "b.yaml": b"too"})
    assert names(tmp_path) == ["a.pgm", "b.yaml"]
