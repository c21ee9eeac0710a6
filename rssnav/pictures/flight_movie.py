"""A trained UAV's flight as a film: the flight over the map, and its RSS readings.

The flight is the final greedy one of a realisation, with one frame per step (one second of flight).
Pillow writes GIF; MP4 needs ffmpeg.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.animation import FFMpegWriter
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray
from PIL import Image
from scipy.spatial import KDTree

from atomicfiles import atomic_write
from floorplans import FloorPlan
from raytrace import RadioMap
from rssnav.pictures.radio_map import draw_radio_map
from rssnav.pictures.style import (
    AGENT_COLOURS,
    INK,
    OTHER_AGENT,
    PAGE_IN,
    SOURCE,
    agent_colour,
    draw_flight,
    drawing,
)
from rssnav.progress import Progress
from rssnav.result_file import ResultFileError
from rssnav.results import TrainingResult, median_run

SUFFIXES = (".gif", ".mp4")
FRAMES_PER_S = 10
HOLD_S = 1.5
"""Duration of the last frame [s]."""

Frame = NDArray[np.uint8]
Numbers = NDArray[np.int32]

_DPI = 110
_PALE = 0.75
_READINGS_IN, _AROUND_IN = 1.0, 1.25
_HIGHEST_MAP_IN = 4.5
_GIF_COLOURS = 256
_EVEN_SIZES = ["-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2"]  # required by H.264


class MovieError(ValueError):
    """A film cannot be made; the message says what is missing."""


@dataclass(frozen=True, eq=False)
class FinalFlight:
    """The final flight of one realisation.

    Attributes
    ----------
    agent : str
        Name of the agent.
    position : (n + 1, 2) float64
        Positions, the start first [m].
    rss_dbm : (n + 1,) float64
        RSS there [dBm].
    length_m : float
        Length of the flight [m].
    reached : bool
        Whether it ends at the source.
    """

    agent: str
    position: NDArray[np.float64]
    rss_dbm: NDArray[np.float64]
    length_m: float
    reached: bool

    @classmethod
    def of(cls, result: TrainingResult, run: int | None = None) -> FinalFlight:
        """Take a realisation's flight from a training.

        Parameters
        ----------
        result : TrainingResult
        run : int, optional
            Number of the realisation; by default the one whose flight is of median length among
            those that reach the source, or the first where none does.

        Raises
        ------
        MovieError
            When the training has no such realisation.
        """
        index = (median_run(result) or 0) if run is None else _index_of(result, run)
        states = result.trajectories[index]
        return cls(
            agent=result.agent.name,
            position=result.trajectory_m(index),
            rss_dbm=result.world.rss_dbm[states[states >= 0]],
            length_m=float(result.path_length_m[index]),
            reached=bool(result.reached[index]),
        )

    @property
    def label(self) -> str:
        """Text in the legend."""
        end = "" if self.reached else ", does not arrive"
        return f"{self.agent} agent: {self.length_m:.1f} m in {len(self.position) - 1} s{end}"


def _index_of(result: TrainingResult, run: int) -> int:
    found = np.flatnonzero(result.run_ids == run)
    if found.size == 0:
        raise MovieError(
            f"run {run}: the training has runs {result.run_ids[0]} to {result.run_ids[-1]}"
        )
    return int(found[0])


class FlightScene:
    """Frames of one or more flights.

    Map, axes and legend are drawn once, and the flights on a copy of them.
    """

    def __init__(
        self, plan: FloorPlan, radio_map: RadioMap, flights: Sequence[FinalFlight]
    ) -> None:
        self._flights = flights
        self.n_steps = max(len(flight.position) for flight in flights) - 1
        figure, (above, below) = _panels(plan)
        draw_radio_map(plan, radio_map, above).set_alpha(_PALE)
        self._clock = above.set_title(f"{self.n_steps} s")
        self._trails = [draw_flight(above, f.position, f.agent) for f in flights]
        _widen_lower_lines(self._trails)
        self._readings = [_draw_readings(below, flight) for flight in flights]
        self._uavs = [_draw_uav(above, flight) for flight in flights]
        _set_up_readings(below, flights, self.n_steps)
        figure.legend(handles=self._readings, loc="outside lower center")
        self._moving = (self._clock, *self._trails, *self._readings, *self._uavs)
        for artist in self._moving:
            artist.set_animated(True)
        self._canvas = FigureCanvasAgg(figure)
        self._canvas.draw()
        self._background = self._canvas.copy_from_bbox(figure.bbox)

    def frame(self, step: int) -> Frame:
        """Return the frame (height, width, 3) after a step, at most the last step."""
        self._clock.set_text(f"{min(step, self.n_steps)} s")
        parts = zip(self._flights, self._trails, self._readings, self._uavs, strict=True)
        for flight, trail, reading, uav in parts:
            flown = slice(0, step + 1)
            trail.set_data(*flight.position[flown].T)
            rss_dbm = flight.rss_dbm[flown]
            reading.set_data(np.arange(rss_dbm.size), rss_dbm)
            uav.set_data(*flight.position[flown][-1:].T)
        self._canvas.restore_region(self._background)
        for artist in self._moving:
            artist.draw(self._canvas.get_renderer())
        return np.asarray(self._canvas.buffer_rgba())[:, :, :3].copy()


def _widen_lower_lines(trails: Sequence[Line2D]) -> None:
    """Make each line wider than those drawn over it, which may coincide with it."""
    for above, trail in enumerate(reversed(trails)):
        trail.set_linewidth(trail.get_linewidth() * (1.0 + 1.4 * above))
    for trail in trails[1:]:
        trail.set_path_effects([])


def _panels(plan: FloorPlan) -> tuple[Figure, tuple[Axes, Axes]]:
    """Return a figure with a panel for the map above one for the readings."""
    x_min, y_min, x_max, y_max = plan.bounds
    map_in = min((PAGE_IN - 0.6) * (y_max - y_min) / (x_max - x_min), _HIGHEST_MAP_IN)
    height_in = map_in + _READINGS_IN + _AROUND_IN
    figure = Figure((PAGE_IN, height_in), dpi=_DPI, layout="constrained")
    above, below = figure.subplots(2, height_ratios=(map_in, _READINGS_IN))
    return figure, (above, below)


def _draw_readings(ax: Axes, flight: FinalFlight) -> Line2D:
    (line,) = ax.plot(
        flight.rss_dbm, color=agent_colour(flight.agent), label=flight.label, gid="readings"
    )
    return line


def _draw_uav(ax: Axes, flight: FinalFlight) -> Line2D:
    (mark,) = ax.plot(
        *flight.position[:1].T,
        marker="o",
        markersize=6,
        color=agent_colour(flight.agent),
        markeredgecolor="white",
        zorder=6,
        gid=f"uav:{flight.agent}",
    )
    return mark


def _set_up_readings(ax: Axes, flights: Sequence[FinalFlight], n_steps: int) -> None:
    finite = np.concatenate([f.rss_dbm[np.isfinite(f.rss_dbm)] for f in flights])
    ax.set_xlim(0, max(n_steps, 1))
    if finite.size:
        ax.set_ylim(finite.min() - 3.0, finite.max() + 3.0)
    ax.set_xlabel("time [s]")
    ax.set_ylabel("RSS [dBm]")
    ax.grid(visible=True)


def save_flight_movie(
    plan: FloorPlan,
    radio_map: RadioMap,
    results: Sequence[TrainingResult],
    path: str | Path,
    *,
    run: int | None = None,
    frames_per_s: int = FRAMES_PER_S,
    progress: Progress | None = None,
) -> tuple[FinalFlight, ...]:
    """Write the flights of one or more trainings as a film, and return them.

    Parameters
    ----------
    plan : FloorPlan
    radio_map : RadioMap
        The plan's map.
    results : sequence of TrainingResult
        Trainings on this plan, one flight each.
    path : str or Path
        A .gif or .mp4; written atomically.
    run : int, optional
        Number of the realisation; by default the one of median length.
    frames_per_s : int
        Steps shown per second.
    progress : callable, optional
        Called as ``progress(frames_done, frames)``.

    Raises
    ------
    MovieError
        For another suffix, without ffmpeg for an MP4, or when there is no such realisation.
    ResultFileError
        When a training belongs to another plan.
    """
    _check_format(Path(path))
    _check_plan(plan, results)
    flights = tuple(FinalFlight.of(result, run) for result in results)
    with drawing():
        scene = FlightScene(plan, radio_map, flights)
        steps = [*range(scene.n_steps + 1), *[scene.n_steps] * round(HOLD_S * frames_per_s)]
        frames = _counted(map(scene.frame, steps), len(steps), progress)
        with atomic_write(path) as beside:
            _WRITERS[beside.suffix.lower()](beside, frames, frames_per_s)
    return flights


def _counted(frames: Iterable[Frame], total: int, progress: Progress | None) -> Iterator[Frame]:
    """Pass frames on, and report their number."""
    for done, frame in enumerate(frames, 1):
        if progress is not None:
            progress(done, total)
        yield frame


def _write_gif(path: Path, frames: Iterable[Frame], frames_per_s: int) -> None:
    """Write all frames in the palette of the last one, which has all relevant colours."""
    numbered = [_colour_numbers(frame) for frame in frames]
    palette = _palette(numbered[-1])
    nearest = _nearest(palette, numbered)
    images = [Image.fromarray(nearest[numbers]) for numbers in numbered]
    for image in images:
        image.putpalette(palette.tobytes())
    duration_ms = 1000 // frames_per_s
    images[0].save(path, save_all=True, append_images=images[1:], duration=duration_ms, loop=0)


def _colour_numbers(frame: Frame) -> Numbers:
    """Return each pixel's colour as a number (height, width) of three bytes, red highest."""
    red, green, blue = np.moveaxis(frame.astype(np.int32), -1, 0)
    return red << 16 | green << 8 | blue


def _colours(numbers: Numbers) -> Frame:
    """Return the colours (n, 3) of numbers (n,)."""
    return np.stack([numbers >> 16, numbers >> 8 & 255, numbers & 255], axis=-1).astype(np.uint8)


def _palette(numbers: Numbers) -> Frame:
    """Return the 256 colours (256, 3) of a GIF: those with a meaning, then the most frequent."""
    found, counts = np.unique(numbers, return_counts=True)
    meant = [to_rgb(name) for name in (SOURCE, INK, OTHER_AGENT, *AGENT_COLOURS.values())]
    exact = np.rint(255.0 * np.array(meant)).astype(np.uint8)
    return np.concatenate([exact, _colours(found[np.argsort(counts)[::-1]])])[:_GIF_COLOURS]


def _nearest(palette: Frame, frames: Sequence[Numbers]) -> NDArray[np.uint8]:
    """Return the palette index (2**24,) nearest to each colour number in the frames."""
    used = np.zeros(1 << 24, dtype=np.bool_)
    for numbers in frames:
        used[numbers] = True
    found = np.flatnonzero(used).astype(np.int32)
    nearest = np.zeros(1 << 24, dtype=np.uint8)
    nearest[found] = KDTree(palette).query(_colours(found))[1]
    return nearest


def _write_mp4(path: Path, frames: Iterable[Frame], frames_per_s: int) -> None:
    """Encode frames with ffmpeg, through a figure that shows nothing else."""
    first, *others = frames
    height, width = first.shape[:2]
    screen = Figure((width / _DPI, height / _DPI), dpi=_DPI)
    image = screen.figimage(first)
    writer = FFMpegWriter(frames_per_s, extra_args=_EVEN_SIZES)
    with writer.saving(screen, str(path), _DPI):
        for frame in (first, *others):
            image.set_data(frame)
            writer.grab_frame()


def _check_format(path: Path) -> None:
    suffix = path.suffix.lower()
    if suffix not in _WRITERS:
        raise MovieError(f"{path}: the suffix names the format; use one of {', '.join(_WRITERS)}")
    if suffix == ".mp4" and not FFMpegWriter.isAvailable():
        raise MovieError(
            f"{path}: an MP4 needs the program ffmpeg, which is not on the PATH; install it, or "
            f"write {path.with_suffix('.gif').name} instead"
        )


_WRITERS = {".gif": _write_gif, ".mp4": _write_mp4}


def _check_plan(plan: FloorPlan, results: Sequence[TrainingResult]) -> None:
    for result in results:
        if result.world.plan_sha256 != plan.sha256:
            raise ResultFileError(
                f"the training is for a different plan ({result.world.plan_name!r}) than "
                f"{plan.name!r}, or of an earlier version of it; train again"
            )
