"""``rssnav plan check``: errors and warnings of a plan, and safe repairs."""

from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NoReturn

import typer
from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table
from rich.text import Text

from atomicfiles import atomic_write
from floorplans import FloorPlan, PlanError
from floorplans.checks.inspection import Finding, inspect
from floorplans.checks.plan import faults, number_faults
from floorplans.loading import builtin_names, loads_unchecked, read_text
from floorplans.repair.plan import RepairedPlan, repair_plan
from floorplans.repair.walls import Change
from floorplans.unchecked import PlanFile, UncheckedPlan
from rssnav.cli.console import note, print_json, print_table, say
from rssnav.cli.options import Json, Plan, check_suffix, examples
from rssnav.cli.plan_summary import print_summary, summary_of
from rssnav.messages import printable

if TYPE_CHECKING:
    from rssnav.reachability import Reach


def add_to(parent: typer.Typer) -> None:
    """Add the command."""
    parent.command(
        epilog=examples(
            "rssnav plan check flat",
            "rssnav plan check scenario1 --json",
            "rssnav plan new --size 12x9 -o my.toml",
            "rssnav plan check my.toml --fix",
        )
    )(check)


def check(
    plan: Plan,
    fix: Annotated[
        bool,
        typer.Option(
            "--fix",
            help="Repair walls that almost meet and duplicate walls before checking.",
        ),
    ] = False,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--output",
            metavar="FILE",
            help="Where --fix writes the repaired plan.",
            show_default="PLAN, with a backup in PLAN.bak",
        ),
    ] = None,
    as_json: Json = False,
) -> None:
    """Check a plan: the file, the walls, the rooms, and whether the source can be reached.

    Lists all errors and warnings with coordinates, separately for maps and for flights. A file
    that cannot be read as a plan (invalid TOML, a missing key, a value of the wrong type or out of
    range) is reported at its first fault. Exits with status 1 on errors.
    """
    if output is not None and not fix:
        raise typer.BadParameter("only --fix writes a file.", param_hint="--output")
    check_suffix(output, (".toml",), "--output")
    text, origin = read_text(plan)
    file = loads_unchecked(text, origin=origin)
    changes: tuple[Change, ...] = ()
    if fix:
        if plan in builtin_names():
            raise typer.BadParameter("a built-in plan cannot be repaired.", param_hint="--fix")
        if any(number_faults(file.plan)):
            _fail(file, origin)
        repaired = _safe_repair(file.plan)
        changes = repaired.changes
        _write(repaired, text, Path(plan), output)
        if changes:
            file, plan = PlanFile.of(repaired.plan), str(output or plan)
    _report(file, plan, changes, as_json)


def _safe_repair(plan: UncheckedPlan) -> RepairedPlan:
    """Repair a plan; return it unchanged if what would be written is not usable and it is."""
    repaired = repair_plan(plan)
    if not repaired.changes:
        return repaired
    written = loads_unchecked(repaired.toml()).plan
    if written == repaired.plan and _use(written) >= _use(plan):
        return repaired
    return RepairedPlan(plan, ())


def _use(plan: UncheckedPlan) -> int:
    """What a plan can be used for: 0 nothing, 1 maps, 2 flights to its source too."""
    from raytrace import SceneError
    from rssnav import WorldError
    from rssnav.scenes import scene_of

    try:
        checked = FloorPlan.of(plan)
        scene_of(checked)
    except (PlanError, SceneError):
        return 0
    try:
        return 1 + any(reach.steps is not None for reach in _flights(checked))
    except WorldError:
        return 1


def _write(repaired: RepairedPlan, old_text: str, path: Path, output: Path | None) -> None:
    """Write a repaired plan; keep the old one beside it where it is replaced."""
    if not repaired.changes:
        note("no safe repairs found")
        return
    target = output or path
    in_place = target.resolve() == path.resolve()
    if in_place:
        with atomic_write(path.with_name(path.name + ".bak")) as beside:
            beside.write_text(old_text, encoding="utf-8", newline="\n")
    with atomic_write(target) as beside:
        beside.write_text(repaired.toml(), encoding="utf-8", newline="\n")
    for change in repaired.changes:
        note(f"repaired {change}")
    kept = f"; the original is in {path.name}.bak" if in_place else ""
    note(f"wrote {target}{kept}")


def _report(file: PlanFile, plan: str, changes: Sequence[Change], as_json: bool) -> None:
    from rssnav.reachability import source_unreached, unreached
    from rssnav.scenes import scene_of

    findings = list(inspect(file))
    errors = [finding for finding in findings if finding.severity == "error"]
    flights: tuple[Reach, ...] = ()
    summary: dict[str, Any] = {"plan": plan}
    if not errors:
        checked = FloorPlan.of(file.plan)
        scene_of(checked)
        flights = _flights(checked)
        findings = [f for f in findings if flights or f.concerns == "map"]
        told = (source_unreached(checked, flights), *map(unreached, flights))
        findings += [finding for finding in told if finding is not None]
        summary |= summary_of(checked)
    if as_json:
        report = {
            "flights": [_row(reach) for reach in flights],
            "findings": [{**asdict(f), "concerns": f.concerns} for f in findings],
            "changes": [asdict(change) for change in changes],
        }
        print_json(summary | report)
    elif errors:
        if len(findings) > 1:
            _print_findings(findings)
    else:
        _print_checked(FloorPlan.of(file.plan), flights, findings)
        say(f"\n{plan} is valid{_warnings_text(len(findings))}")
    if errors:
        _fail(file, plan)


def _fail(file: PlanFile, origin: str) -> NoReturn:
    """Raise the first fault, as loading the plan does."""
    first = next(faults(file.plan))
    raise first.located(origin, place=file.place_in_file(first.place))


def _warnings_text(n_warnings: int) -> str:
    if not n_warnings:
        return ""
    return f", but see {n_warnings} warning{'s' if n_warnings > 1 else ''} above"


def _flights(plan: FloorPlan) -> tuple["Reach", ...]:
    """What a flight can reach; empty for a plan without source or start."""
    from rssnav.reachability import reach_by_speed

    return () if plan.source is None or plan.start is None else reach_by_speed(plan)


def _row(reach: "Reach") -> dict[str, Any]:
    return {
        "speed": reach.speed,
        "steps": reach.steps,
        "length_m": reach.length_m,
        "cells": reach.n_cells,
        "missed_cells_m": reach.missed,
    }


def _print_checked(
    plan: FloorPlan, flights: Sequence["Reach"], findings: Sequence[Finding]
) -> None:
    """Print what concerns a map, and what concerns a flight only."""
    print_summary(plan)
    for_map = [finding for finding in findings if finding.concerns == "map"]
    if for_map:
        say("\nfor a map")
        _print_findings(for_map)
    if flights:
        say("\nfor a flight, the shortest from the start to the source")
        _print_flights(flights)
        _print_findings([finding for finding in findings if finding.concerns == "flight"])
    else:
        missing = " and no ".join(k for k in ("source", "start") if getattr(plan, k) is None)
        say(f"\nfor a flight: not checked, because the plan has no {missing}")


def _print_flights(flights: Sequence["Reach"]) -> None:
    print_table(
        (">speed", ">steps", ">length", ""),
        [
            (f.speed, f.steps, f"{f.length_m:.2f} m", "")
            if f.steps is not None
            else (f.speed, "-", "-", "the source is not reachable at this speed")
            for f in flights
        ],
    )


def _print_findings(findings: Sequence[Finding]) -> None:
    """Print a table on a terminal, otherwise a line per finding."""
    if not findings:
        return
    console = Console()
    if not console.is_terminal:
        for f in findings:
            say(f"{f.severity}  {_where(f)}  {_what(f)}")
        return
    table = Table(box=SIMPLE_HEAD, pad_edge=False)
    for column in ("", "where", "what"):
        table.add_column(column, no_wrap=column != "what")
    for f in findings:
        colour = "red" if f.severity == "error" else "yellow"
        table.add_row(
            Text(f.severity, style=colour), Text(_where(f)), Text(printable(f"{f.kind}: {f.text}"))
        )
    console.print(table)


def _what(finding: Finding) -> str:
    """Text of a finding; that of an error already begins with its place in the file."""
    return finding.text if finding.severity == "error" else f"{finding.kind}: {finding.text}"


def _where(finding: Finding) -> str:
    if finding.at is None:
        return "-"
    return f"({finding.at[0]:.3f}, {finding.at[1]:.3f})"
