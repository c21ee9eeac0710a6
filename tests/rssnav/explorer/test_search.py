"""Two searchers in the explorer: their flights, beliefs and limits."""

import time
from collections.abc import Iterator

import numpy as np
import pytest

import floorplans
from raytrace import TraceConfig
from rssnav.explorer.map_drawing import empty_figure
from rssnav.explorer.map_figure import FADED, HIDDEN, PLAIN, MapFigure
from rssnav.explorer.map_search import SearchOverlay
from rssnav.explorer.map_settings import MapSettings
from rssnav.explorer.search_panel import SearchPanel
from rssnav.explorer.searching import (
    BELIEVERS,
    MAX_STEPS,
    SEARCHERS,
    LiveSearch,
    SearchSettings,
    power_at_1m_dbm,
)
from rssnav.explorer.session import Session
from rssnav.explorer.tracing import MapCache, TracedMap
from rssnav.maps import make_map
from rssnav.missions import RandomPolicy
from rssnav.missions.energy import MultirotorEnergy

pytestmark = pytest.mark.filterwarnings("ignore::PendingDeprecationWarning")  # of Panel

GOAL_DBM = -30.0
FLAT = floorplans.load("flat")


@pytest.fixture(scope="module")
def traced() -> TracedMap:
    radio_map = make_map(FLAT, config=TraceConfig(1, 1))
    return TracedMap(FLAT, MapSettings(), radio_map, True)


def flown(traced: TracedMap, settings: SearchSettings) -> LiveSearch:
    search = LiveSearch(traced, settings)
    search.start()
    search.join(60.0)
    assert not search.running
    return search


@pytest.mark.parametrize("name", SEARCHERS)
def test_a_flight_goes_from_cell_to_cell_until_the_goal(traced: TracedMap, name: str) -> None:
    search = flown(traced, SearchSettings((name, name), GOAL_DBM))
    assert search.problem == ""
    for flight in search.flights:
        position = np.array(flight.position)
        assert tuple(position[0]) == FLAT.start
        assert np.abs(np.diff(position, axis=0)).max() <= traced.radio_map.grid.cell_size_m
        grid = traced.radio_map.grid
        x, y = position[-1]
        i_y, i_x = np.searchsorted(grid.y, y), np.searchsorted(grid.x, x)
        assert traced.radio_map.rss_dbm[i_y, i_x] > GOAL_DBM
        assert flight.end == "found"
        assert flight.steps >= search.shortest_steps
        assert bool(flight.beliefs) == (name in BELIEVERS)


def test_the_same_seed_gives_the_same_flights(traced: TracedMap) -> None:
    settings = SearchSettings(
        ("Random walk", "Bayesian, plan unknown"), GOAL_DBM, sigma_db=2.0, confirmations=3, seed=5
    )
    one, other = (flown(traced, settings) for _ in range(2))
    for a, b in zip(one.flights, other.flights, strict=True):
        np.testing.assert_array_equal(a.position, b.position)


def test_beliefs_are_probabilities_of_where_the_source_may_be(traced: TracedMap) -> None:
    search = flown(traced, SearchSettings(BELIEVERS, GOAL_DBM))
    for flight in search.flights:
        assert len(flight.beliefs) == flight.steps
        for step in range(flight.steps):
            belief = flight.belief(step)
            assert belief.shape == traced.radio_map.rss_dbm.shape
            assert belief.min() >= 0.0
            assert belief.sum() == pytest.approx(1.0, abs=1e-4)


def test_a_flight_ends_after_its_steps(traced: TracedMap) -> None:
    search = flown(traced, SearchSettings(("Random walk", "Frontier"), GOAL_DBM, max_steps=3))
    assert [flight.end for flight in search.flights] == ["time is over"] * 2
    assert search.steps == 3


def test_a_flight_ends_when_its_battery_is_empty(traced: TracedMap) -> None:
    settings = SearchSettings(("Random walk", "Frontier"), GOAL_DBM, battery_kj=0.5)
    search, largest_j = flown(traced, settings), MultirotorEnergy().step_j(np.full(8, 2.0)).max()
    for flight in search.flights:
        assert flight.end == "battery is empty"
        assert 0.5 <= flight.energy_kj < 0.5 + largest_j / 1000.0


@pytest.mark.parametrize("seconds", [0.0, 0.2])
def test_a_search_that_is_stopped_ends(
    traced: TracedMap, monkeypatch: pytest.MonkeyPatch, seconds: float
) -> None:
    """Before it begins, and in flight."""
    slow = RandomPolicy()
    act = slow.act
    monkeypatch.setattr(slow, "act", lambda *seen: (time.sleep(0.02), act(*seen))[1])
    monkeypatch.setitem(SEARCHERS, "Random walk", lambda _layout, _map: slow)
    settings = SearchSettings(("Random walk", "Random walk"), -25.0, max_steps=MAX_STEPS)
    search = LiveSearch(traced, settings)
    if not seconds:
        search.stop()
    search.start()
    time.sleep(seconds)
    search.stop()
    search.join(60.0)
    assert not search.running
    assert [flight.end for flight in search.flights] == ["stopped"] * 2
    assert (search.steps > 0) == (seconds > 0.0)


def test_a_goal_that_no_cell_reaches_is_told(traced: TracedMap) -> None:
    search = flown(traced, SearchSettings(("Frontier", "Frontier"), goal_rss_dbm=90.0))
    assert "no cell has an RSS above 90 dBm" in search.problem


def test_gaussian_processes_of_too_many_cells_are_refused(
    traced: TracedMap, monkeypatch: pytest.MonkeyPatch
) -> None:
    its_module: dict = SEARCHERS["Gaussian process"].__globals__
    monkeypatch.setitem(its_module, "MOST_GAUSSIAN_CELLS", 50)
    search = flown(traced, SearchSettings(("Gaussian process", "Frontier"), GOAL_DBM))
    assert "the map has 108 cells" in search.problem


@pytest.mark.parametrize(
    "changes",
    [{"searchers": ("Frontier", "Oracle")}, {"max_steps": 0}, {"max_steps": MAX_STEPS + 1}],
)
def test_settings_are_checked(changes: dict) -> None:
    with pytest.raises(ValueError, match="must be"):
        SearchSettings(**{"searchers": ("Frontier", "Frontier"), **changes})


def test_the_level_at_a_metre_is_that_of_free_space(traced: TracedMap) -> None:
    """25 dBm less 40.05 dB at 2.4 GHz."""
    assert power_at_1m_dbm(traced.radio_map) == pytest.approx(-15.05, abs=0.01)


def test_what_is_hidden_leaves_nothing_on_the_map(traced: TracedMap) -> None:
    overlay = SearchOverlay(empty_figure())
    overlay.draw_flights()
    grid = traced.radio_map.grid
    line = np.array([[0.5, 0.5], [1.5, 0.5]])
    overlay.show((line, line), np.full((9, 12), 1 / 108, dtype=np.float32), grid)
    sources = [r.data_source for r in overlay._model.renderers]
    assert all(any(len(column) for column in source.data.values()) for source in sources)
    overlay.hide()
    assert not any(len(column) for source in sources for column in source.data.values())


def test_the_map_is_hidden_under_a_belief_only(traced: TracedMap) -> None:
    figure = MapFigure(FLAT, 2.0, on_move=print, on_drag=print, on_tap=print, on_step=print)
    grid, line = traced.radio_map.grid, np.array([[0.5, 0.5], [1.5, 0.5]])
    belief = np.full((9, 12), 1 / 108, dtype=np.float32)
    alphas = []
    for change in (
        lambda: figure.show_paths([line], np.zeros(1)),
        lambda: figure.search.show((line, line), belief, grid),
        lambda: figure.show_paths([], np.empty(0)),
        lambda: figure.search.show((line, line), None, grid),
        lambda: figure.search.show((line, line), belief, grid),
        figure.search.hide,
    ):
        change()
        figure.fade()
        alphas.append(figure._picture.glyph.global_alpha)
    assert alphas == [FADED, HIDDEN, HIDDEN, PLAIN, HIDDEN, PLAIN]


@pytest.fixture
def session() -> Iterator[Session]:
    opened = Session(FLAT, cache=MapCache())
    opened.change_settings(MapSettings(cell_size_m=1.5, max_reflections=1))
    ends_s = time.monotonic() + 60.0
    while opened.complete_map is None:
        assert opened.maps.problem == ""
        assert time.monotonic() < ends_s
        time.sleep(0.005)
    yield opened
    opened.close()


def test_the_panel_flies_and_shows_steps(session: Session) -> None:
    shown = []
    panel = SearchPanel(session, shown.append)
    panel.suggest_goal()
    panel._fly.clicks += 1
    session.search.join(60.0)
    panel.show_player(True)
    panel.show()
    positions, belief = shown[-1]
    assert len(positions[0]) == session.search.flights[0].steps + 1
    assert belief is not None
    panel._player.value = 0
    assert [len(position) for position in shown[-1][0]] == [1, 1]


def test_a_value_out_of_range_is_refused(session: Session) -> None:
    panel = SearchPanel(session, lambda _shown: None)
    panel._inputs["sigma_db"].param.update(end=None, value=1e9)
    panel._fly.clicks += 1
    assert session.search is None
    assert "must be 0 to 20" in panel._facts.object


def test_moving_the_source_ends_the_search(session: Session) -> None:
    session.begin_search(SearchSettings(("Frontier", "Frontier"), GOAL_DBM))
    search = session.search
    session.move_source(2.0, 2.0)
    search.join(60.0)
    assert session.search is None
