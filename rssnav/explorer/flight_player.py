"""Replay the flights of a training over the map, episode by episode."""

from collections.abc import Callable
from typing import Any

import numpy as np
import panel as pn
from numpy.typing import NDArray

from rssnav.explorer.styles import WIDGETS
from rssnav.explorer.training import Flight, LiveTraining

FRAMES = 30
"""Maximum number of frames of a flight."""

FRAME_MS = 50
LEARNED_MS = 3000
"""Least duration of the learned flight, which may have few steps."""


class FlightPlayer:
    """Playback controls and a slider of episodes.

    Parameters
    ----------
    show : callable
        Called with a flight and the step up to which it is shown.

    Attributes
    ----------
    view : panel.Column
    """

    def __init__(self, show: Callable[[Flight, int], None]) -> None:
        self._show = show
        self._training: LiveTraining | None = None
        self._first = np.zeros(1, dtype=np.int64)
        self._going = self._slow = False
        self._episode = pn.widgets.DiscreteSlider(
            name="Episode", options={"1": 0}, stylesheets=WIDGETS, sizing_mode="stretch_width"
        )
        self._player = pn.widgets.Player(
            start=0,
            end=0,
            interval=FRAME_MS,
            show_loop_controls=False,
            stylesheets=WIDGETS,
            sizing_mode="stretch_width",
            height=64,
        )
        self._text = pn.pane.HTML("", stylesheets=WIDGETS, sizing_mode="stretch_width")
        self._player.param.watch(self._go, "value")
        self._episode.param.watch(self._jump, "value")
        self._replay = pn.widgets.Button(
            label="Play learned flight", stylesheets=WIDGETS, width=160, visible=False
        )
        self._replay.on_click(self._play_learned)
        self.view = pn.Column(
            pn.Row(self._text, self._replay), self._player, self._episode, visible=False,
            sizing_mode="stretch_width",
        )  # fmt: skip

    def follow(self, training: LiveTraining | None) -> None:
        """Update the flights of a training; show the latest unless earlier ones are being played.

        When it ends, the learned flight is shown, and playing ends.
        """
        flights = [] if training is None else training.flights[:]
        if training is self._training and len(flights) + 1 == self._first.size:
            return
        self._training = training
        self._first = first_frames([flight.steps for flight in flights])
        self._replay.visible = bool(flights) and flights[-1].learned
        if not flights:
            return
        self._episode.options = {_name(flight): index for index, flight in enumerate(flights)}
        self._player.end = int(self._first[-1]) - 1
        if flights[-1].learned:
            self._player.direction = 0
        if self._player.direction == 0:
            self._player.value = self._player.end
            self._go(None)

    def show(self, wanted: bool) -> None:
        """Show the player and its flight if wanted and if there are flights."""
        visible = wanted and self._first.size > 1
        if visible and not self.view.visible:
            self._go(None)
        self.view.visible = visible

    def _go(self, _event: Any) -> None:
        """Show the flight and step of the player's frame."""
        if self._training is None or self._first.size == 1:
            return
        index, fraction = flight_at(self._first, self._player.value)
        flight = self._training.flights[index]
        step = round(fraction * flight.steps)
        if not flight.learned and self._slow:
            self._player.interval, self._slow = FRAME_MS, False
        self._show(flight, step)
        self._text.object = _words(flight, step, self._training.settings.episodes)
        self._going = True
        self._episode.value = index
        self._going = False

    def _play_learned(self, _event: Any) -> None:
        """Play the learned flight, the last one, from its start."""
        frames = int(self._first[-1] - self._first[-2])
        self._player.value = int(self._first[-2])
        self._player.interval = max(FRAME_MS, LEARNED_MS // frames)
        self._player.direction, self._slow = 1, True

    def _jump(self, event: Any) -> None:
        """Jump to the start of an episode's flight."""
        if self._going:
            return
        self._player.value = int(self._first[event.new])


def first_frames(steps: list[int]) -> NDArray[np.int64]:
    """First frame of each flight, and the end of the last, (n + 1,).

    Parameters
    ----------
    steps : list of int
        Steps of each flight; it has a frame for its start and for each step, at most `FRAMES`.
    """
    frames = np.minimum(np.array(steps, dtype=np.int64) + 1, FRAMES)
    return np.concatenate(([0], np.cumsum(frames)))


def flight_at(first: NDArray[np.int64], frame: int) -> tuple[int, float]:
    """Index of the flight that a frame shows, and the fraction of it that is flown."""
    frame = min(max(frame, 0), int(first[-1]) - 1)
    index = int(np.searchsorted(first, frame, side="right")) - 1
    last = int(first[index + 1] - first[index]) - 1
    return index, (frame - int(first[index])) / last if last else 1.0


def _name(flight: Flight) -> str:
    return "learned" if flight.learned else str(flight.episode)


def _words(flight: Flight, step: int, episodes: int) -> str:
    if flight.learned:
        what, end = f"Learned in <b>{episodes}</b> episodes", "goes round in circles"
    else:
        what = f"Episode <b>{flight.episode}</b> of {episodes}"
        end = "ends at the limit of steps"
    if flight.reached:
        end = "reaches the source"
    return f'{what}: step {step} of {flight.steps} <span class="quiet">({end})</span>'
