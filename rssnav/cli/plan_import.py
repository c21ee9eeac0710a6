"""``rssnav plan import``: create a plan from another program's file."""

from collections import Counter
from dataclasses import asdict
from pathlib import Path

import typer

from atomicfiles import atomic_write
from floorplans.importers import Imported, ImportOptions, import_plan, layers_toml
from floorplans.repair.walls import Change
from rssnav.cli.console import print_json, print_table, say
from rssnav.cli.import_options import (
    CeilingHeight,
    ImportedFile,
    KeepAxes,
    Layer,
    Layers,
    Level,
    Name,
    Output,
    Replace,
    SaveLayers,
    Scale,
    SlabMaterial,
    Source,
    Start,
    Unit,
    WallMaterial,
    WallThickness,
    WallTolerance,
    layers_of,
    source_of,
    start_of,
)
from rssnav.cli.options import Json, check_suffix, examples
from rssnav.cli.plan_summary import print_summary, summary_of

LISTED_CHANGES = ("closed", "dropped", "raised")
"""Kinds of changes that are listed one by one; of the others the report gives the number."""


def add_to(parent: typer.Typer) -> None:
    """Add the command."""
    parent.command(
        "import",
        epilog=examples(
            "rssnav plan export flat -o flat.dxf",
            "rssnav plan import flat.dxf -o my.toml --height 2.6",
            "rssnav plan import flat.dxf -o wood.toml --layer 'WALL*=wall:wood'",
        ),
    )(import_file)


def import_file(
    file: ImportedFile,
    output: Output,
    name: Name = None,
    height: CeilingHeight = None,
    wall_thickness: WallThickness = None,
    wall_material: WallMaterial = None,
    floor_material: SlabMaterial = None,
    ceiling_material: SlabMaterial = None,
    source: Source = None,
    start: Start = None,
    unit: Unit = None,
    level: Level = None,
    scale: Scale = None,
    tolerance: WallTolerance = None,
    keep_axes: KeepAxes = False,
    layer: Layer = None,
    layers: Layers = None,
    save_layers: SaveLayers = None,
    force: Replace = False,
    as_json: Json = False,
) -> None:
    """Create a plan from a drawing, a venue, a robot's map or a building model.

    What the file does not state gets a default that the plan's file marks as assumed; the report
    lists what became of every layer, and the repairs.
    """
    check_suffix(output, (".toml",), "--output")
    if save_layers is not None:
        check_suffix(save_layers, (".toml",), "--save-layers")
    options = ImportOptions(
        name=name,
        height_m=height,
        wall_thickness_m=wall_thickness,
        wall_material=wall_material,
        floor_material=floor_material,
        ceiling_material=ceiling_material,
        source=source_of(source),
        start=start_of(start),
        unit=unit,
        level=level,
        scale_m=scale,
        tolerance_m=tolerance,
        keep_axes=keep_axes,
        layers=layers_of(layer, layers),
    )
    if output.exists() and not force:
        raise FileExistsError(17, "already exists; use --force to overwrite", str(output))
    imported = import_plan(file, options)
    with atomic_write(output) as beside:
        beside.write_text(imported.toml(), encoding="utf-8", newline="\n")
    if save_layers is not None:
        with atomic_write(save_layers) as beside:
            text = layers_toml(options.layers, imported.layers)
            beside.write_text(text, encoding="utf-8", newline="\n")
    _report(imported, output, as_json)


def _report(imported: Imported, output: Path, as_json: bool) -> None:
    if as_json:
        print_json(
            {
                "output": str(output),
                **summary_of(imported.plan),
                "origin": asdict(imported.origin),
                "layers": [asdict(use) for use in imported.layers],
                "assumed": [asdict(assumption) for assumption in imported.assumed],
                "changes": [asdict(change) for change in imported.changes],
                "notes": imported.notes,
            }
        )
        return
    if imported.layers:
        rows = [(use.name, use.n_objects, use.became) for use in imported.layers]
        print_table(("layer", ">objects", "became"), rows)
        _print_layer_option(imported)
        print()
    if imported.assumed:
        print_table(
            ("assumed", "value", "why"), [(a.key, a.value, a.why) for a in imported.assumed]
        )
        print()
    _print_changes(imported.changes)
    for sentence in imported.notes:
        say(sentence)
    print_summary(imported.plan)
    say(f"\nwrote {output}; see it with: rssnav plan show {output}")


def _print_layer_option(imported: Imported) -> None:
    unknown = [use for use in imported.layers if use.is_unknown]
    if unknown:
        largest = max(unknown, key=lambda use: use.n_objects)
        say(f"layers of unknown names are walls with, for example, --layer '{largest.name}=wall'")


def _print_changes(changes: tuple[Change, ...]) -> None:
    """Print the number of changes of each kind, and those that change the building."""
    if not changes:
        return
    counts = Counter(change.kind for change in changes)
    say("repaired: " + ", ".join(f"{n} {kind}" for kind, n in counts.items()))
    for change in changes:
        if change.kind in LISTED_CHANGES:
            say(f"  {change}")
    print()
