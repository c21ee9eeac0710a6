"""State of one tab of the explorer: a plan, its map, a cell's paths, a training."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import floorplans
from floorplans import FloorPlan, PlanError
from floorplans.transmitters import ALL
from raytrace import Grid
from rssnav.explorer.background import FileMaker, NewestOnly, Ticket
from rssnav.explorer.cell_paths import Position
from rssnav.explorer.fair_turns import FairTurns, TabTurns
from rssnav.explorer.limits import Limits
from rssnav.explorer.map_settings import MapSettings, preset_of
from rssnav.explorer.places import Point, cell_at, nearest_centre, with_source_and_start
from rssnav.explorer.searching import LiveSearch, SearchSettings
from rssnav.explorer.session_file import SavedSession
from rssnav.explorer.survey_layer import (
    CSV,
    SurveyFile,
    SurveyTracer,
    example,
    read_survey_upload,
)
from rssnav.explorer.tracing import (
    LatestScene,
    MapCache,
    MapTracer,
    PathFinder,
    TracedMap,
)
from rssnav.explorer.training import LiveTraining, TrainingSettings
from rssnav.explorer.uploads import Upload, read_upload
from rssnav.presets import PresetName
from rssnav.transmitters import SOURCE

PLACE_DIGITS = 2
"""A dragged source is rounded to centimetres."""


class Session:
    """State of one tab, independent of the browser.

    Methods that change it are called from one thread only. Long work runs on other threads; its
    results appear in `maps`, `paths`, `training` and `search`, or through `take_upload`.

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
    search : LiveSearch or None
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
        self._preset: PresetName = "paper"
        scenes = LatestScene()
        self._turns = TabTurns(turns or FairTurns(self.limits.jobs))
        self.maps = MapTracer(self.limits, cache or MapCache(), scenes, self._turns)
        self.paths = PathFinder(self.limits, scenes, self._turns)
        self.survey = SurveyTracer(self.limits, scenes, self._turns)
        self.training: LiveTraining | None = None
        self.search: LiveSearch | None = None
        self.cell: tuple[int, int] | None = None
        self.problem = ""
        self._reader = NewestOnly("upload", self._turns)
        self.files = FileMaker(self._turns)
        self._uploaded: Upload | SurveyFile | str | None = None
        self.import_report: tuple[str, ...] = ()
        self._resuming: SavedSession | None = None
        self._labelled: tuple[TracedMap, TracedMap] | None = None
        self.open_plan(plan)

    def close(self) -> None:
        """Stop all work of this tab."""
        self.stop_training()
        self.stop_search()
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
        preset = preset_of(plan)
        of_kind = self.settings if preset == self._preset else self.settings.with_preset(preset)
        self._open(plan, replace(of_kind, height_m=height_m, server=SOURCE))

    def _open(self, plan: FloorPlan, settings: MapSettings) -> None:
        """Replace all that is open, and trace the map."""
        settings.check_height(plan)
        self.limits.check_cells(plan, settings.cell_size_m)
        self._drop_flights()
        self.maps.forget()
        self.paths.forget()
        self.survey.forget()
        self.cell, self.problem, self.import_report = None, "", ()
        self.plan, self.settings, self._preset = plan, settings, preset_of(plan)
        self._snap_start()
        self.maps.request(self.plan, self.settings)

    def saved(self) -> SavedSession:
        """Return what is needed to open the session again."""
        cell, file = None, self.survey.file
        if self.cell is not None:
            i_y, i_x = self.cell
            cell = float(self.grid.x[i_x]), float(self.grid.y[i_y])
        training = None if self.training is None else self.training.settings
        text = None if file is None else file.text
        return SavedSession(floorplans.dumps(self.plan), self.settings, cell, training, text)

    def open_saved(
        self, saved: SavedSession, plan: FloorPlan, survey: SurveyFile | None = None
    ) -> None:
        """Open a saved session; its cell and training follow by `resume`, once the map is there.

        Raises
        ------
        PlanError
            For one that does not fit its plan; the open one stays.
        """
        self.limits.check_plan(plan)
        plan, server = with_source_and_start(plan), saved.settings.server
        if server not in (SOURCE, ALL, *(t.id for t in plan.transmitters)):
            raise PlanError(f"map.transmitter: {server!r} is none of the plan", origin=plan.name)
        self._open(plan, saved.settings)
        self._resuming = saved
        if survey is not None:
            self.survey.open(survey, self.plan, self.settings)

    def resume(self) -> None:
        """Select the cell and repeat the training of a saved session when its map is complete."""
        saved, latest = self._resuming, self.maps.latest
        if saved is None or latest is None or not latest.complete:
            return
        self._resuming = None
        if saved.cell is not None:
            self.choose_cell(*saved.cell)
        if saved.training is not None and self.settings.server != ALL:
            self.train(saved.training)

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
        elif isinstance(found, SurveyFile):
            self.problem = ""
            self.survey.open(found, self.plan, self.settings)
        elif found is not None:
            self.problem = found
        return found is not None

    def _open_upload(self, upload: Upload) -> None:
        if upload.saved is not None:
            self.open_saved(upload.saved, upload.plan, upload.survey)
            return
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
            self._drop_flights()
            self.settings = replace(self.settings, server=SOURCE)
        self.maps.request(self.plan, self.settings)
        self._find_paths()

    def move_start(self, x: float, y: float) -> None:
        """Move the start to the cell centre nearest to a point [m], if it can be there."""
        before = self.plan
        self._try(
            lambda: self._replace_plan(replace(before, start=nearest_centre(self.grid, x, y)))
        )
        if self.plan is not before:
            self._drop_flights()

    def change(self, settings: MapSettings, source: Position, start: Point) -> None:
        """Move source and start [m] and change the settings, until one of these is rejected."""
        self.problem = ""
        if source != self.plan.source:
            self.move_source(*source)
        if not self.problem and start != self.plan.start:
            self.move_start(*start)
        if not self.problem:
            self.change_settings(settings)

    def change_settings(self, settings: MapSettings) -> None:
        """Trace the map with other settings; those that do not fit the plan are rejected."""
        if settings == self.settings:
            self.problem = ""
            return
        self._try(partial(self._apply, settings))

    def _apply(self, settings: MapSettings) -> None:
        self.limits.check_cells(self.plan, settings.cell_size_m)
        settings.check_height(self.plan)
        self._drop_flights()
        self.paths.forget()
        self.cell, self.settings = None, settings
        self._snap_start()
        self.maps.request(self.plan, settings)
        self.survey.request(self.plan, settings)

    def choose_cell(self, x: float, y: float) -> None:
        """Select the cell at a point [m] and trace its paths; none outside the map."""
        self._select(cell_at(self.grid, x, y))

    def step_cell(self, right: int, up: int) -> None:
        """Select a cell so many cells away, at most at the edge; at first that of the start."""
        grid = self.grid
        if self.cell is None:
            self.choose_cell(*self.plan.require_start())
            return
        i_y, i_x = self.cell
        i_x = min(max(i_x + right, 0), len(grid.x) - 1)
        i_y = min(max(i_y + up, 0), len(grid.y) - 1)
        if (i_y, i_x) != self.cell:
            self._select((i_y, i_x))

    def _select(self, cell: tuple[int, int] | None) -> None:
        self.cell = cell
        if self._resuming is not None:
            self._resuming = replace(self._resuming, cell=None)
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
        if (
            self._labelled is None
            or self._labelled[0] is not latest
            or (self._labelled[1].plan is not self.plan)
        ):
            labelled = latest.radio_map.with_plan(floorplans.dumps(self.plan), self.plan.sha256)
            self._labelled = latest, replace(latest, plan=self.plan, radio_map=labelled)
        return self._labelled[1]

    def _map_to_fly_in(self, what: str) -> TracedMap | None:
        """Return the complete map, or say that there is none yet."""
        traced, self.problem = self.complete_map, ""
        if traced is None:
            self.problem = f"the map is not complete yet; start the {what} when it is"
        return traced

    def train(self, settings: TrainingSettings) -> None:
        """Start a training in the complete map, replacing the previous one."""
        traced = self._map_to_fly_in("training")
        if traced is not None:
            self.stop_training()
            self.training = LiveTraining(traced, settings, self._turns)
            self.training.start()

    def stop_training(self) -> None:
        """Stop the training; its results so far stay."""
        if self.training is not None:
            self.training.stop()

    def begin_search(self, settings: SearchSettings) -> None:
        """Start two searchers in the complete map, replacing the previous ones."""
        traced = self._map_to_fly_in("search")
        if traced is not None:
            self.stop_search()
            self.search = LiveSearch(traced, settings, self._turns)
            self.search.start()

    def stop_search(self) -> None:
        """Stop the search; what was flown stays."""
        if self.search is not None:
            self.search.stop()

    def _drop_flights(self) -> None:
        self.stop_training()
        self.stop_search()
        self.training, self.search, self._resuming = None, None, None

    def _snap_start(self) -> None:
        """Move the start to a cell centre, if the plan allows it."""
        start = nearest_centre(self.grid, *self.plan.require_start())
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
