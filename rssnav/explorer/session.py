"""State of one tab of the explorer: a plan, its map, a cell's paths, a training."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np

import floorplans
from floorplans import FloorPlan, PlanError
from floorplans.transmitters import ALL
from raytrace import Grid, RadioMap
from rssnav.explorer.background import FileMaker, NewestOnly, Ticket
from rssnav.explorer.fair_turns import FairTurns, TabTurns
from rssnav.explorer.limits import Limits
from rssnav.explorer.places import with_source_and_start
from rssnav.explorer.survey_layer import CSV, SurveyTracer, example, read_survey_upload
from rssnav.explorer.tracing import (
    LatestScene,
    MapCache,
    MapSettings,
    MapTracer,
    PathFinder,
    TracedMap,
)
from rssnav.explorer.training import LiveTraining, TrainingSettings
from rssnav.explorer.uploads import Upload, read_upload
from rssnav.measurements.survey import Survey
from rssnav.presets import PRESETS, default_preset
from rssnav.transmitters import SOURCE

PLACE_DIGITS = 2
"""A dragged source is rounded to centimetres."""

Point = tuple[float, float]


class Session:
    """State of one tab, independent of the browser.

    Methods that change it are called from one thread only. Long work runs on other threads; its
    results appear in `maps`, `paths` and `training`, or through `take_upload`.

    Parameters
    ----------
    plan : FloorPlan
        The first plan.
    limits : Limits, optional
    cache : MapCache, optional
        Shared with other sessions.
    turns : FairTurns, optional
        Turns of work, shared with other sessions.

    Attributes
    ----------
    plan : FloorPlan
        The plan with its current source and start.
    settings : MapSettings
    maps : MapTracer
    paths : PathFinder
    files : FileMaker
        Makes what is downloaded.
    training : LiveTraining or None
    cell : (int, int) or None
        Indices (i_y, i_x) of the selected cell.
    import_report : tuple of str
        How the open plan was imported, a line each; empty if it was not.
    problem : str
        Why the latest change was rejected; empty if it was not.
    """

    def __init__(
        self,
        plan: FloorPlan,
        limits: Limits | None = None,
        cache: MapCache | None = None,
        turns: FairTurns | None = None,
    ) -> None:
        self.limits = limits or Limits()
        self.settings = MapSettings()
        scenes = LatestScene()
        self._turns = TabTurns(turns or FairTurns(self.limits.jobs))
        self.maps = MapTracer(self.limits, cache or MapCache(), scenes, self._turns)
        self.paths = PathFinder(self.limits, scenes, self._turns)
        self.survey = SurveyTracer(self.limits, scenes, self._turns)
        self.training: LiveTraining | None = None
        self.cell: tuple[int, int] | None = None
        self.problem = ""
        self._reader = NewestOnly("upload", self._turns)
        self.files = FileMaker(self._turns)
        self._uploaded: Upload | Survey | str | None = None
        self.import_report: tuple[str, ...] = ()
        self.open_plan(plan)

    def close(self) -> None:
        """Stop all work of this tab."""
        self.stop_training()
        for part in (self.maps, self.paths, self.survey, self._reader, self.files):
            part.close()

    @property
    def grid(self) -> Grid:
        """Cells of the plan; raises `PlanError` if the settings do not fit it."""
        return self.settings.grid(self.plan)

    def open_plan(self, plan: FloorPlan) -> None:
        """Open another plan, and trace its map.

        Raises
        ------
        PlanError
            For a plan that is too large; the previous one stays open.
        """
        self.limits.check_plan(plan)
        plan = with_source_and_start(plan)
        height_m = self.settings.height_m
        if not height_m < plan.height_m:
            height_m = round(plan.height_m / 2, PLACE_DIGITS)
        settings = replace(_of_preset(self.settings, plan), height_m=height_m)
        self.limits.check_cells(plan, settings.cell_size_m)
        self._drop_training()
        self.maps.forget()
        self.paths.forget()
        self.survey.forget()
        self.cell, self.problem, self.import_report = None, "", ()
        self.plan, self.settings = plan, settings
        self._snap_start()
        self.maps.request(self.plan, self.settings)

    def open_builtin(self, name: str) -> None:
        """Open a built-in plan."""
        self.open_plan(floorplans.load(name))

    def open_example(self) -> None:
        """Open the measured flat with its survey."""
        plan, survey = example()
        self.open_plan(plan)
        self.survey.open(survey, self.plan, self.settings)

    def choose_server(self, name: str) -> None:
        """Trace the map of a transmitter of the plan, of the source, or of the best of all.

        The source moves to the place of a transmitter.
        """
        position = next((t.position for t in self.plan.transmitters if t.id == name), None)
        if position is None:
            self.change_settings(replace(self.settings, server=name))
            return

        def choose() -> None:
            self._replace_plan(replace(self.plan, source=position))
            self._apply(replace(self.settings, server=name))

        self._try(choose)

    def upload(self, name: str, content: bytes) -> None:
        """Start to read an uploaded file; `take_upload` opens the result."""
        self._uploaded = None
        self._reader.submit(partial(self._read, name, content, self.plan))

    def take_upload(self) -> bool:
        """Open an upload that has been read; return whether there was one, rejected or not."""
        found, self._uploaded = self._uploaded, None
        if isinstance(found, Upload):
            self._try(partial(self._open_upload, found))
        elif isinstance(found, Survey):
            self.problem = ""
            self.survey.open(found, self.plan, self.settings)
        elif found is not None:
            self.problem = found
        return found is not None

    def _open_upload(self, upload: Upload) -> None:
        self.open_plan(upload.plan)
        self.import_report = upload.report

    def _read(self, name: str, content: bytes, plan: FloorPlan, ticket: Ticket) -> None:
        try:
            if name.lower().endswith(CSV):
                found = read_survey_upload(name, content, plan, self.limits)
            else:
                found = read_upload(name, content, self.limits, ticket.check)
        except PlanError as error:
            found = str(error)
        ticket.check()
        self._uploaded = found

    def preview_source(self, x: float, y: float) -> None:
        """Trace the reflections of a source that is being dragged, if it can be there."""
        self.maps.preview(self.plan, self.settings, (x, y, self.plan.require_source()[2]))

    def move_source(self, x: float, y: float, z: float | None = None) -> None:
        """Move the source [m], if it can be there, and trace the map."""
        height_m = self.plan.require_source()[2] if z is None else z
        source = (round(x, PLACE_DIGITS), round(y, PLACE_DIGITS), height_m)
        before = self.plan
        self._try(lambda: self._replace_plan(replace(before, source=source)))
        if self.plan.source != before.source:
            self._drop_training()
            self.settings = replace(self.settings, server=SOURCE)
        self.maps.request(self.plan, self.settings)
        self._find_paths()

    def move_start(self, x: float, y: float) -> None:
        """Move the start to the cell centre nearest to a point [m], if it can be there."""
        before = self.plan
        self._try(lambda: self._replace_plan(replace(before, start=_nearest(self.grid, x, y))))
        if self.plan is not before:
            self._drop_training()

    def change_settings(self, settings: MapSettings) -> None:
        """Trace the map with other settings; those that do not fit the plan are rejected."""
        if settings == self.settings:
            self.problem = ""
            return
        self._try(partial(self._apply, settings))

    def _apply(self, settings: MapSettings) -> None:
        self.limits.check_cells(self.plan, settings.cell_size_m)
        settings.check_height(self.plan)
        self._drop_training()
        self.paths.forget()
        self.cell, self.settings = None, settings
        self._snap_start()
        self.maps.request(self.plan, settings)
        self.survey.request(self.plan, settings)

    def choose_cell(self, x: float, y: float) -> None:
        """Select the cell at a point [m] and trace its paths; none outside the building."""
        grid = self.grid
        i_x, i_y = (
            int(np.floor((at - centres[0]) / grid.cell_size_m + 0.5))
            for at, centres in ((x, grid.x), (y, grid.y))
        )
        inside = 0 <= i_x < len(grid.x) and 0 <= i_y < len(grid.y)
        self.cell = (i_y, i_x) if inside else None
        self._find_paths()

    def _find_paths(self) -> None:
        if self.cell is None:
            self.paths.forget()
            return
        grid, (i_y, i_x) = self.grid, self.cell
        receiver = (float(grid.x[i_x]), float(grid.y[i_y]), grid.height_m)
        self.paths.request(self.plan, self._settings_at(self.cell), receiver)

    def _settings_at(self, cell: tuple[int, int]) -> MapSettings:
        """Settings for the paths to a cell: of its best transmitter, where the map is of all."""
        latest = self.maps.latest
        if latest is None or latest.best_server is None or latest.settings != self.settings:
            return self.settings
        best = max(int(latest.best_server[cell]), 0)
        return replace(self.settings, server=latest.servers[best])

    @property
    def complete_map(self) -> TracedMap | None:
        """The complete map of the current plan, labelled with it; None until it is traced.

        A map of the best of all transmitters is none: it has no one transmitter.
        """
        latest = self.maps.latest
        if self.settings.server == ALL:
            return None
        if latest is None or not latest.complete or latest.settings != self.settings:
            return None
        if latest.plan.source != self.plan.source:
            return None
        labelled = latest.radio_map.with_plan(floorplans.dumps(self.plan), self.plan.sha256)
        return replace(latest, plan=self.plan, radio_map=labelled)

    def train(self, settings: TrainingSettings) -> None:
        """Start a training in the complete map, replacing the previous one."""
        traced = self.complete_map
        if traced is None:
            self.problem = "the map is not complete yet; start the training when it is"
            return
        self.stop_training()
        self.problem = ""
        self.training = LiveTraining(traced, settings, self._turns)
        self.training.start()

    def stop_training(self) -> None:
        """Stop the training; its results so far stay."""
        if self.training is not None:
            self.training.stop()

    def _drop_training(self) -> None:
        self.stop_training()
        self.training = None

    def _snap_start(self) -> None:
        """Move the start to a cell centre, if the plan allows it."""
        start = _nearest(self.grid, *self.plan.require_start())
        if start != self.plan.start:
            self._try(lambda: self._replace_plan(replace(self.plan, start=start)))

    def _replace_plan(self, plan: FloorPlan) -> None:
        self.plan = plan

    def _try(self, change: Callable[[], None]) -> None:
        """Apply a change, or set `problem` to why it is rejected."""
        try:
            change()
            self.problem = ""
        except PlanError as error:
            self.problem = str(error)


def _of_preset(settings: MapSettings, plan: FloorPlan) -> MapSettings:
    """Settings for another plan: built-in ones have opaque walls, as the reproduced paper has."""
    is_builtin = plan.name in floorplans.builtin_names()
    is_own = not is_builtin or floorplans.load(plan.name).walls != plan.walls
    preset = default_preset("" if is_own else plan.name)
    if preset == settings.preset:
        return replace(settings, server=SOURCE)
    reflections = PRESETS[preset].config.max_reflections
    return replace(settings, preset=preset, max_reflections=reflections, server=SOURCE)


def suggested_goal_dbm(radio_map: RadioMap, usual_dbm: float) -> float:
    """Goal level [dBm] for a map: the usual one, or one that its strongest cells exceed."""
    covered = radio_map.rss_dbm[np.isfinite(radio_map.rss_dbm)]
    strongest = float(covered.max()) if covered.size else usual_dbm
    return usual_dbm if strongest > usual_dbm else float(np.floor(strongest - 1.0))


def _nearest(grid: Grid, x: float, y: float) -> Point:
    """Cell centre nearest to a point [m]."""
    i_x, i_y = int(np.argmin(np.abs(grid.x - x))), int(np.argmin(np.abs(grid.y - y)))
    return float(grid.x[i_x]), float(grid.y[i_y])
