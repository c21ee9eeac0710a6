"""An imported plan, and what was assumed and changed."""

from __future__ import annotations

from dataclasses import dataclass, replace

from floorplans.errors import Place, PlanError
from floorplans.importers.draft import Assumption, Box, ImportOptions, LayerUse, Origin
from floorplans.importers.original import Original
from floorplans.plan import FloorPlan
from floorplans.repair.walls import Change
from floorplans.toml.writer import dumps
from floorplans.unchecked import UncheckedPlan
from floorplans.walls import Point


@dataclass(frozen=True)
class DrawingPart:
    """A drawing on a sheet with several.

    Attributes
    ----------
    bounds : (float, float, float, float)
        (x_min, y_min, x_max, y_max), a little wider than the walls [unit of the file].
    n_walls : int
        Pieces of wall that were drawn.
    is_taken : bool
        Whether the plan is of this one.
    """

    bounds: Box
    n_walls: int
    is_taken: bool

    @property
    def corners(self) -> str:
        """Two opposite corners."""
        x_min, y_min, x_max, y_max = self.bounds
        return f"({x_min:g}, {y_min:g}) to ({x_max:g}, {y_max:g})"


@dataclass(frozen=True, kw_only=True)
class ImportRecord:
    """What an import made, and how.

    Attributes
    ----------
    plan : UncheckedPlan
    source_file : str
        Name of the file it came from, without its folder.
    origin : Origin
        Position of the plan's (0, 0) in the file.
    assumed : tuple of Assumption
        What the file did not state.
    layers : tuple of LayerUse
        What became of each layer of the file.
    changes : tuple of Change
        Repairs that made walls meet and the outline close.
    notes : tuple of str
        Further information for the user, one sentence each.
    warnings : tuple of str
        What the user should look at, one sentence each.
    original : Original or None
        What the file shows, in the plan's coordinates.
    parts : tuple of DrawingPart
        The separate drawings of a sheet that holds several.
    """

    plan: UncheckedPlan
    source_file: str
    origin: Origin
    assumed: tuple[Assumption, ...] = ()
    layers: tuple[LayerUse, ...] = ()
    changes: tuple[Change, ...] = ()
    notes: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()
    original: Original | None = None
    parts: tuple[DrawingPart, ...] = ()

    @property
    def report(self) -> tuple[str, ...]:
        """All information about the import, one line each."""
        return (
            *(f"layer {use.name} ({use.n_objects}): {use.became}" for use in self.layers),
            *(f"assumed {a.key} = {a.value}: {a.why}" for a in self.assumed),
            *(str(change) for change in self.changes),
            *(f"warning: {sentence}" for sentence in self.warnings),
            *self.notes,
        )

    def toml(self) -> str:
        """Text of the plan's file, with a comment on every assumed value."""
        return "\n".join([*self._header(), "", *self._body()]) + "\n"

    def _header(self) -> list[str]:
        x, y = self.origin.x, self.origin.y
        lines = [
            f"# Imported from {self.source_file}",
            f"# (0, 0) of this plan is ({x:.9g}, {y:.9g}) in {self.origin.frame}",
        ]
        keys = {line.split(" = ")[0] for line in self._lines()}
        lines += [
            f"# assumed: {a.key} = {a.value}: {a.why}" for a in self.assumed if a.key not in keys
        ]
        return [_comment(line) for line in lines]

    def _body(self) -> list[str]:
        """Lines of the plan, with the assumptions before the first wall as comments."""
        whys = {assumption.key: assumption.why for assumption in self.assumed}
        lines = self._lines()
        n_top = lines.index("[[walls]]")
        top = [
            f"{line}  # assumed: {_comment(whys[key])}"
            if (key := line.split(" = ")[0]) in whys
            else line
            for line in lines[:n_top]
        ]
        return top + lines[n_top:]

    def _lines(self) -> list[str]:
        return dumps(self.plan).splitlines()


@dataclass(frozen=True, kw_only=True)
class Imported(ImportRecord):
    """The result of an import: a usable plan, and how it was made."""

    plan: FloorPlan

    @classmethod
    def from_plan(cls, plan: FloorPlan, options: ImportOptions, source_file: str) -> Imported:
        """Wrap a complete plan.

        Parameters
        ----------
        plan : FloorPlan
        options : ImportOptions
            What they specify replaces what the plan has.
        source_file : str
            Name of the file it was read from.
        """
        given = {
            key: getattr(options, key)
            for key in ("name", "floor_material", "ceiling_material", "source", "start")
            if getattr(options, key) is not None
        }
        origin = Origin(0.0, 0.0, "the file, in metres")
        return cls(plan=replace(plan, **given), source_file=source_file, origin=origin)


@dataclass(frozen=True, kw_only=True)
class DraftPlan(ImportRecord):
    """A plan that fails its checks, as a start for corrections by hand.

    Attributes
    ----------
    faults : tuple of PlanError
        What is wrong with it.
    gaps : tuple of ((float, float), (float, float))
        Where its outline has no wall, from (x, y) to (x, y) [m].
    """

    faults: tuple[PlanError, ...] = ()
    gaps: tuple[tuple[Point, Point], ...] = ()

    def _header(self) -> list[str]:
        lines = ["DRAFT, not traceable until these faults are corrected:"]
        lines += [f"  {fault}" for fault in self.faults]
        return [*(_comment(f"# {line}") for line in lines), *super()._header()]


class UnusablePlanError(PlanError):
    """What was imported is no usable plan; `draft` holds it nevertheless."""

    def __init__(self, draft: DraftPlan, problem: str, origin: str = "") -> None:
        super().__init__(problem, origin=origin, at=draft.faults[0].at, remedy=_remedy(draft))
        self.draft = draft

    def located(
        self, origin: str = "", *, place: Place | None = None, at: Point | None = None
    ) -> UnusablePlanError:
        """Return the same error with the file it is about; see `PlanError.located`."""
        return UnusablePlanError(self.draft, self.problem, self.origin or origin)

    def with_draft(self, draft: DraftPlan) -> UnusablePlanError:
        """Return the same error about another draft."""
        return UnusablePlanError(draft, self.problem, self.origin)


def _remedy(draft: DraftPlan) -> str | None:
    return "close_gaps_m" if draft.gaps else None


def _comment(text: str) -> str:
    """Return a text as TOML allows it in a comment: one line, without control characters."""
    return "".join(c for c in " ".join(text.split()) if c.isprintable())
