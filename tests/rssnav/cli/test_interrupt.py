"""Ctrl-C, sent to a real process: nothing half-written, and a line on what was kept."""

from __future__ import annotations

import signal
import subprocess
import sys
import time

import h5py
import pytest
from cli_plans import ROOM, done, room_file

from rssnav import TrainingResult

LONG_MAP = ("map", "scenario2", "--cell-size", "0.25", "--threads", "1")
LONG_TRAINING = ("--agent", "location", "--runs", "100000", "--episodes", "200")
TIMEOUT_S = 240.0


def interrupted_once_under_way(*arguments: object) -> tuple[int, str]:
    """Send SIGINT to ``rssnav`` after its first line of progress; return exit code and stderr."""
    command = [sys.executable, "-m", "rssnav", *map(str, arguments)]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as process:
        assert process.stderr is not None
        lines: list[str] = []
        while not any("%)" in line for line in lines):
            lines.append(process.stderr.readline())
            assert lines[-1], "".join(lines)
        process.send_signal(signal.SIGINT)
        _, rest = process.communicate(timeout=TIMEOUT_S)
    return process.returncode, "".join(lines) + rest


def test_interrupted_map_leaves_the_old_file_or_none(tmp_path) -> None:
    old = tmp_path / "old.h5"
    with h5py.File(old, "w") as file:
        file["temperature"] = [1.0]
    before = old.read_bytes()
    code, errors = interrupted_once_under_way(*LONG_MAP, "-o", old, "--force")
    assert code == 130
    assert errors.endswith("rssnav: interrupted; no incomplete file was written\n")
    assert "Traceback" not in errors
    assert old.read_bytes() == before
    assert [file.name for file in tmp_path.iterdir()] == ["old.h5"]


def test_interrupted_training_keeps_its_finished_runs(tmp_path) -> None:
    plan, radio_map = room_file(tmp_path, ROOM), tmp_path / "room.h5"
    result = tmp_path / "result.h5"
    done("map", plan, "-o", radio_map, "--reflections", "1", "--diffractions", "0")
    code, errors = interrupted_once_under_way(
        "train", plan, "--map", radio_map, "-o", result, *LONG_TRAINING
    )
    assert code == 130
    assert "Traceback" not in errors
    kept = TrainingResult.load(result).run_ids.size
    assert 0 < kept < 100_000
    assert errors.splitlines()[-1] == (
        f"rssnav: interrupted; {kept} of 100000 runs are finished and saved to {result}; run "
        "the same command again to resume"
    )


@pytest.mark.parametrize("sent", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize("after_s", [1.0, 4.0])
def test_a_long_trace_ends_at_once_with_one_line(sent: signal.Signals, after_s: float) -> None:
    command = [sys.executable, "-m", "rssnav", "paths", "flat", "--to", "9,6.5"]
    command += ["--reflections", "20"]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as process:
        time.sleep(after_s)
        process.send_signal(sent)
        sent_s = time.monotonic()
        _, errors = process.communicate(timeout=TIMEOUT_S)
    assert time.monotonic() - sent_s < 5.0
    assert process.returncode == 128 + sent
    assert errors.splitlines()[-1].startswith("rssnav: interrupted")
    assert "Traceback" not in errors


@pytest.mark.parametrize("sent", ["SIGINT", "SIGTERM"])
def test_a_signal_after_all_is_done_changes_nothing(sent: str) -> None:
    program = f"""
import os, signal
from rssnav.interrupts import INTERRUPTS

class Last:
    def __del__(self, end=os.kill, process=os.getpid(), sent=signal.{sent}):
        end(process, sent)

last = Last()
INTERRUPTS.install()
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, check=False)
    assert (done.returncode, done.stderr) == (0, b"")


def test_an_error_that_an_interrupt_becomes_is_an_interrupt() -> None:
    """Libraries that are being imported may turn KeyboardInterrupt into another error."""
    code = """
import os, signal, time
import rssnav.cli
from rssnav.__main__ import main

def app(prog_name):
    try:
        os.kill(os.getpid(), signal.SIGTERM)
        time.sleep(10)
    except KeyboardInterrupt:
        raise NameError("half imported") from None

rssnav.cli.app = app
main()
"""
    ended = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=False
    )
    assert ended.returncode == 143
    assert ended.stderr == "rssnav: interrupted; no incomplete file was written\n"
