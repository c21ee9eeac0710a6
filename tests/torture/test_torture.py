"""A short run of the torture: few kills, a full disk; and what its checks see."""

from __future__ import annotations

import random

from cli_plans import ROOM

from torture.attacks import fill_the_disk, kill_at_random
from torture.checks import differences, half_files
from torture.jobs import Workshop


def test_a_plan_survives(tmp_path) -> None:
    workshop, generator = Workshop(tmp_path), random.Random(0)
    for attacked in (
        kill_at_random("plan new", workshop, generator, kills=1),
        fill_the_disk("plan new", workshop, generator),
    ):
        assert attacked.faults == ()


def test_half_files_and_litter_are_seen(tmp_path) -> None:
    found, wanted = tmp_path / "found", tmp_path / "wanted"
    for folder in (found, wanted):
        folder.mkdir()
        (folder / "room.toml").write_text(ROOM)
    assert list(half_files(found)) == list(differences(found, wanted)) == []
    (found / "room.toml").write_text(ROOM[:100])
    (found / "room.json").write_text("{")
    (wanted / "map.h5").write_text("")
    assert [fault.split()[0] for fault in half_files(found)] == ["room.json", "room.toml"]
    assert list(differences(found, wanted)) == [
        "map.h5 is missing", "room.json is litter", "room.toml is different",
    ]  # fmt: skip


def test_tables_are_compared_without_measured_times(tmp_path) -> None:
    found, wanted = tmp_path / "found", tmp_path / "wanted"
    for folder, cpu_s in ((found, 1), (wanted, 2)):
        folder.mkdir()
        (folder / "runs.csv").write_text(f"run,cpu_time_s\n1,{cpu_s}\n")
        (folder / "claims.csv").write_text(f"claim,value\nCPU time falls,{cpu_s}\nothers,3\n")
    assert list(differences(found, wanted)) == []
    (found / "claims.csv").write_text("claim,value\nCPU time falls,1\nothers,4\n")
    assert list(differences(found, wanted)) == ["claims.csv is different"]
