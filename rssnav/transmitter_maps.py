"""Floor plan -> radio maps of several transmitters, kept in one file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from floorplans import FloorPlan
from raytrace import (
    Antenna,
    Grid,
    HalfWaveDipole,
    SceneError,
    TraceConfig,
    Transmitter,
    TransmitterMaps,
    compute_radio_maps,
)
from rssnav.keeping import save_or_rescue
from rssnav.maps import (
    CELL_SIZE_M,
    HEIGHT_M,
    MapRequest,
    Notice,
    check_height,
    check_scene,
    current_content,
)
from rssnav.progress import Progress
from rssnav.scenes import PlanScene, edition_of


@dataclass(frozen=True)
class _Requests:
    """A request for each transmitter, by name."""

    requests: dict[str, MapRequest]

    def difference(self, maps: TransmitterMaps) -> str | None:
        """Return how maps differ from the requested ones, in words; None where they do not."""
        if list(maps) != list(self.requests):
            return "made for other transmitters"
        found = (request.difference(maps[name]) for name, request in self.requests.items())
        return next((words for words in found if words is not None), None)


def make_transmitter_maps(
    plan: FloorPlan,
    transmitters: Mapping[str, Transmitter],
    path: str | Path | None = None,
    *,
    cell_size_m: float = CELL_SIZE_M,
    height_m: float = HEIGHT_M,
    config: TraceConfig | None = None,
    receive_antenna: Antenna | None = None,
    edition: str | None = None,
    scene: PlanScene | None = None,
    threads: int | None = None,
    progress: Progress | None = None,
    notice: Notice | None = None,
    force: bool = False,
    max_memory_bytes: int | None = None,
) -> TransmitterMaps:
    """Return the radio maps of several transmitters: those in a file if they are current.

    Transmitters at one place share paths, see `raytrace.compute_radio_maps`.

    Parameters
    ----------
    plan : FloorPlan
        The building, whose scene is prepared once.
    transmitters : mapping of str to Transmitter
        At least one, by name (`rssnav.transmitters.choose_transmitters`).
    path, cell_size_m, height_m, config, receive_antenna, edition, scene, threads, notice
        As for `rssnav.maps.make_map`.
    progress, force, max_memory_bytes
        As for `rssnav.maps.make_map`; progress is that of all transmitters together.

    Raises
    ------
    ValueError
        For no transmitters, and as `rssnav.maps.make_map`.
    SceneError, MemoryLimitError, MapFileError, OSError
        As `rssnav.maps.make_map`.
    """
    if not transmitters:
        raise ValueError(f"plan {plan.name!r}: no transmitters; expected at least one")
    check_height(plan, height_m)
    edition = edition_of(plan, edition)
    check_scene(plan, scene, edition)
    grid = Grid.over(plan.bounds, cell_size_m, height_m)
    shared = config or TraceConfig(), edition, receive_antenna or HalfWaveDipole()
    wanted = _Requests(
        {name: MapRequest(plan, grid, one, *shared) for name, one in transmitters.items()}
    )
    path = None if path is None else Path(path)
    if path is not None and not force:
        current = current_content(path, TransmitterMaps.load, wanted.difference, notice)
        if current is not None:
            return current
    prepared = scene or PlanScene.of(plan, edition)
    name, first = next(iter(wanted.requests.items()))
    try:
        if notice is not None:  # once for all
            first.announce(prepared.scene, notice, threads, max_memory_bytes, len(transmitters))
    except SceneError as error:
        raise SceneError(f"plan {plan.name!r}: transmitter {name!r}: {error}") from error
    try:
        traced = compute_radio_maps(
            prepared.scene,
            transmitters,
            grid,
            first.config,
            receive_antenna=first.receive_antenna,
            threads=threads,
            progress=progress,
            max_memory_bytes=max_memory_bytes,
        )
    except SceneError as error:
        raise SceneError(f"plan {plan.name!r}: {error}") from error
    found = TransmitterMaps({name: first.finished(one) for name, one in traced.items()})
    if path is not None:
        save_or_rescue(found.save, path)
    return found
