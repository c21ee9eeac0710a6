"""Choose two searchers, let them fly, watch both and what one of them believes."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import panel as pn
from numpy.typing import NDArray

from rssnav.explorer.inputs import WIDE, checked_values, flow, number_input, select
from rssnav.explorer.map_search import COLOURS
from rssnav.explorer.searching import BELIEVERS, SEARCHERS, LiveSearch, SearchFlight, SearchSettings
from rssnav.explorer.session import Session
from rssnav.explorer.setting_ranges import SEARCH
from rssnav.explorer.styles import WIDGETS, pairs, problem
from rssnav.explorer.training import suggested_goal_dbm

FRAME_MS = 80
NO_BELIEF, ORDER = "none", ("the first", "the second")

Shown = tuple[tuple[NDArray[np.float64], ...], NDArray[np.float32] | None]
"""Positions of both flights up to a step, and a belief."""


class SearchPanel:
    """Widgets of a search, and its player.

    Parameters
    ----------
    session : Session
    show : callable
        Called with what the map is to show.

    Attributes
    ----------
    view, player : panel.Column
    """

    def __init__(self, session: Session, show: Callable[[Shown], None]) -> None:
        self._session, self._show = session, show
        self._rejected = ""
        self._shown: LiveSearch | None = None
        names = {name: name for name in SEARCHERS}
        self._searchers = [select("Searcher", names), select("Compared with", names)]
        self._searchers[1].value = "Bayesian, plan known"
        for widget in self._searchers:
            widget.width = 2 * WIDE + 10
        usual = SearchSettings(("Frontier", "Frontier"))
        self._inputs = {
            name: number_input(allowed, value=getattr(usual, name))
            for name, allowed in SEARCH.items()
        }
        self._belief = select("Belief of", {NO_BELIEF: -1})
        self._belief.param.watch(self._go, "value")
        self._fly = self._button("Fly", "primary", self._begin)
        self._stop = self._button("Stop", "default", lambda _event: session.stop_search())
        self._facts = pn.pane.HTML("", stylesheets=WIDGETS, sizing_mode="stretch_width")
        self.view = pn.Column(
            flow(*self._searchers),
            flow(*self._inputs.values()),
            pn.Row(self._fly, self._stop),
            self._facts,
            sizing_mode="stretch_width",
        )
        self._player = pn.widgets.Player(
            start=0, end=0, interval=FRAME_MS, show_loop_controls=False, stylesheets=WIDGETS,
            sizing_mode="stretch_width", height=64,
        )  # fmt: skip
        self._player.param.watch(self._go, "value")
        self._text = pn.pane.HTML("", stylesheets=WIDGETS, sizing_mode="stretch_width")
        self.player = pn.Column(
            pn.Row(self._text, self._belief), self._player, visible=False,
            sizing_mode="stretch_width",
        )  # fmt: skip
        self.show()

    def suggest_goal(self) -> None:
        """Set the goal to a level that the newest complete map reaches."""
        traced = self._session.complete_map
        if traced is not None:
            usual_dbm = SearchSettings.goal_rss_dbm
            goal_dbm = suggested_goal_dbm(traced.radio_map, usual_dbm)
            self._inputs["goal_rss_dbm"].value = goal_dbm

    def show(self) -> None:
        """Show the progress of the session's search."""
        search = self._session.search
        running = search is not None and search.running
        self._fly.disabled = running or self._session.complete_map is None
        self._stop.disabled = not running
        trouble = self._rejected or ("" if search is None else search.problem)
        self._facts.object = problem(trouble) if trouble else _facts(search)
        if search is not self._shown:
            self._shown = search
            self._name_beliefs(search)
        if search is not None:
            follows = self._player.value == self._player.end
            self._player.end = search.steps
            if self._player.direction == 0 and follows:
                self._player.value = self._player.end
            self._go(None)

    def show_player(self, wanted: bool) -> bool:
        """Show the player and the flights if wanted and if there are any; return whether."""
        search = self._session.search
        self.player.visible = wanted and search is not None and not search.problem
        if self.player.visible:
            self._go(None)
        return self.player.visible

    def _button(self, name: str, kind: str, act: Callable[[Any], None]) -> Any:
        button = pn.widgets.Button(label=name, button_type=kind, stylesheets=WIDGETS, width=110)
        button.on_click(act)
        return button

    def _name_beliefs(self, search: LiveSearch | None) -> None:
        """Offer the beliefs of both searchers, and choose the first that has one."""
        options = {NO_BELIEF: -1}
        for number, name in enumerate(() if search is None else search.settings.searchers):
            if name in BELIEVERS:
                options[ORDER[number]] = number
        self._belief.options = options
        self._belief.value = min((k for k in options.values() if k >= 0), default=-1)

    def _begin(self, _event: Any) -> None:
        """Start a search with the widgets' values."""
        try:
            values = checked_values(self._inputs, SEARCH)
            names = (self._searchers[0].value, self._searchers[1].value)
            settings = SearchSettings(names, **values)
        except ValueError as error:
            self._rejected = str(error)
            self.show()
            return
        self._rejected = ""
        self._session.begin_search(settings)

    def _go(self, _event: Any) -> None:
        """Show both flights at the player's step."""
        search = self._session.search
        if search is None or not self.player.visible:
            return
        step = min(max(int(self._player.value), 0), search.steps)
        positions = tuple(_until(flight, step) for flight in search.flights)
        if min(map(len, positions)) == 0:
            return
        number = self._belief.value
        belief = search.flights[number].belief(step) if number in (0, 1) else None
        self._show((positions, belief))
        self._text.object = "<br>".join(
            f'<span style="color: {colour}">\u25c6</span> {flight.name}: step '
            f"{min(step, flight.steps)} of {flight.steps}"
            for colour, flight in zip(COLOURS, search.flights, strict=True)
        )


def _until(flight: SearchFlight, step: int) -> NDArray[np.float64]:
    return np.array(flight.position[: step + 1]).reshape(-1, 2)


def _facts(search: LiveSearch | None) -> str:
    if search is None:
        words = "Searchers do not learn. Each flies once from the start until it finds the source."
        return f'<p class="quiet">{words}</p>'
    fewest = "-" if search.shortest_steps is None else str(search.shortest_steps)
    flights = [
        (f.name, f"{f.end or 'flies'}, {f.steps} steps, {f.energy_kj:.2f} kJ")
        for f in search.flights
    ]
    return pairs([*flights, ("fewest possible", f"{fewest} steps")])
