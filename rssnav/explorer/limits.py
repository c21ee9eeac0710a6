"""Limits of the explorer, which serves users who may upload and send anything."""

import math
from dataclasses import dataclass

from floorplans import FloorPlan, PlanError
from raytrace.threads import n_threads
from rssnav.explorer.plan_size import PlanSize


@dataclass(frozen=True)
class Limits:
    """Limits on tabs, messages, uploads, plans, maps and work.

    Attributes
    ----------
    tabs : int
        Maximum number of open tabs.
    pages : int
        Maximum number of pages that are open or being opened, and of connections; pages beyond
        `tabs` only say that there are too many.
    jobs : int
        Maximum number of tabs that compute at the same time.
    message_bytes : int
        Maximum size of a message from the browser other than an upload [bytes].
    events : int
        Maximum number of changes and events in a message.
    upload_bytes, plan_bytes : int
        Maximum sizes of an uploaded file, and of the TOML text of its plan [bytes].
    survey_bytes : int
        Maximum size of an uploaded survey [bytes].
    session_bytes : int
        Maximum size of an uploaded session, with its plan and survey [bytes].
    entities : int
        Maximum number of entities of a drawing, model or collection.
    walls, openings, outline_points : int
        Maximum numbers of straight walls, openings and corners of outline and courtyards of a plan.
    cells : int
        Maximum number of cells of a map.
    csv_rows : int
        Maximum number of paths in a file.
    work : int
        Maximum of walls times cells; the time of a map is roughly proportional to it.
    map_s : float
        Time limit for tracing a map or the paths to a cell [s].
    trace_bytes : int
        Memory limit for the same [bytes].
    import_s : float
        Time limit for reading an upload [s].
    import_bytes : int
        Memory limit for reading an upload [bytes].
    """

    tabs: int = 32
    pages: int = 200
    jobs: int = max(2, n_threads())
    message_bytes: int = 64_000
    events: int = 100
    upload_bytes: int = 8_000_000
    plan_bytes: int = 2_000_000
    survey_bytes: int = 1_000_000
    session_bytes: int = 4_000_000
    entities: int = 100_000
    walls: int = 1500
    openings: int = 1500
    outline_points: int = 1500
    cells: int = 40_000
    csv_rows: int = 100_000
    work: int = 15_000_000
    map_s: float = 300.0
    trace_bytes: int = 1_000_000_000
    import_s: float = 60.0
    import_bytes: int = 4_000_000_000

    def check_plan(self, plan: FloorPlan) -> None:
        """Raise `PlanError` for a plan with too many parts."""
        self.check_size(PlanSize.of(plan), plan.name)

    def check_size(self, size: PlanSize, origin: str) -> None:
        """Raise `PlanError` for too many parts."""
        for name, count, most in (
            ("walls", size.walls, self.walls),
            ("openings", size.openings, self.openings),
            ("corners of the outline", size.outline_points, self.outline_points),
        ):
            if count > most:
                raise PlanError(
                    f"{count} {name}; the explorer accepts plans of at most {most}: leave out "
                    "details, or use `rssnav map`, which has no limit",
                    origin=origin,
                )

    def check_cells(self, plan: FloorPlan, cell_size_m: float) -> None:
        """Raise `PlanError` for a map with too many cells, or too many for its plan's walls.

        The cells are counted before a grid of them is made.
        """
        x_min, y_min, x_max, y_max = plan.bounds
        n_cells = max(1.0, (x_max - x_min) / cell_size_m) * max(1.0, (y_max - y_min) / cell_size_m)
        n_allowed = min(self.cells, self.work // max(len(plan.walls), 1))
        if n_cells > n_allowed:
            finer = cell_size_m * math.sqrt(n_cells / n_allowed)
            raise PlanError(
                f"{n_cells:.6g} cells of {cell_size_m:g} m; the explorer maps at most {n_allowed} "
                f"with {len(plan.walls)} walls: use cells of at least {finer:.2g} m",
                origin=plan.name,
            )
