"""``rssnav paths``: the strongest paths from a plan's source to one receiver."""

from typing import Annotated, Any

import numpy as np
import typer
from shapely import Point

import floorplans
from floorplans import FloorPlan
from raytrace import Paths, SceneError, TraceConfig, Transmitter, trace_paths
from rssnav.cli.console import print_json, print_pairs, print_table
from rssnav.cli.options import Diffractions, Json, Plan, Reflections, examples
from rssnav.maps import FREQUENCY_HZ, HEIGHT_M, POWER_DBM, scene_of

Position = tuple[float, float, float]


def add_to(parent: typer.Typer) -> None:
    """Add the command ``paths``."""
    parent.command(
        "paths",
        epilog=examples(
            "rssnav paths flat --to 10.5,1.5 --top 5",
            "rssnav paths scenario1 --to 93.5,2.5,1.5 --reflections 3 --json",
        ),
    )(show_paths)


def _read_position(text: str) -> Position:
    """Read "x,y" or "x,y,z" [m]."""
    try:
        numbers = [float(part) for part in text.split(",")]
    except ValueError:
        numbers = []
    if len(numbers) == 2:
        numbers.append(HEIGHT_M)
    if len(numbers) != 3 or not np.isfinite(numbers).all():
        raise typer.BadParameter(f"{text!r} is not X,Y or X,Y,Z in metres, such as 10.5,1.5.")
    x, y, z = numbers
    return x, y, z


def show_paths(
    plan: Plan,
    to: Annotated[
        Any,
        typer.Option(
            "--to",
            metavar="X,Y[,Z]",
            parser=_read_position,
            help="The receiver in metres; 2 m above the floor without Z.",
        ),
    ],
    top: Annotated[
        int, typer.Option("--top", metavar="N", min=1, help="How many paths to print.")
    ] = 10,
    reflections: Reflections = TraceConfig.max_reflections,
    diffractions: Diffractions = TraceConfig.max_diffractions,
    as_json: Json = False,
) -> None:
    """Trace every path from a plan's source to a receiver and print the strongest.

    Interactions are written in their order: R a reflection, D a diffraction, LOS none.
    """
    loaded = floorplans.load(plan)
    _check_inside(loaded, plan, to)
    source = Transmitter(loaded.source, POWER_DBM, FREQUENCY_HZ)
    try:
        paths = trace_paths(
            scene_of(loaded), source, np.array([to]), TraceConfig(reflections, diffractions)
        )
    except SceneError as error:
        raise SceneError(f"{plan}: {error}") from error
    totals = _totals(paths)
    if as_json:
        rows = [_row(paths, k) for k in range(min(top, len(paths)))]
        print_json({"plan": plan, "receiver_m": to, **totals, "strongest": rows})
    else:
        _print(paths, totals, top)


def _check_inside(plan: FloorPlan, name: str, to: Position) -> None:
    x, y, z = to
    x_min, y_min, x_max, y_max = plan.bounds
    if not (plan.outline.contains(Point(x, y)) and 0.0 < z < plan.height_m):
        raise typer.BadParameter(
            f"({x:g}, {y:g}, {z:g}) is not inside {name}, which reaches from ({x_min:g}, "
            f"{y_min:g}) to ({x_max:g}, {y_max:g}) and is {plan.height_m:g} m high.",
            param_hint="--to",
        )


def _totals(paths: Paths) -> dict[str, Any]:
    """Sums over all paths: powers, coherent field, spread of the delays."""
    power = np.abs(paths.gain) ** 2
    total = float(power.sum())
    weights = power / total if total > 0.0 else power
    mean_s = float(weights @ paths.delay_s)
    return {
        "paths": len(paths),
        "rss_dbm": _dbm(total),
        "rss_coherent_dbm": _dbm(float(np.abs(paths.gain.sum()) ** 2)),
        "delay_spread_s": float(np.sqrt(weights @ (paths.delay_s - mean_s) ** 2)),
    }


def _dbm(power_gain: float) -> float:
    return POWER_DBM + 10.0 * float(np.log10(power_gain)) if power_gain > 0.0 else -np.inf


def _row(paths: Paths, k: int) -> dict[str, Any]:
    return {
        "power_dbm": float(POWER_DBM + paths.gain_db[k]),
        "length_m": float(paths.length_m[k]),
        "delay_s": float(paths.delay_s[k]),
        "interactions": paths.sequence(k),
        "vertices_m": paths.vertices[k, : paths.n_interactions[k] + 2],
    }


def _print(paths: Paths, totals: dict[str, Any], top: int) -> None:
    rows = [_row(paths, k) for k in range(min(top, len(paths)))]
    print_table(
        (">path", ">power [dBm]", ">length [m]", ">delay [ns]", "interactions"),
        [
            (
                number,
                f"{row['power_dbm']:.2f}",
                f"{row['length_m']:.3f}",
                f"{row['delay_s'] * 1e9:.2f}",
                row["interactions"],
            )
            for number, row in enumerate(rows, 1)
        ],
    )
    print_pairs(
        [
            ("all paths", totals["paths"]),
            ("RSS, sum of powers", f"{totals['rss_dbm']:.2f} dBm"),
            ("RSS, coherent sum", f"{totals['rss_coherent_dbm']:.2f} dBm"),
            ("rms delay spread", f"{totals['delay_spread_s'] * 1e9:.2f} ns"),
        ]
    )
