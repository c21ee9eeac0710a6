"""Radio maps and paths of a session, traced in worker threads."""

import time
from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from threading import Lock
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from floorplans import FloorPlan
from floorplans.transmitters import ALL
from raytrace import (
    RadioMap,
    Scene,
    Transmitter,
    compute_radio_maps,
    trace_paths,
)
from rssnav.explorer.background import NewestOnly, Ticket
from rssnav.explorer.cell_paths import CellPaths, Position
from rssnav.explorer.fair_turns import TabTurns
from rssnav.explorer.limits import Limits
from rssnav.explorer.map_settings import MapSettings
from rssnav.scenes import PlanScene

T = TypeVar("T")

TRACE_ERRORS = (ValueError, TimeoutError, MemoryError)
"""What a trace may raise; errors of plans and scenes are among the first."""


@dataclass(frozen=True, eq=False)
class TracedMap:
    """A map, and the plan and settings it was traced for.

    Attributes
    ----------
    plan : FloorPlan
        Its source is the transmitter of a complete map; the start may have moved since.
    settings : MapSettings
    radio_map : RadioMap
    complete : bool
        Whether it includes the paths with a diffraction.
    servers : tuple of str
        Names of the transmitters of a map of the best ones; empty for one transmitter.
    best_server : (n_y, n_x) int64 or None
        Index into them in each cell; -1 for none.
    """

    plan: FloorPlan
    settings: MapSettings
    radio_map: RadioMap
    complete: bool
    servers: tuple[str, ...] = ()
    best_server: NDArray[np.int64] | None = None


class MapCache:
    """The latest complete maps, shared by all sessions and never modified.

    Parameters
    ----------
    size : int
        Maximum number of maps.
    """

    def __init__(self, size: int = 16) -> None:
        self._size = size
        self._lock = Lock()
        self._maps: OrderedDict[tuple[str, MapSettings], TracedMap] = OrderedDict()

    def get(self, plan: FloorPlan, settings: MapSettings) -> TracedMap | None:
        """Return the map of a plan; None if it is not in the cache."""
        with self._lock:
            return self._maps.get((plan.sha256, settings))

    def put(self, traced: TracedMap) -> None:
        """Add a map; the oldest is dropped when the cache is full."""
        with self._lock:
            self._maps[traced.plan.sha256, traced.settings] = traced
            while len(self._maps) > self._size:
                self._maps.popitem(last=False)


class LatestScene:
    """The scene of a session's newest building, built when a thread first needs it."""

    def __init__(self) -> None:
        self._lock = Lock()
        self._built: PlanScene | None = None

    def of(self, plan: FloorPlan) -> Scene:
        """Return a plan's scene; another source or start leaves it as it is."""
        with self._lock:
            if self._built is None or not self._built.fits(plan):
                self._built = PlanScene.of(plan)
            return self._built.scene


def end_of_time(ticket: Ticket, seconds: float) -> Callable[[], bool]:
    """Return what ends a trace, within a kernel too, when it is cancelled or takes too long."""
    ends_s = time.monotonic() + seconds

    def stop() -> bool:
        ticket.check()
        if time.monotonic() > ends_s:
            raise TimeoutError(
                f"the trace takes longer than {seconds:g} s: use larger cells or fewer reflections"
            )
        return False

    return stop


def attempted(trace: Callable[[], T]) -> tuple[T | None, str]:
    """Return what a trace gives, or None and why it failed."""
    try:
        return trace(), ""
    except TRACE_ERRORS as error:
        return None, str(error)


class MapTracer:
    """Traces the newest requested map: reflections first, then all paths.

    Attributes
    ----------
    latest : TracedMap or None
        Newest map; an older one stays until then.
    progress : float or None
        Fraction of the work that is done; None when idle.
    problem : str
        Why the newest request failed; empty if it did not.
    """

    def __init__(
        self, limits: Limits, cache: MapCache, scenes: LatestScene, turns: TabTurns
    ) -> None:
        self.latest: TracedMap | None = None
        self.progress: float | None = None
        self.problem = ""
        self._limits = limits
        self._cache = cache
        self._scenes = scenes
        self._thread = NewestOnly("map", turns)

    def request(self, plan: FloorPlan, settings: MapSettings) -> None:
        """Trace a map, replacing the one being traced."""
        self.progress = 0.0
        self._thread.submit(partial(self._trace, plan, settings))

    def preview(self, plan: FloorPlan, settings: MapSettings, source: Position) -> None:
        """Trace the reflections of a dragged source [m], if it can be there."""
        self.progress = 0.0
        self._thread.submit(partial(self._preview, plan, settings, source))

    def forget(self) -> None:
        """Drop the map of a plan that is closed."""
        self._thread.cancel()
        self.latest, self.progress, self.problem = None, None, ""

    def close(self) -> None:
        """End the thread."""
        self._thread.close()

    def _trace(self, plan: FloorPlan, settings: MapSettings, ticket: Ticket) -> None:
        try:
            kept = self._cache.get(plan, settings)
            if kept is None:
                self._finish(self._stage(plan, settings, False, ticket), ticket)
                kept = self._stage(plan, settings, True, ticket)
                self._cache.put(kept)
            self._finish(kept, ticket)
        except TRACE_ERRORS as error:
            ticket.check()
            self.problem = str(error)
        self.progress = None

    def _preview(
        self, plan: FloorPlan, settings: MapSettings, source: Position, ticket: Ticket
    ) -> None:
        try:
            dragged = replace(settings.transmitter(plan), position=source)
            self._finish(self._stage(plan, settings, False, ticket, dragged), ticket)
        except TRACE_ERRORS:
            ticket.check()
        self.progress = None

    def _stage(
        self,
        plan: FloorPlan,
        settings: MapSettings,
        complete: bool,
        ticket: Ticket,
        transmitter: Transmitter | None = None,
    ) -> TracedMap:
        """Trace one map, by default of the plan's source."""
        self._limits.check_cells(plan, settings.cell_size_m)
        several = settings.server == ALL and transmitter is None
        sending = transmitter or settings.transmitter(plan)
        maps = compute_radio_maps(
            self._scenes.of(plan),
            settings.transmitters(plan) if several else {settings.server: sending},
            settings.grid(plan),
            settings.config(complete=complete),
            receive_antenna=settings.receive_antenna.antenna,
            progress=partial(self._show_progress, complete),
            stop=end_of_time(ticket, self._limits.map_s),
            max_memory_bytes=self._limits.trace_bytes,
        )
        if not several:
            return TracedMap(plan, settings, maps.first, complete)
        best = maps.best_server.astype(np.int64)
        return TracedMap(plan, settings, maps.best_server_map, complete, maps.names, best)

    def _show_progress(self, complete: bool, done: int, total: int) -> None:
        self.progress = done / total if complete else 0.0

    def _finish(self, traced: TracedMap, ticket: Ticket) -> None:
        ticket.check()
        self.latest, self.problem = traced, ""


class PathFinder:
    """Traces the paths to the newest requested cell.

    Attributes
    ----------
    latest : CellPaths or None
        Paths to the newest finished cell.
    busy : bool
        Whether a cell is being traced.
    problem : str
        Why the newest request failed; empty if it did not.
    """

    def __init__(self, limits: Limits, scenes: LatestScene, turns: TabTurns) -> None:
        self.latest: CellPaths | None = None
        self.busy = False
        self.problem = ""
        self._limits = limits
        self._scenes = scenes
        self._thread = NewestOnly("paths", turns)

    def request(self, plan: FloorPlan, settings: MapSettings, receiver: Position) -> None:
        """Trace the paths to a receiver [m], replacing the one being traced."""
        self.busy = True
        self._thread.submit(partial(self._trace, plan, settings, receiver))

    def forget(self) -> None:
        """Drop the paths."""
        self._thread.cancel()
        self.latest, self.busy, self.problem = None, False, ""

    def close(self) -> None:
        """End the thread."""
        self._thread.close()

    def _trace(
        self, plan: FloorPlan, settings: MapSettings, receiver: Position, ticket: Ticket
    ) -> None:
        def find() -> CellPaths:
            paths = trace_paths(
                self._scenes.of(plan),
                settings.transmitter(plan),
                np.array([receiver]),
                settings.config(complete=True),
                receive_antenna=settings.receive_antenna.antenna,
                stop=end_of_time(ticket, self._limits.map_s),
                max_memory_bytes=self._limits.trace_bytes,
            )
            return CellPaths(plan, settings, receiver, paths)

        found, problem = attempted(find)
        ticket.check()
        self.latest, self.problem, self.busy = found, problem, False
