"""What was computed is kept: while it goes on, after a kill, and where a disk is full."""

from __future__ import annotations

import errno
import os
import signal
import subprocess
import sys
import tempfile
import time
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from cli_plans import QUICK, done, edited, room_file

from rssnav import LocationAgent, TrainingResult, train, training
from rssnav.keeping import lenient, save_or_rescue


def test_checkpoints_hold_the_finished_realisations(room_world, tmp_path, monkeypatch) -> None:
    monkeypatch.setattr(training, "_CHECKPOINT_S", 0.0)
    monkeypatch.setattr(training, "_CHECKPOINT_FRACTION", 1e9)
    settings = {"runs": 6, "episodes": 20, "snapshot_episodes": (10,), "threads": 1}
    kept = []
    whole = train(room_world, LocationAgent(), checkpoint=kept.append, **settings)
    finished = [set(result.run_ids.tolist()) for result in kept]
    assert [len(runs) for runs in finished] == [1, 2, 3, 4, 5]
    assert all(before < after for before, after in pairwise(finished))
    kept[2].save(tmp_path / "killed.h5")
    earlier = TrainingResult.load(tmp_path / "killed.h5")
    kept.clear()
    resumed = train(room_world, LocationAgent(), checkpoint=kept.append, resume=earlier, **settings)
    assert [result.run_ids.size for result in kept] == [4, 5]
    for name in ("run_ids", "steps", "truncated", "visit_counts", "trajectories", "path_length_m"):
        np.testing.assert_array_equal(getattr(resumed, name), getattr(whole, name))


def test_checkpoints_are_rare(room_world) -> None:
    kept = []
    train(room_world, LocationAgent(), runs=4, episodes=20, checkpoint=kept.append)
    assert kept == []


KILLED = """
import sys
from rssnav import training
from rssnav.cli import app
training._CHECKPOINT_S, training._CHECKPOINT_FRACTION = 0.2, 0.9
app(sys.argv[1:])
"""


@pytest.mark.skipif(os.name == "nt", reason="there is no SIGKILL")
def test_a_killed_training_is_continued_by_the_same_command(tmp_path) -> None:
    text = edited("points = [[3, 0], [3, 4]]", "points = [[3, 0], [3, 2.5]]")
    plan, radio_map = room_file(tmp_path, text), tmp_path / "room.h5"
    done("map", plan, "-o", radio_map, *QUICK)
    folder = tmp_path / "out"
    kept = folder / "kept.h5"
    common = ("train", plan, "--map", radio_map, "--agent", "location", "--episodes", "20")
    arguments = [*map(str, common), "--runs", "100000", "-o", str(kept)]
    with subprocess.Popen([sys.executable, "-c", KILLED, *arguments]) as process:
        until = time.monotonic() + 120
        while not kept.exists() and process.poll() is None and time.monotonic() < until:
            time.sleep(0.01)
        process.send_signal(signal.SIGKILL)
    result = TrainingResult.load(kept)
    assert 0 < result.run_ids.size < 100_000
    result.save(kept)  # as the next checkpoint does
    assert [path.name for path in folder.iterdir()] == ["kept.h5"]
    again = train(
        result.world,
        LocationAgent(),
        runs=100_000,
        episodes=20,
        learning=result.learning,
        only_runs=result.run_ids[:5],
    )
    np.testing.assert_array_equal(again.steps, result.steps[:5, : again.steps.shape[1]])


def full(path: Path) -> None:
    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(path))


def test_what_a_full_disk_does_not_take_is_kept_elsewhere(tmp_path, monkeypatch) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    target = tmp_path / "full" / "result.txt"

    def save(path: Path) -> None:
        if path == target:
            full(path)
        path.write_text("complete")

    with pytest.raises(OSError, match=r"No space left on device; the result was saved to") as error:
        save_or_rescue(save, target)
    assert error.value.filename == str(target)
    (kept,) = tmp_path.glob("rssnav-*/result.txt")
    assert kept.read_text() == "complete"
    assert str(kept) in error.value.strerror


def test_where_nothing_takes_it_nothing_is_left(tmp_path, monkeypatch) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    with pytest.raises(OSError, match=r"could not be saved to .* either"):
        save_or_rescue(full, tmp_path / "result.txt")
    assert list(tmp_path.iterdir()) == []


def test_saving_in_between_may_fail() -> None:
    said = []
    save = lenient(full, said.append)
    save(Path("a"))
    save(Path("b"))
    assert len(said) == 1
    assert "No space left" in said[0]
