"""The figures show the data: artists are compared with it, not pixels."""

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.collections import FillBetweenPolyCollection
from matplotlib.colors import to_hex
from matplotlib.container import ErrorbarContainer
from small_paper import RUNS, small_data

from rssnav.experiments.paper.data import AGENTS, SHOWN_EPISODES, VISIT_EPISODES
from rssnav.experiments.paper.figures import (
    FIGURES,
    agent_loop,
    convergence_time,
    heat_maps,
    steps_per_episode,
    trajectories,
    visits,
)
from rssnav.experiments.statistics import mean
from rssnav.pictures.style import AGENT_COLOURS, PAGE_IN, png_bytes, save_figure, shade


@pytest.fixture(scope="module")
def figures():
    return {figure.key: figure.draw(small_data()) for figure in FIGURES}


def panels(figure, n):
    """The first n axes, which are the panels; colour bars come after."""
    return figure.axes[:n]


def by_gid(ax, gid):
    (artist,) = (line for line in ax.lines if line.get_gid() == gid)
    return artist


@pytest.mark.parametrize("figure", FIGURES, ids=lambda figure: figure.key)
def test_every_figure_fits_the_page_and_says_what_it_shows(figure, figures):
    assert figures[figure.key].get_figwidth() <= PAGE_IN
    caption = figure.caption(small_data())
    assert len(caption) > 80
    assert caption.endswith(".")


@pytest.mark.parametrize(
    ("key", "n"),
    [("heat_maps", 2), ("trajectories", 4), ("visits", 6), ("steps_per_episode", 2)],
)
def test_panels_have_letters(key, n, figures):
    letters = {ax.get_title(loc="left")[:3] for ax in panels(figures[key], n)}
    assert letters == {f"({letter})" for letter in "abcdef"[:n]}


def test_heat_maps_show_the_maps_to_scale(figures):
    data = small_data()
    for ax, scenario in zip(panels(figures["heat_maps"], 2), data.scenarios.values(), strict=True):
        (image,) = ax.images
        np.testing.assert_array_equal(image.get_array(), scenario.radio_map.rss_dbm)
        assert ax.get_aspect() == 1.0
        assert tuple(image.get_extent()) == tuple(np.array(scenario.plan.bounds)[[0, 2, 1, 3]])
        assert by_gid(ax, "source").get_xydata()[0] == pytest.approx(scenario.plan.source[:2])
        assert by_gid(ax, "start").get_xydata()[0] == pytest.approx(scenario.plan.start)


def test_walls_are_those_at_the_flying_height(figures):
    plan = small_data().scenarios[1].plan
    ax = figures["heat_maps"].axes[0]
    (walls,) = (each for each in ax.collections if each.get_gid() == "walls")
    drawn = np.array(walls.get_segments())
    np.testing.assert_array_equal(drawn, plan.solid_segments(2.0))


def test_a_cell_without_a_path_is_left_blank():
    data = small_data()
    scenario = data.scenarios[1]
    rss_dbm = scenario.radio_map.rss_dbm.copy()
    rss_dbm[0, 0] = -np.inf
    dark = replace(scenario, radio_map=replace(scenario.radio_map, rss_dbm=rss_dbm))
    figure = heat_maps.draw(replace(data, scenarios={**data.scenarios, 1: dark}))
    mask = np.ma.getmaskarray(figure.axes[0].images[0].get_array())
    assert mask[0, 0]
    assert mask.sum() == 1


def test_trajectories_are_those_of_the_median_runs(figures):
    data = small_data()
    by_title = {ax.get_title(loc="left")[4:]: ax for ax in panels(figures["trajectories"], 4)}
    for agent, label in (("rss", "RSS-based"), ("location", "location-based")):
        for scenario in data.scenarios:
            ax = by_title[f"{label}, Scenario {scenario}"]
            result = data.result(scenario, agent, 1)
            lines = [line for line in ax.lines if line.get_gid() == f"flight:{agent}"]
            flown = result.trajectory_m(trajectories.median_run(result))
            np.testing.assert_array_equal(lines[0].get_xydata(), flown)
            assert to_hex(lines[0].get_color()) == AGENT_COLOURS[agent]


def test_the_median_run_is_the_one_in_the_middle_of_those_that_arrive():
    result = small_data().result(1, "rss", 1)
    lengths = np.array([30.0, 10.0, 20.0])
    assert trajectories.median_run(replace(result, path_length_m=lengths)) == 2
    arrived = np.array([True, True, False])
    assert trajectories.median_run(replace(result, path_length_m=lengths, reached=arrived)) == 1
    nowhere = replace(result, reached=np.zeros(RUNS, dtype=bool))
    assert trajectories.median_run(nowhere) is None


def test_a_run_without_arrivals_can_be_drawn():
    data = small_data()
    results = {
        key: replace(result, reached=np.zeros(RUNS, dtype=bool))
        for key, result in data.results.items()
    }
    figure = trajectories.draw(replace(data, results=results))
    assert not _flights(figure)
    assert "Final greedy flight" in trajectories.caption(replace(data, results=results))


def _flights(figure):
    return [
        line for ax in figure.axes for line in ax.lines if str(line.get_gid()).startswith("flight")
    ]


def test_visits_are_means_over_runs_on_one_scale(figures):
    data = small_data()
    shown = panels(figures["visits"], 6)
    scales = {(ax.images[0].norm.vmin, ax.images[0].norm.vmax) for ax in shown}
    assert len(scales) == 1
    for row, episodes in enumerate(VISIT_EPISODES):
        for column, agent in enumerate(("location", "rss")):
            ax = shown[2 * row + column]
            assert f"first {episodes} episodes" in ax.get_title(loc="left")
            image = ax.images[0].get_array()
            expected = data.result(1, agent, 1).visits[row]
            np.testing.assert_array_equal(image.filled(0.0), expected)
            assert scales == {(1.0, max(data.result(1, a, 1).visits.max() for a in AGENTS))}


def test_steps_are_means_with_their_band(figures):
    data = small_data()
    for ax, agent in zip(panels(figures["steps_per_episode"], 2), AGENTS, strict=True):
        bands = [c for c in ax.collections if isinstance(c, FillBetweenPolyCollection)]
        for k, speed in enumerate(data.speeds):
            steps = data.result(1, agent, speed).steps[:, :SHOWN_EPISODES]
            np.testing.assert_allclose(ax.lines[k].get_ydata(), steps.mean(axis=0))
            np.testing.assert_array_equal(ax.lines[k].get_xdata(), np.arange(1, 1001))
            low, high = np.quantile(steps, steps_per_episode.BAND, axis=0)
            (path,) = bands[k].get_paths()
            at_500 = path.vertices[path.vertices[:, 0] == 500.0][:, 1]
            assert set(at_500) == {low[499], high[499]}
        assert ax.get_yscale() == "log"
        colours = [to_hex(line.get_color()) for line in ax.lines]
        assert len(set(colours)) == len(data.speeds)
        assert colours[1] == AGENT_COLOURS[agent]


def test_convergence_shows_means_with_bootstrap_intervals(figures):
    data = small_data()
    shown = panels(figures["convergence_time"], 3)
    for ax, measure in zip(shown, convergence_time.MEASURES, strict=True):
        bars = [each for each in ax.containers if isinstance(each, ErrorbarContainer)]
        drawn = {each.get_label(): each for each in bars}
        assert len(drawn) == 4
        for scenario in data.scenarios:
            for agent, name in (("rss", "RSS-based"), ("location", "location-based")):
                line, _, (whiskers,) = drawn[f"{name}, Scenario {scenario}"]
                assert to_hex(line.get_color()) == AGENT_COLOURS[agent]
                for k, speed in enumerate(data.speeds):
                    estimate = mean(measure.of(data.result(scenario, agent, speed)))
                    assert line.get_xydata()[k] == pytest.approx((speed, estimate.value))
                    ends = whiskers.get_segments()[k][:, 1]
                    assert ends == pytest.approx((estimate.low, estimate.high))


def test_measures_of_time_agree_with_the_result():
    result = small_data().result(2, "rss", 4)
    values = {measure.name: measure.of(result) for measure in convergence_time.MEASURES}
    np.testing.assert_array_equal(values["episodes_to_convergence"], result.converged_episode)
    np.testing.assert_allclose(values["flight_time_h"] * 3600, result.converged_steps)
    np.testing.assert_allclose(values["cpu_time_ms"] / 1000, result.converged_cpu_s)


def test_runs_that_did_not_converge_are_left_out():
    data = small_data()
    results = {
        key: replace(result, converged_episode=np.array([-1, 10, 20]))
        for key, result in data.results.items()
    }
    figure = convergence_time.draw(replace(data, results=results))
    (line, *_), *_ = figure.axes[0].containers
    assert line.get_ydata() == pytest.approx([15.0, 15.0, 15.0])


def test_the_loop_names_state_reward_and_action(figures):
    texts = " ".join(text.get_text() for text in figures["agent_loop"].axes[0].texts)
    for word in ("Agent", "Environment", "state", "reward", "action", "RSS", "1000"):
        assert word in texts
    assert agent_loop.draw().axes


def test_floor_plans_share_one_legend(figures):
    figure = figures["floor_plans"]
    assert all(ax.get_legend() is None for ax in figure.axes)
    (legend,) = figure.legends
    texts = [text.get_text() for text in legend.get_texts()]
    assert texts == ["source (phone)", "start", "concrete", "plasterboard"]


def test_no_text_is_smaller_than_seven_points(figures):
    for key, figure in figures.items():
        for text in figure.findobj(lambda artist: hasattr(artist, "get_fontsize")):
            if text.get_text().strip() and text.get_visible():
                assert text.get_fontsize() >= 7.0, (key, text.get_text())


def test_shades_go_to_white_and_black():
    assert shade("#0072b2", 1.0) == (1.0, 1.0, 1.0)
    assert shade("#0072b2", -1.0) == (0.0, 0.0, 0.0)
    assert to_hex(shade("#0072b2", 0.0)) == "#0072b2"


def test_a_figure_is_written_as_png_and_pdf_the_same_each_time(tmp_path):
    png = save_figure(agent_loop.draw(), tmp_path / "deep" / "loop")
    assert (tmp_path / "deep" / "loop.png").read_bytes() == png
    assert (tmp_path / "deep" / "loop.pdf").read_bytes().startswith(b"%PDF")
    assert png_bytes(agent_loop.draw()) == png


def test_visits_caption_counts_all_visits():
    total = small_data().result(1, "rss", 1).visits[0].sum()
    assert f"RSS-based {total:,.0f}" in visits.caption(small_data())
