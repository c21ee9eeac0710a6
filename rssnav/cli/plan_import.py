"""``rssnav plan import``: create a plan from another program's file."""

from collections import Counter
from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer

from atomicfiles import atomic_write
from floorplans.importers import Imported, ImportOptions, import_plan, layers_toml, read_layers
from floorplans.repair.walls import Change
from rssnav.cli.console import print_json, print_table, say
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


def _point(text: str | None) -> tuple[float, float] | None:
    if text is None:
        return None
    x, y = _numbers(text, "xy", "--start")
    return (x, y)


def _position(text: str | None) -> tuple[float, float, float] | None:
    if text is None:
        return None
    x, y, z = _numbers(text, "xyz", "--source")
    return (x, y, z)


def _numbers(text: str, names: str, option: str) -> tuple[float, ...]:
    """Read "1.5,2,1" as one number for each letter of `names`."""
    try:
        numbers = tuple(float(part) for part in text.split(","))
    except ValueError:
        numbers = ()
    if len(numbers) != len(names):
        shape = ",".join(names).upper()
        raise typer.BadParameter(f"{text!r} is not {shape} in metres.", param_hint=option)
    return numbers


def _layers(texts: list[str] | None) -> dict[str, str]:
    layers: dict[str, str] = {}
    for text in texts or ():
        name, equals, meaning = text.rpartition("=")
        if not equals or not name:
            raise typer.BadParameter(
                f"{text!r} is not NAME=KIND or NAME=KIND:MATERIAL.", param_hint="--layer"
            )
        layers[name] = meaning
    return layers


def _with_saved(layers: dict[str, str], file: Path | None) -> dict[str, str]:
    """Meanings of the command line, then those of a file: the first that matches counts."""
    saved = {} if file is None else read_layers(file)
    return layers | {name: saved[name] for name in saved if name not in layers}


def import_file(
    file: Annotated[
        Path,
        typer.Argument(
            metavar="FILE",
            help="A DXF drawing, a GeoJSON or IMDF venue, a ROS map or an IFC model.",
            show_default=False,
        ),
    ],
    output: Annotated[
        Path, typer.Option("-o", "--output", metavar="FILE", help="The .toml file to write.")
    ],
    name: Annotated[
        str | None, typer.Option(help="Name of the plan.", show_default="the file's")
    ] = None,
    height: Annotated[
        float | None,
        typer.Option(
            metavar="M",
            min=0.1,
            max=1000.0,
            help="From floor to ceiling.",
            show_default="the file's, or 3",
        ),
    ] = None,
    wall_thickness: Annotated[
        float | None,
        typer.Option(
            metavar="M",
            min=1e-4,
            max=1000.0,
            help="Of walls whose thickness the file does not state.",
            show_default="0.1",
        ),
    ] = None,
    wall_material: Annotated[
        str | None,
        typer.Option(
            metavar="MATERIAL",
            help="Of walls whose material the file does not state.",
            show_default="plasterboard, concrete where thick",
        ),
    ] = None,
    floor_material: Annotated[
        str | None, typer.Option(metavar="MATERIAL", show_default="the file's, or concrete")
    ] = None,
    ceiling_material: Annotated[
        str | None, typer.Option(metavar="MATERIAL", show_default="the file's, or concrete")
    ] = None,
    source: Annotated[
        str | None,
        typer.Option(
            metavar="X,Y,Z", help="Transmitter in the plan.", show_default="away from walls"
        ),
    ] = None,
    start: Annotated[
        str | None,
        typer.Option(
            metavar="X,Y", help="Start of the search.", show_default="far from the source"
        ),
    ] = None,
    unit: Annotated[
        str | None,
        typer.Option(help="Of the file: mm, cm, m, in, ft ...", show_default="the file's"),
    ] = None,
    level: Annotated[
        str | None, typer.Option(help="Which storey, where the file holds several.")
    ] = None,
    scale: Annotated[
        float | None,
        typer.Option(metavar="M", min=1e-4, max=1000.0, help="Side of a pixel, for pictures."),
    ] = None,
    tolerance: Annotated[
        float | None,
        typer.Option(
            metavar="M",
            min=1e-9,
            max=1000.0,
            help="How far walls may be moved to meet.",
            show_default="the format's",
        ),
    ] = None,
    layer: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME=KIND[:MATERIAL]",
            help="What a layer or type is: wall, door, window or ignore; NAME may hold * and ?.",
        ),
    ] = None,
    layers: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Meanings of layers that --save-layers wrote."),
    ] = None,
    save_layers: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Write --layers and --layer to this .toml file."),
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace whatever is at FILE.")] = False,
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
        source=_position(source),
        start=_point(start),
        unit=unit,
        level=level,
        scale_m=scale,
        tolerance_m=tolerance,
        layers=_with_saved(_layers(layer), layers),
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
