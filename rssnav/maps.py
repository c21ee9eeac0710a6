"""Floor plan -> radio map, kept in a file and computed again only if something has changed."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

import floorplans
from floorplans import FloorPlan
from raytrace import (
    Antenna,
    Grid,
    HalfWaveDipole,
    MapFileError,
    RadioMap,
    Scene,
    SceneError,
    TraceConfig,
    Transmitter,
    compute_radio_map,
)
from raytrace.results.antenna_file import as_stored
from raytrace.results.map_file import is_radio_map
from raytrace.trace import TRACER_VERSION
from rssnav.cost_notice import announcement
from rssnav.keeping import save_or_rescue
from rssnav.progress import Progress
from rssnav.scenes import PlanScene, edition_of, scene_of
from rssnav.transmitters import FREQUENCY_HZ, POWER_DBM

Notice = Callable[[str], None]
Content = TypeVar("Content")

CELL_SIZE_M = 1.0
HEIGHT_M = 2.0


@dataclass(frozen=True)
class MapRequest:
    """Everything that a map depends on.

    Attributes
    ----------
    plan
        Walls and source.
    grid
        Where the receivers are.
    transmitter
        What sends.
    config
        Limits of the trace.
    edition
        Of ITU-R P.2040, for the built-in materials.
    receive_antenna
        The receivers' antenna.
    """

    plan: FloorPlan
    grid: Grid
    transmitter: Transmitter
    config: TraceConfig
    edition: str
    receive_antenna: Antenna

    def difference(self, radio_map: RadioMap) -> str | None:
        """Return how a map differs from the requested one, in words; None where it does not."""
        found = radio_map.provenance
        made_with = {"material_edition": self.edition, "tracer_version": TRACER_VERSION}
        for what, same in (
            ("for a different plan", radio_map.plan_sha256 == self.plan.sha256),
            ("with a different trace configuration", radio_map.config == self.config),
            ("for a different transmitter", _same(radio_map.transmitter, self.transmitter)),
            (
                "for a different receive antenna",
                as_stored(radio_map.receive_antenna) == as_stored(self.receive_antenna),
            ),
            ("on a different grid", radio_map.grid.same_as(self.grid)),
            *(
                (f"with a different {key.replace('_', ' ')}", found.get(key) == value)
                for key, value in made_with.items()
            ),
        ):
            if not same:
                return f"made {what}"
        return None

    def announce(
        self,
        scene: Scene,
        notice: Notice,
        threads: int | None,
        max_memory_bytes: int | None,
        n_transmitters: int = 1,
    ) -> None:
        """Give notice if the map will take long, or those of so many transmitters."""
        words = announcement(
            scene,
            self.transmitter,
            self.grid,
            self.config,
            threads,
            max_memory_bytes,
            n_transmitters,
        )
        if words is not None:
            notice(words)

    def compute(
        self,
        scene: Scene | None = None,
        threads: int | None = None,
        progress: Progress | None = None,
        notice: Notice | None = None,
        max_memory_bytes: int | None = None,
    ) -> RadioMap:
        """Trace the map and store its plan in it; give notice first if it will take long."""
        scene = scene or scene_of(self.plan, self.edition)
        made_with = scene, self.transmitter, self.grid, self.config
        try:
            if notice is not None:
                self.announce(scene, notice, threads, max_memory_bytes)
            radio_map = compute_radio_map(
                *made_with,
                receive_antenna=self.receive_antenna,
                threads=threads,
                progress=progress,
                max_memory_bytes=max_memory_bytes,
            )
        except SceneError as error:
            raise SceneError(f"plan {self.plan.name!r}: {error}") from error
        return self.finished(radio_map)

    def finished(self, radio_map: RadioMap) -> RadioMap:
        """Return a traced map with its plan in it, without values outside the building."""
        inside = cells_inside(self.plan, self.grid)
        return radio_map.covering(inside).with_plan(floorplans.dumps(self.plan), self.plan.sha256)


def cells_inside(plan: FloorPlan, grid: Grid) -> NDArray[np.bool_]:
    """Which cells of a grid have their centre inside the building, and in no column; (n_y, n_x)."""
    return plan.contains(grid.points()[:, :2], grid.height_m).reshape(grid.shape)


def make_map(
    plan: FloorPlan,
    path: str | Path | None = None,
    *,
    cell_size_m: float = CELL_SIZE_M,
    height_m: float = HEIGHT_M,
    config: TraceConfig | None = None,
    power_dbm: float = POWER_DBM,
    frequency_hz: float = FREQUENCY_HZ,
    transmitter: Transmitter | None = None,
    receive_antenna: Antenna | None = None,
    edition: str | None = None,
    scene: PlanScene | None = None,
    threads: int | None = None,
    progress: Progress | None = None,
    notice: Notice | None = None,
    force: bool = False,
    max_memory_bytes: int | None = None,
) -> RadioMap:
    """Return a plan's radio map: the one in a file if it is current, otherwise a new one.

    Parameters
    ----------
    plan : FloorPlan
        Walls and source.
    path : str or Path, optional
        Where the map is kept (HDF5). A new one replaces it whole or not at all.
    cell_size_m : float
        Side of a cell [m].
    height_m : float
        Height of the receivers, between floor and ceiling [m].
    config : TraceConfig, optional
        How many reflections and diffractions; 6 and 1 by default.
    power_dbm : float
        Power fed to the source's antenna [dBm].
    frequency_hz : float
        Carrier frequency [Hz].
    transmitter : Transmitter, optional
        What sends, in place of a vertical dipole at the source with that power and frequency.
    receive_antenna : Antenna, optional
        The receivers' antenna; a vertical dipole by default.
    edition : str, optional
        Of ITU-R P.2040, for the built-in materials; by default the plan's, or the newest.
    scene : PlanScene, optional
        The building's scene, to compute several maps with one; built from the plan by default.
    threads : int, optional
        Number of threads; all processors by default. The map does not depend on it.
    progress : callable, optional
        Called as ``progress(done, total)`` while tracing.
    notice : callable, optional
        Called with a sentence: that the file is current, why the map is computed again, or that
        tracing will take longer than a minute.
    force : bool
        Compute the map again, and replace whatever is at `path`.
    max_memory_bytes : int, optional
        Most memory that tracing may take; by default half of what is free.

    Raises
    ------
    ValueError
        For a number out of range, or the scene of another building.
    MemoryLimitError
        Where tracing needs more memory than it may take.
    SceneError
        Where the tracer cannot work with the plan.
    MapFileError
        Where `path` holds a file that is no radio map, which is left alone unless forced.
    OSError
        Where the map cannot be saved; the message says where it is kept instead, if anywhere.
    """
    check_height(plan, height_m)
    edition = edition_of(plan, edition)
    check_scene(plan, scene, edition)
    request = MapRequest(
        plan,
        Grid.over(plan.bounds, cell_size_m, height_m),
        transmitter or Transmitter(plan.require_source(), power_dbm, frequency_hz),
        config or TraceConfig(),
        edition,
        receive_antenna or HalfWaveDipole(),
    )
    compute = partial(
        request.compute, scene and scene.scene, threads, progress, notice, max_memory_bytes
    )
    if path is None:
        return compute()
    path = Path(path)
    if not force:
        current = current_content(path, RadioMap.load, request.difference, notice)
        if current is not None:
            return current
    radio_map = compute()
    save_or_rescue(radio_map.save, path)
    return radio_map


def check_height(plan: FloorPlan, height_m: float) -> None:
    """Raise ValueError for receivers that are not between floor and ceiling."""
    if not 0.0 < height_m < plan.height_m:
        raise ValueError(
            f"height_m = {height_m:g}: plan {plan.name!r} needs a height between its floor and its "
            f"ceiling, above 0 and below {plan.height_m:g} m"
        )


def check_scene(plan: FloorPlan, scene: PlanScene | None, edition: str) -> None:
    """Raise ValueError for the scene of another building."""
    if scene is not None and not scene.fits(plan, edition):
        raise ValueError(
            f"the scene of plan {scene.plan.name!r}, materials of {scene.scene.material_edition}, "
            f"does not fit plan {plan.name!r}, {edition}: expected PlanScene.of(plan, edition)"
        )


def require_map_for(plan: FloorPlan, radio_map: RadioMap, path: str | Path | None = None) -> None:
    """Refuse the map of another plan.

    Parameters
    ----------
    plan, radio_map
        What must belong together.
    path
        The map's file, for the message.

    Raises
    ------
    MapFileError
        Where they do not.
    """
    if radio_map.plan_sha256 == plan.sha256:
        return
    where = f"{path}: " if path is not None else ""
    raise MapFileError(
        f"{where}the map was made for a different plan: plan_sha256 = "
        f"{radio_map.plan_sha256[:12] or 'none'}, but plan {plan.name!r} has {plan.sha256[:12]}; "
        "compute it again, or give the plan it was made for",
        None if path is None else Path(path),
        remedy="make_map",
    )


def current_content(
    path: Path,
    load: Callable[[Path], Content],
    difference: Callable[[Content], str | None],
    notice: Notice | None,
) -> Content | None:
    """Return what a file holds if it is what is wanted, None if it must be computed.

    Parameters
    ----------
    path
        The file.
    load
        Reads it.
    difference
        Says how its content differs from what is wanted.
    notice
        Called with a sentence about the file.

    Raises
    ------
    MapFileError
        For a file that is no radio map.
    """
    report = notice or _drop_notice
    if not path.exists():
        return None
    try:
        content = load(path)
    except MapFileError as error:
        if not is_radio_map(path):
            raise MapFileError(
                f"{path}: exists but is not a radio map; not overwritten: give a different "
                "path, or force=True to replace it",
                path,
                remedy="replace_file",
            ) from error
        report(f"{path} is damaged or of a different version; recomputing it")
        return None
    found = difference(content)
    if found is None:
        report(f"{path} is up to date")
        return content
    report(f"{path} was {found}; recomputing it")
    return None


def _drop_notice(_sentence: str) -> None:
    """Drop a notice."""


def _same(found: Transmitter, wanted: Transmitter) -> bool:
    """Whether a transmitter is the wanted one, as a file would give that one back."""
    return replace(found, antenna=as_stored(found.antenna)) == replace(
        wanted, antenna=as_stored(wanted.antenna)
    )
