"""Choose an agent, train it, watch it learn."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import panel as pn
from bokeh.models import ColumnDataSource, Range1d, Span
from bokeh.plotting import figure
from numpy.typing import NDArray

from rssnav.agents import RssAgent
from rssnav.explorer.inputs import MARGIN, WIDE, checked_values, flow, number_input
from rssnav.explorer.map_drawing import style_axes
from rssnav.explorer.session import Session
from rssnav.explorer.setting_ranges import LEARNING, TRAINING
from rssnav.explorer.styles import WIDGETS, pairs, problem
from rssnav.explorer.training import LiveTraining, TrainingSettings, suggested_goal_dbm
from rssnav.learning_parameters import QLearning
from rssnav.pictures.style import AGENT_COLOURS, FAINT

MOST_POINTS = 2000
SMOOTHED = 25
"""Episodes that the curve's line is averaged over."""

PACES = {"no limit": math.inf, "50": 50.0, "5": 5.0}
AGENTS = {"RSS": "rss", "Location": "location"}


class TrainingPanel:
    """Widgets of a training, and its learning curve.

    Parameters
    ----------
    session : Session

    Attributes
    ----------
    view : panel.Column
    """

    def __init__(self, session: Session) -> None:
        self._session = session
        self._rejected = ""
        self._make_inputs()
        self._train = self._button("Train", "primary", self._begin)
        self._stop = self._button("Stop", "default", lambda _event: session.stop_training())
        self._curve = LearningCurve()
        self._facts = pn.pane.HTML("", stylesheets=WIDGETS, sizing_mode="stretch_width")
        self.view = pn.Column(
            pn.Row(self._agent, margin=0),
            flow(*self._inputs.values(), self._pace),
            pn.Card(
                flow(*self._learning.values()),
                header=pn.pane.HTML("Parameters of Q-learning", stylesheets=WIDGETS),
                collapsed=True,
                stylesheets=WIDGETS,
                sizing_mode="stretch_width",
                header_background="#f4f1ea",
            ),
            pn.Row(self._train, self._stop),
            pn.pane.Bokeh(self._curve.model, sizing_mode="stretch_width"),
            self._facts,
            sizing_mode="stretch_width",
        )
        self.show()

    def suggest_goal(self) -> None:
        """Set the goal to a level that the newest complete map reaches."""
        traced = self._session.complete_map
        if traced is not None:
            goal = suggested_goal_dbm(traced.radio_map, RssAgent.terminal_dbm)
            self._inputs["goal_rss_dbm"].value = goal

    def adopt(self, settings: TrainingSettings) -> None:
        """Show the parameters of a training, which a saved session may have brought."""
        self._agent.value = settings.agent
        for name, widget in self._inputs.items():
            widget.value = getattr(settings, name)
        for name, widget in self._learning.items():
            widget.value = getattr(settings.learning, name)

    def show(self) -> None:
        """Show the progress of the session's training."""
        training = self._session.training
        running = training is not None and training.running
        self._train.disabled = running or self._session.complete_map is None
        self._stop.disabled = not running
        self._curve.show(training)
        trouble = self._rejected or (training.problem if training is not None else "")
        self._facts.object = problem(trouble) if trouble else _facts(training)

    def _button(self, name: str, kind: str, act: Callable[[Any], None]) -> Any:
        button = pn.widgets.Button(label=name, button_type=kind, stylesheets=WIDGETS, width=110)
        button.on_click(act)
        return button

    def _make_inputs(self) -> None:
        self._agent = pn.widgets.RadioButtonGroup(
            options=AGENTS, value="rss", stylesheets=WIDGETS, width=220
        )
        usual = TrainingSettings()
        self._inputs = {
            name: number_input(allowed, value=getattr(usual, name))
            for name, allowed in TRAINING.items()
        }
        self._inputs["goal_distance_m"].visible = False
        self._pace = pn.widgets.Select(
            label="Episodes per second", options=PACES, value=math.inf, stylesheets=WIDGETS,
            width=WIDE, margin=MARGIN,
        )  # fmt: skip
        self._learning = {
            name: number_input(allowed, value=getattr(usual.learning, name))
            for name, allowed in LEARNING.items()
        }
        self._agent.param.watch(self._choose_agent, "value")

    def _choose_agent(self, event: Any) -> None:
        for name, agent in (
            ("goal_rss_dbm", "rss"),
            ("tolerance_db", "rss"),
            ("goal_distance_m", "location"),
        ):
            self._inputs[name].visible = event.new == agent

    def _begin(self, _event: Any) -> None:
        """Start a training with the widgets' values."""
        try:
            values, learning = (
                checked_values(*panel)
                for panel in ((self._inputs, TRAINING), (self._learning, LEARNING))
            )
            settings = TrainingSettings(
                self._agent.value, learning=QLearning(**learning), pace=self._pace.value, **values
            )
        except ValueError as error:
            self._rejected = str(error)
            self.show()
            return
        self._rejected = ""
        self._session.train(settings)


class LearningCurve:
    """Steps of each episode, their running mean, and the fewest possible.

    Attributes
    ----------
    model : bokeh.plotting.figure
    """

    def __init__(self) -> None:
        self._episodes, self._range = Range1d(start=0, end=1000), Range1d(start=1, end=1000)
        self.model = figure(
            height=210,
            sizing_mode="stretch_width",
            y_axis_type="log",
            x_range=self._episodes,
            y_range=self._range,
            tools="",
            toolbar_location=None,
            outline_line_color=None,
            x_axis_label="episode",
            y_axis_label="steps",
        )
        self.model.grid.grid_line_color = "#eeeae1"
        for axis in (*self.model.xaxis, *self.model.yaxis):
            axis.update(axis_line_color=None)
        style_axes(self.model)
        self._points = ColumnDataSource({"x": [], "y": []})
        self._mean = ColumnDataSource({"x": [], "y": []})
        self._dots = self.model.scatter("x", "y", source=self._points, size=3, alpha=0.25)
        self._line = self.model.line("x", "y", source=self._mean, line_width=2)
        self._fewest = Span(dimension="width", line_color=FAINT, line_dash="dashed", visible=False)
        self.model.add_layout(self._fewest)

    def show(self, training: LiveTraining | None) -> None:
        """Show a training's episodes so far."""
        steps = np.empty(0, np.int32) if training is None else training.steps
        if training is not None:
            colour = AGENT_COLOURS[training.settings.agent]
            self._dots.glyph.update(fill_color=colour, line_color=None)
            self._line.glyph.update(line_color=colour)
            self._episodes.update(end=training.settings.episodes)
            fewest = training.shortest_steps
            self._fewest.update(location=fewest, visible=fewest is not None)
        if steps.size:
            self._range.update(start=0.7 * int(steps.min()), end=1.4 * int(steps.max()))
        episodes = 1 + np.arange(steps.size)
        chosen = slice(None, None, -(-steps.size // MOST_POINTS) or 1)
        self._points.data = {"x": episodes[chosen], "y": steps[chosen]}
        self._mean.data = {"x": episodes[chosen], "y": running_mean(steps, SMOOTHED)[chosen]}


def running_mean(values: NDArray[np.int32], width: int) -> NDArray[np.float64]:
    """Mean of each value (n,) and up to width - 1 values before it."""
    total = np.concatenate(([0.0], np.cumsum(values, dtype=np.float64)))
    last = np.arange(1, len(total))
    first = np.maximum(last - width, 0)
    return (total[last] - total[first]) / (last - first)


def _facts(training: LiveTraining | None) -> str:
    if training is None:
        return '<p class="quiet">The UAV flies from the start until it finds the source.</p>'
    steps, converged = training.steps, training.converged_episode
    unknown = "not yet" if training.running else "no"
    latest = f"{steps[-1]} steps" if steps.size else "-"
    curve = f"Dots: episodes. Line: mean of {SMOOTHED} episodes. Dashed: fewest possible."
    return f'<p class="quiet">{curve}</p>' + pairs(
        [
            ("episodes", f"{steps.size} of {training.settings.episodes}"),
            ("latest episode", latest),
            ("fewest possible", f"{training.shortest_steps or '-'} steps"),
            ("converged", unknown if converged is None else f"after episode {converged}"),
        ]
    )
