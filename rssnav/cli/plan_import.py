"""``rssnav plan import``: create a plan from another program's file."""

import typer

from atomicfiles import atomic_write
from floorplans.importers import ImportOptions, UnusablePlanError, import_plan, layers_toml
from rssnav.cli.console import one_progress
from rssnav.cli.import_options import (
    CeilingHeight,
    CloseGaps,
    ImportedFile,
    KeepAxes,
    Layer,
    Layers,
    Level,
    Name,
    Output,
    Region,
    Replace,
    ReportPage,
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
    region_of,
    source_of,
    start_of,
)
from rssnav.cli.options import Json, check_suffix, examples
from rssnav.cli.plan_import_report import (
    print_import,
    print_import_json,
    print_warnings,
    write_draft,
    write_page,
)


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
    close_gaps: CloseGaps = None,
    region: Region = None,
    layer: Layer = None,
    layers: Layers = None,
    save_layers: SaveLayers = None,
    report: ReportPage = None,
    force: Replace = False,
    as_json: Json = False,
) -> None:
    """Create a plan from a drawing, a venue, a robot's map or a building model.

    What the file does not state gets a default, marked as assumed in the plan; the report lists
    how each layer was used, and the repairs. If no usable plan results, for example because gaps in
    the outline are too wide to close, a draft and a picture of the gaps are written instead.
    """
    check_suffix(output, (".toml",), "--output")
    if save_layers is not None:
        check_suffix(save_layers, (".toml",), "--save-layers")
    check_suffix(report, (".html",), "--report")
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
        close_gaps_m=close_gaps,
        region=region_of(region),
        layers=layers_of(layer, layers),
    )
    if output.exists() and not force:
        raise FileExistsError(17, "already exists; use --force to overwrite", str(output))
    try:
        with one_progress("import") as show:
            imported = import_plan(file, options, progress=show)
    except UnusablePlanError as error:
        print_warnings(error.draft)
        write_draft(error.draft, output, force)
        write_page(error.draft, report)
        raise
    with atomic_write(output) as beside:
        beside.write_text(imported.toml(), encoding="utf-8", newline="\n")
    if save_layers is not None:
        with atomic_write(save_layers) as beside:
            text = layers_toml(options.layers, imported.layers)
            beside.write_text(text, encoding="utf-8", newline="\n")
    write_page(imported, report)
    if as_json:
        print_import_json(imported, output)
    else:
        print_import(imported, output)
