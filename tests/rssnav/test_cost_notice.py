"""A user who asks for a long map is told beforehand; one who asks for a short one is not."""

import re
import time
from dataclasses import replace

import pytest

import floorplans
from raytrace import CostEstimate, Grid, TraceConfig, Transmitter, estimate_cost
from rssnav import cost_notice
from rssnav.maps import make_map
from rssnav.scenes import scene_of


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
    assert ", on the order of 9 minutes and 25 MB of memory; " in words


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
