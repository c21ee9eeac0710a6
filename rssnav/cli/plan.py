"""``rssnav plan``: show, check, import and export floor plans."""

from pathlib import Path
from typing import Annotated, Literal

import typer

import floorplans
from atomicfiles import atomic_write
from floorplans import FloorPlan
from rssnav.cli import plan_check, plan_export, plan_generate, plan_import, plan_new
from rssnav.cli.console import print_json, print_table, say
from rssnav.cli.options import PICTURE_SUFFIXES, Json, Plan, Style, check_suffix, examples
from rssnav.cli.plan_sketch import sketch
from rssnav.cli.plan_summary import (
    count_openings,
    point_text,
    print_summary,
    size_text,
    summary_of,
)

SOLID_SUFFIXES = (".html", ".glb")

app = typer.Typer(no_args_is_help=True, rich_markup_mode="rich")
for _part in (plan_new, plan_generate, plan_import, plan_check, plan_export):
    _part.add_to(app)


def add_to(parent: typer.Typer) -> None:
    """Add the commands below ``plan``."""
    parent.add_typer(
        app,
        name="plan",
        help="Show, check, import and export floor plans.",
        epilog=examples("rssnav plan list", "rssnav plan show flat -o flat.png"),
    )


@app.command("list", epilog=examples("rssnav plan list", "rssnav plan list --json"))
def list_plans(as_json: Json = False) -> None:
    """List the built-in plans."""
    plans = [(name, floorplans.load(name)) for name in floorplans.builtin_names()]
    if as_json:
        print_json([{"name": name, **summary_of(plan)} for name, plan in plans])
        return
    print_table(
        ("plan", ">size", ">height", ">walls", ">openings", "source", "start"),
        [
            (
                name,
                size_text(plan),
                f"{plan.height_m:g} m",
                len(plan.walls),
                count_openings(plan),
                point_text(plan.source),
                point_text(plan.start),
            )
            for name, plan in plans
        ],
    )


@app.command(
    epilog=examples(
        "rssnav plan show flat",
        "rssnav plan show flat -o flat.png",
        "rssnav plan show scenario2 --view 3d -o scenario2.svg",
        "rssnav plan show scenario2 -o scenario2.html",
    )
)
def show(
    plan: Plan,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--output",
            metavar="FILE",
            help="Output file: .png, .svg or .pdf; .html or .glb for an interactive 3D view.",
        ),
    ] = None,
    view: Annotated[
        Literal["2d", "3d"] | None,
        typer.Option(
            help="View from above, or of the walls in 3D.",
            show_default="2d; 3d for .html and .glb",
        ),
    ] = None,
    style: Style = None,
) -> None:
    """Draw a plan into a file, or sketch it in the terminal where none is given."""
    check_suffix(output, PICTURE_SUFFIXES + SOLID_SUFFIXES, "--output")
    if output is None and view == "3d":
        raise typer.BadParameter(
            "the view in three dimensions needs a file: add -o FILE.png.", param_hint="--view"
        )
    if output is not None and output.suffix.lower() in SOLID_SUFFIXES and view == "2d":
        raise typer.BadParameter(
            f"{output.suffix} is a view in three dimensions; draw from above into a .png, .svg "
            "or .pdf.",
            param_hint="--view",
        )
    loaded = floorplans.load(plan)
    if output is None:
        say(sketch(loaded))
        print_summary(loaded)
        return
    _draw(loaded, output, view, style)
    say(f"wrote {output}")


def _draw(
    plan: FloorPlan, output: Path, view: Literal["2d", "3d"] | None, style: str | None
) -> None:
    from floorplans.pictures.plan_view import save_plan_picture
    from floorplans.pictures.viewer_3d import plan_scene, save_scene
    from rssnav.pictures.style import chosen_style, drawing

    with chosen_style(style), drawing():
        if output.suffix.lower() in SOLID_SUFFIXES:
            save_scene(plan_scene(plan), output, plan.name)
        elif view == "3d":
            _draw_walls_in_3d(plan, output)
        else:
            save_plan_picture(plan, output)


def _draw_walls_in_3d(plan: FloorPlan, path: Path) -> None:
    from matplotlib.figure import Figure
    from mpl_toolkits.mplot3d import Axes3D

    from floorplans.pictures.axonometric import draw_plan_3d
    from rssnav.pictures.style import DPI, PAGE_IN

    figure = Figure(figsize=(PAGE_IN, 4.8))
    ax = figure.add_axes((0.0, 0.0, 1.0, 1.0), projection="3d")
    assert isinstance(ax, Axes3D)
    draw_plan_3d(plan, ax)
    with atomic_write(path) as beside:
        figure.savefig(beside, dpi=DPI, bbox_inches="tight")
