"""Whatever is killed, and when: the next run gives the same bits as one that was left alone."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path

import pytest
from small_datasets import bits, edited, made

from atomicfiles import atomic_write
from rssnav.datasets.work import MARK

TEXT = edited("seeds = 3", "seeds = 6")


def killed_after(n_files: int, folder: Path, spec: Path, *options: str) -> None:
    """Start the command, and kill it and all that it has started once some plans are written."""
    process = subprocess.Popen(
        [sys.executable, "-m", "rssnav", "dataset", "make", str(spec), "-o", str(folder), *options],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    )
    while len(list(folder.glob("*/*/[!.]*.h5"))) < n_files and process.poll() is None:
        time.sleep(0.002)
    os.killpg(process.pid, signal.SIGKILL)
    process.wait()


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    folder = tmp_path_factory.mktemp("made") / "whole"
    made(folder, TEXT)
    return bits(folder)


def test_a_run_that_was_killed_at_its_first_file_leaves_a_folder_for_the_next(tmp_path) -> None:
    folder = tmp_path / "set"
    folder.mkdir()
    with suppress(RuntimeError), atomic_write(folder / MARK) as temporary:
        left = temporary.with_name(temporary.name.replace(".part", "0.part"))
        left.write_text("half of a spec")
        raise RuntimeError
    made(folder, TEXT.replace("seeds = 6", "seeds = 3"))
    assert not left.exists()


def test_a_killed_command_goes_on_to_the_same_bits(whole, tmp_path) -> None:
    spec = tmp_path / "spec.toml"
    spec.write_text(TEXT)
    folder = tmp_path / "set"
    killed_after(2, folder, spec, "--threads", "2")
    result, _ = made(folder, TEXT)
    assert 0 < result.n_traced < 6
    assert [path for path in folder.rglob("*") if ".part" in path.name] == []
    assert bits(folder) == whole
