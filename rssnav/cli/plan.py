"""``rssnav plan``: look at floor plans, check them, export them."""

from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
import typer

import floorplans
from floorplans import FloorPlan
from raytrace import Grid, RadioMap, TraceConfig, Transmitter
from rssnav import GridWorld, WorldError, shortest_path
from rssnav.cli import plan_new
from rssnav.cli.console import print_json, print_pairs, print_table
from rssnav.cli.options import PICTURE_SUFFIXES, Json, Plan, check_suffix, examples
from rssnav.cli.plan_sketch import sketch
from rssnav.files import whole_file
from rssnav.maps import CELL_SIZE_M, HEIGHT_M, scene_of
from rssnav.world import GOAL_DISTANCE_M

SOLID_SUFFIXES = (".html", ".glb")
MESH_SUFFIXES = (".glb", ".ply", ".stl", ".obj")
SPEEDS = (1, 2, 4)

Facts = list[dict[str, Any]]

app = typer.Typer(no_args_is_help=True, rich_markup_mode="rich")


def add_to(parent: typer.Typer) -> None:
    """Add the commands below ``plan``."""
    for part in (plan_new,):
        part.add_to(app)
    parent.add_typer(
        app,
        name="plan",
        help="Look at floor plans, check them, export them.",
        epilog=examples("rssnav plan list", "rssnav plan show flat -o flat.png"),
    )


@app.command("list", epilog=examples("rssnav plan list", "rssnav plan list --json"))
def list_plans(as_json: Json = False) -> None:
    """List the built-in plans."""
    plans = [(name, floorplans.load(name)) for name in floorplans.builtin_names()]
    if as_json:
        print_json([{"name": name, **_facts(plan)} for name, plan in plans])
        return
    print_table(
        ("plan", ">size", ">height", ">walls", ">openings", "source", "start"),
        [
            (
                name,
                _size(plan),
                f"{plan.height_m:g} m",
                len(plan.walls),
                _n_openings(plan),
                _point(plan.source),
                _point(plan.start),
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
            help="Draw into a .png, .svg or .pdf; an .html or .glb is a view to turn and zoom.",
        ),
    ] = None,
    view: Annotated[
        Literal["2d", "3d"] | None,
        typer.Option(
            help="From above, or walls in three dimensions.",
            show_default="2d; 3d for .html and .glb",
        ),
    ] = None,
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
        print(sketch(loaded))
        print_facts(loaded)
        return
    _draw(loaded, output, view)
    print(f"wrote {output}")


def _draw(plan: FloorPlan, output: Path, view: Literal["2d", "3d"] | None) -> None:
    from floorplans.drawing import save_plan_picture
    from floorplans.viewer_3d import plan_scene, save_scene

    with whole_file(output) as beside:
        if output.suffix.lower() in SOLID_SUFFIXES:
            save_scene(plan_scene(plan), beside, plan.name)
        elif view == "3d":
            _draw_walls_in_3d(plan, beside)
        else:
            save_plan_picture(plan, beside)


def _draw_walls_in_3d(plan: FloorPlan, path: Path) -> None:
    from matplotlib.figure import Figure
    from mpl_toolkits.mplot3d import Axes3D

    from floorplans.drawing import draw_plan_3d

    figure = Figure(figsize=(9.0, 6.0))
    ax = figure.add_axes((0.0, 0.0, 1.0, 1.0), projection="3d")
    assert isinstance(ax, Axes3D)
    draw_plan_3d(plan, ax)
    figure.savefig(path, dpi=200, bbox_inches="tight")


@app.command(epilog=examples("rssnav plan check flat", "rssnav plan check scenario1 --json"))
def check(plan: Plan, as_json: Json = False) -> None:
    """Check a plan: the file, the walls, and whether the source can be reached.

    Ends with 1 and a message that names file, key and remedy at the first fault.
    """
    loaded = floorplans.load(plan)
    scene_of(loaded)
    flights = _flights(loaded)
    if as_json:
        print_json({"plan": plan, **_facts(loaded), "flights": flights})
        return
    print_facts(loaded)
    print()
    print("shortest flight from the start to the source")
    print_table(
        (">speed", ">steps", ">length", ""),
        [
            (f["speed"], f["steps"], f"{f['length_m']:.2f} m", "")
            if f["steps"] is not None
            else (f["speed"], "-", "-", "the source cannot be reached at this speed")
            for f in flights
        ],
    )
    print(f"\n{plan} is in order")


def _flights(plan: FloorPlan) -> Facts:
    """Fewest steps from start to source at each speed; WorldError where no speed gets there."""
    flights: Facts = []
    last_error: WorldError | None = None
    radio_map = _map_without_readings(plan)
    for speed in SPEEDS:
        try:
            world = GridWorld.from_map(plan, radio_map, speed)
        except WorldError as error:
            last_error = error
            flights.append({"speed": speed, "steps": None, "length_m": None})
            continue
        path = shortest_path(world, world.distance_m < GOAL_DISTANCE_M)
        flights.append({"speed": speed, "steps": path.steps, "length_m": path.length_m})
    if last_error is not None and all(flight["steps"] is None for flight in flights):
        raise last_error
    return flights


def _map_without_readings(plan: FloorPlan) -> RadioMap:
    """Make a map that reads 0 dBm everywhere, for what depends on the walls alone."""
    grid = Grid.over(plan.bounds, CELL_SIZE_M, min(HEIGHT_M, 0.5 * plan.height_m))
    zeros = np.zeros(grid.shape)
    return RadioMap(
        rss_dbm=zeros,
        rss_coherent_dbm=zeros,
        path_count=zeros.astype(np.int64),
        grid=grid,
        transmitter=Transmitter(plan.source),
        config=TraceConfig(),
        plan_sha256=plan.sha256,
    )


@app.command(epilog=examples("rssnav plan export flat -o flat.glb"))
def export(
    plan: Plan,
    output: Annotated[
        Path,
        typer.Option("-o", "--output", metavar="FILE", help="A .glb, .ply, .stl or .obj."),
    ],
) -> None:
    """Write a plan's walls, floor and ceiling as a mesh, in metres, z up."""
    check_suffix(output, MESH_SUFFIXES, "--output")
    mesh = floorplans.load(plan).to_mesh().mesh
    with whole_file(output) as beside:
        mesh.export(beside)
    print(f"wrote {output}: {len(mesh.faces)} triangles")


def _facts(plan: FloorPlan) -> dict[str, Any]:
    return {
        "title": plan.name,
        "bounds_m": plan.bounds,
        "height_m": plan.height_m,
        "area_m2": plan.outline.area,
        "walls": len(plan.walls),
        "openings": _n_openings(plan),
        "materials": _materials(plan),
        "source_m": plan.source,
        "start_m": plan.start,
        "sha256": plan.sha256,
    }


def print_facts(plan: FloorPlan) -> None:
    """Print what a plan is, a line a property."""
    print_pairs(
        [
            ("plan", plan.name),
            ("size", f"{_size(plan)}, {plan.height_m:g} m high, {plan.outline.area:g} m²"),
            ("walls", f"{len(plan.walls)} straight pieces with {_n_openings(plan)} openings"),
            ("materials", ", ".join(_materials(plan))),
            ("source", f"{_point(plan.source)} m"),
            ("start", f"{_point(plan.start)} m"),
        ]
    )


def _materials(plan: FloorPlan) -> tuple[str, ...]:
    """Names of all materials of a plan, each once."""
    return tuple(dict.fromkeys(sheet.name for sheet in plan.to_mesh().materials))


def _n_openings(plan: FloorPlan) -> int:
    return sum(len(wall.openings) for wall in plan.walls)


def _size(plan: FloorPlan) -> str:
    x_min, y_min, x_max, y_max = plan.bounds
    return f"{x_max - x_min:g} x {y_max - y_min:g} m"


def _point(point: tuple[float, ...]) -> str:
    return f"({', '.join(f'{c:g}' for c in point)})"
