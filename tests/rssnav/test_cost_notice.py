"""A user who asks for a long map is told beforehand; one who asks for a short one is not."""

import re
import time
from dataclasses import replace

import numpy as np
import pytest

import floorplans
from raytrace import CostEstimate, Grid, SceneError, TraceConfig, Transmitter, estimate_cost
from rssnav import cost_notice
from rssnav.maps import make_map
from rssnav.scenes import scene_of
from rssnav.transmitter_maps import make_transmitter_maps


def test_a_quick_map_is_not_announced() -> None:
    heard: list[str] = []
    make_map(floorplans.load("flat"), config=TraceConfig(1, 0), notice=heard.append)
    assert heard == []


def test_a_long_map_is_announced_before_it_is_traced(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cost_notice, "LONG_S", 0.0)
    monkeypatch.setattr(cost_notice, "MAX_SILENT_WORK", 0.0)
    heard: list[str] = []
    progress: list[int] = []

    def notice(words: str) -> None:
        assert not progress
        heard.append(words)

    make_map(
        floorplans.load("flat"),
        config=TraceConfig(2, 1),
        notice=notice,
        progress=lambda done, _total: progress.append(done),
    )
    assert len(heard) == 1
    assert heard[0].startswith("estimate: ")
    assert "108 cells" in heard[0]
    assert progress


def test_an_estimate_in_words() -> None:
    grid = Grid.over((0.0, 0.0, 150.0, 100.0), 0.5, 1.5)
    words = cost_notice.sentence(CostEstimate(123_456_789, 250.0, 1_234_567_890), grid)
    assert words.startswith(
        "estimate: 123 million paths to 60 000 cells, about 4 minutes and 1.2 GB of memory; "
    )
    assert "9 000 000 paths" in cost_notice.sentence(CostEstimate(9_000_000, 70.0, 10), grid)


def test_the_paper_s_maps_are_not_worth_an_estimate() -> None:
    for name in ("scenario1", "scenario2"):
        plan = floorplans.load(name)
        grid = Grid.over(plan.bounds, 1.0, 2.0)
        words = cost_notice.announcement(
            scene_of(plan), Transmitter(plan.source), grid, TraceConfig()
        )
        assert words is None


def test_a_notice_says_what_would_be_affordable() -> None:
    grid = Grid.over((0.0, 0.0, 150.0, 100.0), 0.5, 1.5)
    seconds = (1.0, 20.0, 59.0, 200.0)
    cost = CostEstimate(10**9, 530.0, 10, True, seconds_for_beams=10.0)
    known = replace(cost, seconds_of_lower_orders=seconds)
    ends = "a minute or less with --reflections 2 or --cell-size 1.7"
    assert cost_notice.sentence(known, grid).endswith(ends)
    assert cost_notice.sentence(cost, grid).endswith("a minute or less with --cell-size 1.7")
    hopeless = replace(cost, seconds_for_beams=100.0)
    assert cost_notice.sentence(hopeless, grid).endswith("reduce them")


def test_extrapolated_numbers_are_said_to_be_rough() -> None:
    grid = Grid.over((0.0, 0.0, 150.0, 100.0), 0.5, 1.5)
    words = cost_notice.sentence(CostEstimate(10**9, 530.0, 25_000_000, True), grid)
    assert (
        ", on the order of 9 minutes and 25 MB of memory "
        "(extrapolated from fewer reflections: may be far off); "
    ) in words


def test_a_rough_estimate_is_announced_even_where_it_is_short(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    plan = floorplans.load("scenario2")
    scene, grid = scene_of(plan), Grid.over(plan.bounds, 1.0, 2.0)
    for is_extrapolated in (False, True):
        cost = CostEstimate(1000, 3.0, 10_000_000, is_extrapolated)
        monkeypatch.setattr(cost_notice, "estimate_cost", lambda *_, cost=cost, **__: cost)
        words = cost_notice.announcement(
            scene, Transmitter(plan.source), grid, TraceConfig(20, 1, 20)
        )
        assert (words is not None) == is_extrapolated


def test_several_transmitters_are_announced_once_for_all(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cost_notice, "MAX_SILENT_WORK", 0.0)
    monkeypatch.setattr(cost_notice, "estimate_cost", lambda *_, **__: CostEstimate(1000, 50.0, 10))
    plan, heard = floorplans.load("flat"), list[str]()
    sending = {name: Transmitter((x, 4.7, 2.4)) for name, x in (("a", 6.0), ("b", 5.0), ("c", 4.0))}
    make_transmitter_maps(plan, sending, config=TraceConfig(0, 0), notice=heard.append)
    (words,) = heard
    assert words.startswith("estimate: 3 000 paths to 108 cells from 3 transmitters, about 2 min")


def test_what_cannot_be_estimated_is_told_of_its_transmitter(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(cost_notice, "MAX_SILENT_WORK", 0.0)
    plan, outside = floorplans.load("flat"), {"a": Transmitter((-5.0, 4.7, 2.4))}
    with pytest.raises(SceneError, match=r"plan 'flat': transmitter 'a': .* is not inside"):
        make_transmitter_maps(plan, outside, config=TraceConfig(0, 0), notice=lambda _: None)


def test_a_survey_is_estimated_like_a_grid_in_its_place(monkeypatch: pytest.MonkeyPatch) -> None:
    grids: list[Grid] = []

    def estimate(_scene: object, _transmitter: object, grid: Grid, *_: object, **__: object):
        grids.append(grid)
        return CostEstimate(1000, 6.0, 10)

    monkeypatch.setattr(cost_notice, "estimate_cost", estimate)
    monkeypatch.setattr(cost_notice, "MAX_SILENT_WORK", 0.0)
    points = np.random.default_rng(1).uniform((1.0, 2.0, 1.0), (5.0, 4.0, 1.4), (150, 3))
    made_with = scene_of(floorplans.load("flat")), Transmitter((6.0, 4.7, 2.4)), points
    assert cost_notice.points_announcement(*made_with, TraceConfig(2, 1)) is None
    words = cost_notice.points_announcement(*made_with, TraceConfig(2, 1), n_transmitters=3)
    assert words is not None
    assert "3 000 paths from 3 transmitters, about 18 seconds" in words
    (grid, _) = grids
    assert grid.shape == (13, 13)
    assert (grid.x[0], grid.x[-1]) == (points[:, 0].min(), points[:, 0].max())


@pytest.mark.parametrize("reflections", [6, 20])
def test_paths_that_take_long_are_announced(reflections: int) -> None:
    plan = floorplans.load("scenario2")
    x, y = plan.require_start()
    words = cost_notice.paths_announcement(
        scene_of(plan), Transmitter(plan.source), (x, y, 2.0), TraceConfig(reflections, 1)
    )
    if reflections == 6:
        assert words is None
        return
    assert words is not None
    assert re.match("estimate: .* paths, on the order of ", words)
    assert "of memory" in words
    assert "fewer reflections" in words


@pytest.mark.parametrize(("reflections", "transmissions"), [(20, 0), (6, 20), (20, 20)])
def test_absurd_requests_are_estimated_soon(reflections: int, transmissions: int) -> None:
    plan = floorplans.load("scenario2")
    scene, grid = scene_of(plan), Grid.over(plan.bounds, 1.0, 2.0)
    config = TraceConfig(reflections, 1, transmissions)
    assert cost_notice.work(scene, grid, config) > cost_notice.MAX_SILENT_WORK
    began = time.process_time()
    cost = estimate_cost(scene, Transmitter(plan.source), grid, config)
    assert time.process_time() - began < 2.0  # about a second
    assert cost.is_extrapolated
    assert len(cost.seconds_of_lower_orders) in (0, reflections)
