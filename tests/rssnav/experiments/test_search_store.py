"""Searches are kept: the same one is not flown twice, and any other one is."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
import small_worlds

from rssnav import Fluctuation
from rssnav.experiments.search_store import SearchFigures, SearchRequest, fly_or_reuse
from rssnav.experiments.training_store import TrainingStore
from rssnav.searchers import ParticleFilter, RandomWalk, RssAscent, search


@pytest.fixture(scope="module")
def request_() -> SearchRequest:
    world = small_worlds.world_of(small_worlds.room_plan())
    return SearchRequest(world, RssAscent(), Fluctuation(sigma_db=2.0), runs=3, seed=5)


@pytest.fixture
def flown(monkeypatch) -> list[SearchRequest]:
    """The searches that are flown."""
    known, fly = list[SearchRequest](), SearchRequest.fly

    def counted(request: SearchRequest, threads: int | None) -> SearchFigures:
        known.append(request)
        return fly(request, threads)

    monkeypatch.setattr(SearchRequest, "fly", counted)
    return known


def store(folder, notices: list[str], *, resume: bool = True) -> TrainingStore:
    return TrainingStore(folder / "training", 1, resume, notices.append)


def same(one: object, other: object) -> bool:
    names = [field.name for field in dataclasses.fields(SearchFigures)]
    return all(np.array_equal(getattr(one, name), getattr(other, name)) for name in names)


def test_a_search_is_flown_once(request_, flown, tmp_path) -> None:
    notices: list[str] = []
    first = fly_or_reuse(request_, store(tmp_path, notices))
    again = fly_or_reuse(request_, store(tmp_path, notices))
    assert len(flown) == 1
    assert same(first, again)
    expected = search(
        request_.world, request_.searcher, runs=3, seed=5, fluctuation=request_.fluctuation
    )
    assert same(first, expected)
    fly_or_reuse(request_, store(tmp_path, notices, resume=False))
    assert len(flown) == 2
    assert notices == []


@pytest.mark.parametrize(
    "change",
    [
        {"seed": 6}, {"runs": 2}, {"searcher": RssAscent(escape_steps=29)},
        {"fluctuation": Fluctuation(sigma_db=2.0, correlation=0.5)},
    ],
)  # fmt: skip
def test_another_search_is_flown_again_and_told(request_, flown, tmp_path, change) -> None:
    notices: list[str] = []
    fly_or_reuse(request_, store(tmp_path, notices))
    other = dataclasses.replace(request_, **change)
    found = fly_or_reuse(other, store(tmp_path, notices))
    assert flown == [request_, other]
    assert same(found, other.fly(1))
    assert len(notices) == 1
    assert "other parameters" in notices[0]


def test_a_search_in_another_map_is_another_one(request_) -> None:
    world = request_.world
    rss_dbm = world.rss_dbm.copy()
    rss_dbm[0] = np.nextafter(rss_dbm[0], 0.0)
    changed = dataclasses.replace(world, rss_dbm=rss_dbm)
    assert request_.key() != dataclasses.replace(request_, world=changed).key()


def test_each_search_has_a_file_of_its_own(request_, tmp_path) -> None:
    keeping = store(tmp_path, [])
    for searcher in (RandomWalk(), RssAscent(), RssAscent(readings=8), ParticleFilter(particles=9)):
        for fluctuation in (Fluctuation(), Fluctuation(sigma_db=2.0)):
            one = dataclasses.replace(request_, searcher=searcher, fluctuation=fluctuation, runs=1)
            fly_or_reuse(one, keeping)
    assert len(list(keeping.folder.iterdir())) == 8


@pytest.mark.parametrize("at", [0, 100, -40, -1])
def test_a_damaged_file_is_told_and_replaced(request_, flown, tmp_path, at) -> None:
    notices: list[str] = []
    expected = fly_or_reuse(request_, store(tmp_path, notices))
    (path,) = (tmp_path / "training").iterdir()
    content = bytearray(path.read_bytes())
    content[at] ^= 0x55
    path.write_bytes(content)
    assert same(fly_or_reuse(request_, store(tmp_path, notices)), expected)
    assert len(flown) == 2
    assert "cannot be used" in notices[0]
    assert same(fly_or_reuse(request_, store(tmp_path, notices)), expected)
    assert len(flown) == 2
