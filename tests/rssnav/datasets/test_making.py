"""A data set is made once, whole, and the same however it is made."""

from __future__ import annotations

import fcntl
import json
import threading
from dataclasses import replace

import h5py
import numpy as np
import pytest
from small_datasets import SPEC, bits, edited, made, spec_of

import floorplans
from raytrace import Grid, Isotropic, TraceConfig, Transmitter, compute_radio_map
from rssnav.datasets.checks import problems
from rssnav.datasets.container import read_plan_file, write_plan_file
from rssnav.datasets.cost import estimated
from rssnav.datasets.engines.job import Job
from rssnav.datasets.engines.threads import Threads
from rssnav.datasets.errors import DatasetError
from rssnav.datasets.manifest import read_manifest
from rssnav.maps import cells_inside
from rssnav.scenes import scene_of


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """The small data set, made on one thread."""
    folder = tmp_path_factory.mktemp("made") / "whole"
    result, _ = made(folder)
    assert (result.n_plans, result.n_maps, result.n_traced, result.n_failed) == (3, 12, 3, 0)
    return folder


def test_each_map_is_that_of_the_tracer(whole) -> None:
    maps, about = read_plan_file(next(whole.glob("*/*/flat-000001.h5")))
    plan = floorplans.loads(about.plan_text)
    grid = Grid.over(plan.bounds, 2.0, 1.5)
    antenna = Isotropic()
    for index in maps.indices():
        transmitter = Transmitter(
            plan.transmitters[index.transmitter].position,
            20.0,
            maps.frequencies_hz[index.frequency],
            antenna,
        )
        found = compute_radio_map(
            scene_of(plan), transmitter, grid, TraceConfig(1, 0, 1), receive_antenna=antenna
        ).covering(cells_inside(plan, grid))
        stored = maps.layers["rss_dbm"][index]
        assert np.array_equal(stored, found.rss_dbm.astype(np.float32))
        assert np.array_equal(maps.layers["path_count"][index], found.path_count)


def test_a_second_run_does_nothing(whole) -> None:
    before = {path: path.stat().st_mtime_ns for path in whole.rglob("*") if path.is_file()}
    result, told = made(whole)
    assert (result.n_traced, result.n_maps, told) == (0, 12, [f"{whole} is up to date"])
    after = {path: path.stat().st_mtime_ns for path in whole.rglob("*") if path.is_file()}
    assert {p: t for p, t in after.items() if p.name != "lock"} == {
        p: t for p, t in before.items() if p.name != "lock"
    }


def test_threads_do_not_change_a_bit(whole, tmp_path) -> None:
    made(tmp_path / "two", engine=Threads(2))
    assert bits(tmp_path / "two") == bits(whole)


class Ending:
    """An engine that ends after some plans, as if it were interrupted."""

    n = 1

    def __init__(self, after: int) -> None:
        self.after = after

    def run(self, job: Job) -> None:
        """Trace some plans."""
        Threads(1).run(replace(job, sources=job.sources[: self.after]))
        raise KeyboardInterrupt


def test_bits_do_not_depend_on_when_python_drops_objects(whole, tmp_path, monkeypatch) -> None:
    """As where the interpreter is interrupted, and a traceback holds what is being written."""
    file = next(whole.glob("*/*/flat-000001.h5"))
    kept: list[h5py.Dataset] = []
    create = h5py.Group.create_dataset

    def create_and_keep(*arguments, **options):
        kept.append(create(*arguments, **options))
        return kept[-1]

    monkeypatch.setattr(h5py.Group, "create_dataset", create_and_keep)
    assert write_plan_file(*read_plan_file(file), tmp_path / file.name) == file.read_bytes()
    assert kept


@pytest.mark.parametrize("lose_journal", [False, True])
def test_an_interrupted_run_goes_on(whole, tmp_path, lose_journal: bool) -> None:
    folder = tmp_path / "set"
    with pytest.raises(KeyboardInterrupt):
        made(folder, engine=Ending(2))
    assert not (folder / "README.md").exists()
    journal = folder / ".state" / "journal.jsonl"
    if lose_journal:
        journal.unlink()
    else:
        journal.write_bytes(journal.read_bytes()[:-20])
    result, _ = made(folder)
    assert result.n_traced == 1
    assert bits(folder) == bits(whole)
    assert list(problems(folder)) == []


def test_damaged_and_missing_files_are_made_again(whole, tmp_path) -> None:
    folder = tmp_path / "set"
    made(folder)
    first, second, third = sorted(folder.glob("*/*/*.h5"))
    first.write_bytes(first.read_bytes()[:1000])
    second.unlink()
    third.with_suffix(".toml").unlink()
    result, _ = made(folder)
    assert result.n_traced == 3
    assert bits(folder) == bits(whole)


def test_a_plan_that_cannot_be_traced_does_not_stop_the_rest(tmp_path) -> None:
    (tmp_path / "plans").mkdir()
    for seed in range(2):
        plan = floorplans.generate("flat", seed, area_m2=50, n_transmitters=seed)
        (tmp_path / "plans" / f"p{seed}.toml").write_text(
            floorplans.dumps(replace(plan, source=plan.source if seed else None))
        )
    text = edited('kind = "flat"\nseeds = 3\narea_m2 = 50', 'folder = "plans"')
    folder = tmp_path / "set"
    result, told = made(folder, text)
    assert (result.n_failed, result.n_maps) == (1, 2)
    reason = json.loads((folder / "failures.json").read_text())["p0"]
    assert "has neither a source nor transmitters" in reason
    assert any("'p0' could not be traced" in sentence for sentence in told)
    assert list(problems(folder)) == []
    result, told = made(folder, text)
    assert (result.n_traced, told) == (0, [f"{folder} is up to date"])
    assert made(folder, text, retry=True)[0].n_traced == 1


def test_another_spec_needs_force_and_keeps_what_is_the_same(whole, tmp_path) -> None:
    folder = tmp_path / "set"
    made(folder)
    text = edited("seeds = 3", "seeds = 2")
    with pytest.raises(DatasetError, match=r"was made with another spec .* use --force"):
        made(folder, text)
    result, _ = made(folder, text, force=True)
    assert result.n_plans == 2
    assert list(problems(folder)) == []
    alone = tmp_path / "alone"
    made(alone, text)
    assert bits(folder) == bits(alone)


def test_a_folder_of_something_else_or_in_use_is_refused(whole, tmp_path) -> None:
    (tmp_path / "letter.txt").touch()
    with pytest.raises(DatasetError, match=r"holds 'letter\.txt' and is no data set"):
        made(tmp_path)
    with (whole / ".state" / "lock").open("ab") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        with pytest.raises(DatasetError, match="another run is writing into this folder"):
            made(whole)


def test_more_than_the_disk_holds_is_refused_before_any_work(tmp_path, monkeypatch) -> None:
    monkeypatch.setattr("shutil.disk_usage", lambda _: type("Usage", (), {"free": 1000})())
    with pytest.raises(DatasetError, match=r"needs about .* kB, but 1 kB are free"):
        made(tmp_path / "set")
    assert not list(tmp_path.glob("set/*/*/*.h5"))


def test_the_estimate_is_near_what_is_made(whole) -> None:
    cost = estimated(spec_of().plans, spec_of().configuration)
    assert (cost.n_plans, cost.n_maps) == (3, 12)
    files = [path for path in whole.rglob("*") if path.is_file()]
    assert cost.n_inodes == pytest.approx(len(files), abs=6)
    size = sum(path.stat().st_size for path in files)
    assert size / 3 < cost.n_bytes < 3 * size


def test_the_manifest_has_a_row_for_each_map(whole) -> None:
    rows = read_manifest(whole / "manifest.parquet").to_pylist()
    assert len({row["map"] for row in rows}) == len(rows) == 12
    assert {row["frequency_hz"] for row in rows} == {2.4e9, 5.2e9}
    times = read_times(whole)
    assert [row["map"] for row in rows] == times["map"]
    assert min(times["wall_time_s"]) > 0.0


def read_times(folder):
    """Return the columns of the file of wall times."""
    pq = pytest.importorskip("pyarrow.parquet")
    return pq.read_table(folder / "times.parquet").to_pydict()


def test_maps_have_the_strongest_paths_if_they_are_kept(tmp_path) -> None:
    keep = 'layers = ["rss_dbm", "path_count", "strongest_path_dbm"]\nstrongest_paths = 2'
    text = f"{edited('seeds = 3', 'seeds = 1')}\n[keep]\n{keep}\n"
    made(tmp_path / "set", text)
    maps, _ = read_plan_file(next((tmp_path / "set").glob("*/*/*.h5")))
    power, rss = maps.paths["path_power_dbm"], maps.layers["rss_dbm"]
    assert power.shape == (*rss.shape, 2)
    assert (power[..., 0] >= power[..., 1]).all()
    assert np.array_equal(np.isneginf(power[..., 0]), np.isneginf(rss))
    assert np.allclose(power[..., 0], maps.layers["strongest_path_dbm"], atol=1e-3)
    total = 10.0 * np.log10((maps.paths["path_weight"] * 10.0 ** (power / 10.0)).sum(axis=-1))
    few = maps.layers["path_count"] <= 2
    assert np.allclose(total[few & np.isfinite(rss)], rss[few & np.isfinite(rss)], atol=0.01)
    assert (total <= rss + 0.01).all()


def test_an_unforeseen_error_is_one_of_its_plan(tmp_path, monkeypatch) -> None:
    def fails(source, *_):
        raise RuntimeError(f"no {source.name}")

    monkeypatch.setattr("rssnav.datasets.engines.threads.make_plan", fails)
    result, told = made(tmp_path / "set", SPEC)
    assert result.n_failed == 3
    assert any("RuntimeError: no flat-000000" in sentence for sentence in told)
    monkeypatch.undo()
    assert made(tmp_path / "set", SPEC)[0].n_failed == 0


def test_an_interrupt_ends_the_threads(tmp_path) -> None:
    def interrupt(_done: int, _total: int) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        made(tmp_path / "set", progress=interrupt)
    for thread in threading.enumerate():
        if thread.name.startswith("ThreadPoolExecutor"):
            thread.join(10.0)
            assert not thread.is_alive()
