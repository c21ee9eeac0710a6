"""The page of one tab: map, panels and player, updated ten times a second."""

from typing import Any

import numpy as np
import panel as pn

from rssnav.explorer.cell_panel import CellPanel
from rssnav.explorer.cell_paths import strongest
from rssnav.explorer.downloads import Downloads
from rssnav.explorer.flight_player import FlightPlayer
from rssnav.explorer.help_panel import LEGEND, LEGEND_3D, HelpPanel
from rssnav.explorer.map_figure import MapFigure
from rssnav.explorer.map_panel import MapPanel
from rssnav.explorer.map_search import COLOURS
from rssnav.explorer.plan_panel import PlanPanel
from rssnav.explorer.search_panel import SearchPanel, Shown
from rssnav.explorer.session import Session
from rssnav.explorer.space_flights import FlightLine, SpaceFlights
from rssnav.explorer.space_view import page_3d
from rssnav.explorer.styles import (
    FRAME,
    PAGE,
    PAGE_CSS,
    PAGE_JS,
    TABS,
    WIDGETS,
    map_words,
    plan_words,
    problem,
    progress_bar,
    survey_words,
)
from rssnav.explorer.training import Flight
from rssnav.explorer.training_panel import TrainingPanel
from rssnav.kernel_cache import tracer_cache
from rssnav.pictures.style import AGENT_COLOURS

POLL_MS = 100
PATHS_TAB, TRAINING_TAB, SEARCH_TAB = 1, 2, 3
FLIGHT_TABS = (TRAINING_TAB, SEARCH_TAB)
FLAT_VIEW, SPACE_VIEW = "2D", "3D"


class Changes:
    """Detects what has changed since the last update."""

    def __init__(self) -> None:
        self._seen: dict[str, tuple[object, ...]] = {}

    def of(self, name: str, *values: object) -> bool:
        """Whether any of the values differs from the last ones given under the name."""
        before = self._seen.get(name)
        self._seen[name] = values
        if before is None or len(before) != len(values):
            return True
        return any(a is not b and a != b for a, b in zip(before, values, strict=True))


class Frame:
    """The page's regions, empty until a browser has connected, so that a request costs nothing.

    Attributes
    ----------
    template : panel.Template
    """

    def __init__(self) -> None:
        self._regions = {
            name: pn.Column(sizing_mode="stretch_both" if name == "view" else "stretch_width")
            for name in ("bar", "view", "legend", "status", "player", "tools")
        }
        self.template = pn.Template(PAGE, items=self._regions)
        self.template.add_variable("page_css", PAGE_CSS)
        self.template.add_variable("page_js", PAGE_JS)

    def fill(self, **parts: Any) -> None:
        """Place a part in each region named."""
        for name, part in parts.items():
            self._regions[name][:] = [part]

    def refuse(self, reason: str) -> None:
        """Show why there is no page."""
        self.fill(status=pn.pane.HTML(problem(reason), stylesheets=WIDGETS))


class Page:
    """Shows a session on a page and keeps it up to date.

    Parameters
    ----------
    session : Session
    """

    def __init__(self, session: Session) -> None:
        self._session = session
        self._changes = Changes()
        self._compiles = not tracer_cache().n_compiled
        self._plan_panel, self._map_panel = PlanPanel(session), MapPanel(session)
        self._cell_panel = CellPanel(session)
        self._training_panel = TrainingPanel(session)
        self._search_panel = SearchPanel(session, self._show_searches)
        self._downloads = Downloads(session)
        self._player = FlightPlayer(self._show_flight)
        self._views = pn.widgets.RadioButtonGroup(
            options=[FLAT_VIEW, SPACE_VIEW], value=FLAT_VIEW, stylesheets=WIDGETS, width=130
        )
        self._views.param.watch(self._switch_view, "value")
        self._name, self._status = (
            pn.pane.HTML("", stylesheets=WIDGETS, sizing_mode="stretch_width") for _ in range(2)
        )
        self._canvas = pn.pane.Bokeh(sizing_mode="stretch_both")
        self._space = pn.pane.HTML(
            "", sizing_mode="stretch_both", visible=False, stylesheets=[FRAME]
        )
        self._legend = pn.pane.HTML(LEGEND, stylesheets=WIDGETS, sizing_mode="stretch_width")
        self._space_flights = SpaceFlights()
        setup = pn.Column(self._plan_panel.view, self._map_panel.view, sizing_mode="stretch_width")
        self._tabs = pn.Tabs(
            ("Setup", setup),
            ("Paths", self._cell_panel.view),
            ("Training", self._training_panel.view),
            ("Search", self._search_panel.view),
            ("Files", self._downloads.view),
            ("Help", HelpPanel().view),
            stylesheets=TABS,
            sizing_mode="stretch_width",
        )
        self._tabs.param.watch(self._switch_tab, "active")
        self.refresh()

    def fill(self, frame: Frame) -> None:
        """Place the parts in a frame."""
        frame.fill(
            bar=pn.Row(self._name, self._views, sizing_mode="stretch_width"),
            view=pn.Column(self._canvas, self._space, sizing_mode="stretch_both"),
            legend=self._legend,
            status=self._status,
            player=pn.Column(
                self._player.view, self._search_panel.player, sizing_mode="stretch_width"
            ),
            tools=self._tabs,
        )

    def refresh(self) -> None:
        """Show what has changed in the session."""
        session = self._session
        if session.take_upload():
            self._plan_panel.empty_upload()
        session.resume()
        if self._changes.of("building", session.plan.walls, session.settings.height_m):
            self._new_figure()
        flown = session.training, session.search  # in the plan as it is, not as it was last typed
        if self._changes.of("plan", session.plan, session.settings, session.import_report, *flown):
            self._figure.show_marks(session.plan)
            self._plan_panel.show()
            self._map_panel.show()
            self._name.object = plan_words(session.plan)
        self._show_map()
        self._show_survey()
        self._show_paths()
        self._show_training()
        self._show_search()
        self._show_space()
        self._figure.fade()
        self._status.object = self._status_words()

    def _new_figure(self) -> None:
        """Redraw everything, because the plan or the height of the receivers is another."""
        session = self._session
        self._changes = Changes()
        self._changes.of("building", session.plan.walls, session.settings.height_m)
        self._figure = MapFigure(
            session.plan,
            session.settings.height_m,
            on_move=self._move,
            on_drag=self._drag,
            on_tap=self._tap,
            on_step=self._step,
        )
        self._figure.model.tags += self._space_flights.models
        self._canvas.object = self._figure.model

    def _move(self, which: str, x: float, y: float) -> None:
        """Move a mark to where it was dropped, or back if it cannot be there."""
        session = self._session
        (session.move_source if which == "source" else session.move_start)(x, y)
        self._figure.show_marks(session.plan)

    def _drag(self, which: str, x: float, y: float) -> None:
        if which == "source":
            self._session.preview_source(x, y)

    def _tap(self, x: float, y: float) -> None:
        self._session.choose_cell(x, y)
        if self._session.cell is not None:
            self._tabs.active = PATHS_TAB

    def _step(self, right: int, up: int) -> None:
        """Choose the next cell; with the Enter key, show the paths to it."""
        if (right, up) == (0, 0):
            self._tabs.active = PATHS_TAB
        if self._session.cell is None or (right, up) != (0, 0):
            self._session.step_cell(right, up)

    def _show_map(self) -> None:
        """Show a new map; the last one stays until it is there."""
        latest, complete = self._session.maps.latest, self._session.complete_map is not None
        if latest is not None and self._changes.of("map", latest):
            self._figure.show_map(latest.radio_map, latest)
        if self._changes.of("complete", complete, self._session.plan):
            self._downloads.show()
            if complete and self._changes.of("goal", latest):
                self._training_panel.suggest_goal()
                self._search_panel.suggest_goal()

    def _show_survey(self) -> None:
        session = self._session
        found, server = session.survey.latest, session.settings.server
        if self._changes.of("survey", found, server):
            self._figure.show_survey(found, server)

    def _show_paths(self) -> None:
        session = self._session
        found, finder = session.paths.latest, session.paths
        hidden = self._tabs.active in FLIGHT_TABS
        if not self._changes.of("paths", session.cell, found, finder.busy, finder.problem, hidden):
            return
        centre = None
        if session.cell is not None:
            i_y, i_x = session.cell
            centre = (float(session.grid.x[i_x]), float(session.grid.y[i_y]))
        self._figure.show_cell(centre, session.settings.cell_size_m)
        if found is None or hidden:
            self._figure.show_paths([], np.empty(0))
        else:
            lines = strongest(found)
            self._figure.show_paths(lines, found.power_dbm[: len(lines)])
        self._cell_panel.show()

    def _show_training(self) -> None:
        training, complete = self._session.training, self._session.complete_map is not None
        progress = (0, False) if training is None else (training.steps.size, training.running)
        if training is not None and self._changes.of("settings", training):
            self._training_panel.adopt(training.settings)
        if self._changes.of("training", training, complete, *progress):
            self._training_panel.show()
            self._player.follow(training)
            self._switch_tab(None)

    def _show_flight(self, flight: Flight, step: int) -> None:
        training = self._session.training
        if training is not None:
            agent = training.settings.agent
            self._figure.show_flight(flight.position, step, agent)
            self._space_flights.show([FlightLine(flight.position, step, AGENT_COLOURS[agent])])

    def _show_search(self) -> None:
        search, complete = self._session.search, self._session.complete_map is not None
        progress = (0, False) if search is None else (search.steps, search.running)
        if self._changes.of("search", search, complete, *progress):
            self._search_panel.show()
            self._switch_tab(None)

    def _show_searches(self, shown: Shown) -> None:
        positions, belief = shown
        self._figure.search.show(positions, belief, self._session.grid)
        self._space_flights.show(
            [
                FlightLine(position, len(position) - 1, colour)
                for position, colour in zip(positions, COLOURS, strict=True)
            ],
            belief,
        )

    def _switch_tab(self, _event: Any) -> None:
        """Show flights while the tab of training or search is open, and paths otherwise."""
        if self._tabs.active not in FLIGHT_TABS:
            self._space_flights.show(())
        self._player.show(self._tabs.active == TRAINING_TAB)
        if not self._player.view.visible:
            self._figure.hide_flight()
        if not self._search_panel.show_player(self._tabs.active == SEARCH_TAB):
            self._figure.search.hide()
        self._figure.fade()

    def _switch_view(self, event: Any) -> None:
        """Show the map, or the building in 3D."""
        in_space = event.new == SPACE_VIEW
        self._space.visible, self._canvas.visible = in_space, not in_space
        self._legend.object = LEGEND_3D if in_space else LEGEND
        self._space_flights.set_visible(in_space)
        self._show_space()

    def _show_space(self) -> None:
        """Update the 3D view if it is visible."""
        session, maps = self._session, self._session.maps
        if not self._space.visible or maps.progress is not None:
            return
        found = None if self._tabs.active in FLIGHT_TABS else session.paths.latest
        if self._changes.of("space", session.plan, maps.latest, found):
            self._space.object = page_3d(session.plan, found, maps.latest)

    def _status_words(self) -> str:
        """HTML of the map's progress, or of what is wrong."""
        session, maps = self._session, self._session.maps
        trouble = session.problem or maps.problem or session.survey.problem
        if trouble:
            return problem(trouble)
        if maps.progress is not None:
            if self._compiles and maps.latest is None:
                return progress_bar(None, "Compiling the tracer (first use only)")
            first = maps.latest is None or not maps.progress
            what = "Tracing the reflections" if first else "Adding the diffraction"
            return progress_bar(maps.progress, what)
        if maps.latest is None:
            return ""
        found = session.survey.latest
        return map_words(maps.latest) + ("" if found is None else survey_words(found))
