"""A cluster gives the same bits as threads, and says so when its scheduler is gone."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from small_datasets import bits, edited, made, spec_of

from rssnav.datasets.engines.cluster import Cluster
from rssnav.datasets.errors import DatasetError

distributed = pytest.importorskip("distributed")
pytestmark = [
    pytest.mark.filterwarnings("ignore::ResourceWarning"),
    pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning"),
]


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    folder = tmp_path_factory.mktemp("made") / "whole"
    made(folder)
    return folder


@pytest.fixture(scope="module")
def scheduler(tmp_path_factory):
    """A cluster of two processes that may be lost."""
    file = tmp_path_factory.mktemp("dask") / "address"
    script = (
        "import sys, time\n"
        "from pathlib import Path\n"
        "from distributed import LocalCluster\n"
        "if __name__ == '__main__':\n"
        "    c = LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None)\n"
        "    Path(sys.argv[1] + '.new').write_text(c.scheduler_address)\n"
        "    Path(sys.argv[1] + '.new').rename(sys.argv[1])\n"
        "    sys.stdin.read()\n"
    )
    started = file.with_name("cluster.py")
    started.write_text(script)
    process = subprocess.Popen(
        [sys.executable, str(started), str(file)], stdin=subprocess.PIPE, stderr=subprocess.DEVNULL
    )
    while not file.exists():
        assert process.poll() is None
        with pytest.raises(subprocess.TimeoutExpired):
            process.wait(0.1)
    yield process, file.read_text()
    process.kill()
    process.communicate()


def test_two_processes_give_the_same_bits(whole, scheduler, tmp_path) -> None:
    engine = Cluster(scheduler=scheduler[1])
    assert engine.n == 2
    result, _ = made(tmp_path / "set", engine=engine)
    assert result.n_traced == 3
    assert bits(tmp_path / "set") == bits(whole)


def test_a_plan_that_fails_on_a_worker_is_one_of_the_failures(scheduler, tmp_path) -> None:
    text = edited("count = 2", 'count = 1\nwhich = ["ap9"]')
    result, told = made(tmp_path / "set", text, engine=Cluster(scheduler=scheduler[1]))
    assert result.n_failed == 3
    assert any("has no transmitter 'ap9'" in sentence for sentence in told)


def test_a_folder_that_workers_do_not_see_is_told(scheduler, tmp_path, monkeypatch) -> None:
    engine = Cluster(scheduler=scheduler[1])
    monkeypatch.setattr("rssnav.datasets.making.claim", lambda *_: None)
    with pytest.raises(DatasetError, match="does not see the data set's folder"):
        made(tmp_path / "set", engine=engine)


def test_a_scheduler_that_is_gone_is_told(whole, scheduler, tmp_path) -> None:
    """The last test: it kills the cluster after the first plan."""
    process, address = scheduler

    def kill(_done: int, _total: int) -> None:
        process.kill()
        process.wait()

    text = edited("seeds = 3", "seeds = 12")
    with pytest.raises(DatasetError, match=rf"scheduler at {address} is gone; finished plans are"):
        made(tmp_path / "set", text, engine=Cluster(scheduler=address), progress=kill)
    assert not (tmp_path / "set" / "README.md").exists()
    assert made(tmp_path / "set", text)[0].n_traced < 12
    with pytest.raises(DatasetError, match=rf"no Dask scheduler answers at '{address}'"):
        Cluster(scheduler=address)


def test_tasks_are_small() -> None:
    """What is sent for a plan is far smaller than a map."""
    pickle = pytest.importorskip("cloudpickle")
    spec = spec_of()
    assert len(pickle.dumps((spec.plans[0], spec.configuration, Path()))) < 3000
