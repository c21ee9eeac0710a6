"""``rssnav paths``: the strongest paths from a transmitter to one receiver."""

import csv
import sys
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer

import floorplans
from floorplans import FloorPlan
from raytrace import Paths, PathStatistics, SceneError, Transmitter, trace_paths
from rssnav.cli.console import note, print_json, print_pairs, print_table, stage_progress
from rssnav.cli.options import (
    PICTURE_SUFFIXES,
    AntennaName,
    Diffractions,
    DynamicRange,
    Edition,
    Frequency,
    From,
    Json,
    MaxMemory,
    Plan,
    Power,
    Preset,
    ReceiveAntennaName,
    Reflections,
    Style,
    Transmissions,
    check_suffix,
    examples,
    in_bytes,
)
from rssnav.cli.radio import Position, Radio, check_inside, radio_of, read_position
from rssnav.cost_notice import paths_announcement
from rssnav.scenes import scene_of

DRAWING_SUFFIXES = (*PICTURE_SUFFIXES, ".glb", ".html")
CSV_COLUMNS = ("path", "power_dbm", "length_m", "delay_s", "interactions", "vertices_m")


def add_to(parent: typer.Typer) -> None:
    """Add the command ``paths``."""
    parent.command(
        "paths",
        epilog=examples(
            "rssnav paths flat --to 10.5,1.5 --top 5",
            "rssnav paths flat --to 10.5,1.5 --only '*D*' --picture diffracted.html",
            "rssnav paths scenario1 --to 93.5,2.5,1.5 --reflections 3 --json",
            "rssnav paths flat --from 6,4.7,2.4 --to 10.5,1.5 --preset building --top 5",
        ),
    )(show_paths)


def show_paths(
    plan: Plan,
    to: Annotated[
        Any,
        typer.Option(
            "--to",
            metavar="X,Y[,Z]",
            parser=read_position,
            help="The receiver in metres; 2 m above the floor without Z.",
        ),
    ],
    top: Annotated[
        int,
        typer.Option(
            "--top", metavar="N", min=1, max=1_000_000, help="Number of paths to print and draw."
        ),
    ] = 10,
    only: Annotated[
        str,
        typer.Option(
            metavar="PATTERN",
            help="Print and draw only paths whose interactions match, such as RR, LOS or '*D*'.",
        ),
    ] = "*",
    picture: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="Draw the paths: .png, .svg or .pdf from above, .glb or .html in 3D.",
            show_default=False,
        ),
    ] = None,
    source: From = None,
    power: Power = None,
    frequency: Frequency = None,
    antenna: AntennaName = None,
    receive_antenna: ReceiveAntennaName = None,
    preset: Preset = None,
    reflections: Reflections = None,
    diffractions: Diffractions = None,
    transmissions: Transmissions = None,
    dynamic_range: DynamicRange = None,
    max_memory: MaxMemory = None,
    edition: Edition = None,
    style: Style = None,
    as_json: Json = False,
    as_csv: Annotated[bool, typer.Option("--csv", help="Print CSV.")] = False,
) -> None:
    """Trace all paths from a transmitter to a receiver and print the strongest.

    Interactions are listed in order: R reflection, D diffraction, T transmission; LOS for
    line of sight.
    """
    if as_json and as_csv:
        raise typer.BadParameter("use it or --json, not both.", param_hint="--csv")
    check_suffix(picture, DRAWING_SUFFIXES, "--picture")
    loaded = floorplans.load(plan)
    check_inside(loaded, plan, to, "--to")
    options = {
        "preset": preset, "reflections": reflections, "diffractions": diffractions,
        "transmissions": transmissions, "dynamic_range": dynamic_range, "power": power,
        "frequency": frequency,
        "antenna": antenna, "receive_antenna": receive_antenna,
    }  # fmt: skip
    radio = radio_of(plan, loaded, None if source is None else [source], options)
    transmitter = _only(radio)
    paths = _trace(loaded, plan, to, radio, transmitter, edition, in_bytes(max_memory))
    chosen, power_dbm = _chosen(paths, only, top), transmitter.power_dbm
    if picture is not None:
        _draw(loaded, chosen, only, power_dbm, picture, style)
    totals = _totals(paths, power_dbm)
    rows = [_row(chosen, k, power_dbm) for k in range(len(chosen))]
    if as_json:
        ends = {"transmitter_m": transmitter.position, "receiver_m": to}
        print_json({"plan": plan, **ends, **totals, "strongest": rows})
    elif as_csv:
        _print_csv(rows)
    else:
        _print(rows, totals)


def _only(radio: Radio) -> Transmitter:
    """The one transmitter; several are wrong usage."""
    if len(radio.transmitters) > 1:
        raise typer.BadParameter(
            f"choose one of the transmitters {', '.join(radio.transmitters)}.", param_hint="--from"
        )
    return next(iter(radio.transmitters.values()))


def _trace(
    plan: FloorPlan,
    name: str,
    to: Position,
    radio: Radio,
    transmitter: Transmitter,
    edition: str | None,
    max_memory_bytes: int | None,
) -> Paths:
    """All paths to a receiver, strongest first."""
    try:
        scene = scene_of(plan, edition)
        announced = scene, transmitter, to, radio.config, max_memory_bytes
        with stage_progress():
            if (words := paths_announcement(*announced)) is not None:
                note(words)
            return trace_paths(
                scene,
                transmitter,
                np.array([to]),
                radio.config,
                receive_antenna=radio.receive_antenna,
                max_memory_bytes=max_memory_bytes,
            )
    except SceneError as error:
        raise SceneError(f"{name}: {error}") from error


def _chosen(paths: Paths, only: str, top: int) -> Paths:
    """The strongest paths whose interactions match a pattern."""
    rows = [k for k in range(len(paths)) if fnmatchcase(paths.sequence(k), only.upper())]
    return paths.rows(np.array(rows[:top], dtype=np.int64))


def _draw(
    plan: FloorPlan, paths: Paths, only: str, power_dbm: float, picture: Path, style: str | None
) -> None:
    """Draw paths into a file, or print a note if there are none."""
    from rssnav.pictures.paths import save_paths_picture
    from rssnav.pictures.style import chosen_style

    if not len(paths):
        note(f"no path to draw; {picture} is not written")
        return
    x, y, z = paths.vertices[0, -1]
    kind = "" if only == "*" else f" {only.upper()}"
    what = f"the {len(paths)} strongest paths" if len(paths) > 1 else "the strongest path"
    title = f"{plan.name}: {what}{kind} to ({x:g}, {y:g}, {z:g}) m"
    with chosen_style(style):
        save_paths_picture(plan, paths, power_dbm, title, picture)


def _totals(paths: Paths, power_dbm: float) -> dict[str, Any]:
    """Sums over all paths: powers, coherent field, delays, directions."""
    s = PathStatistics.of(paths, power_dbm, 1)
    return {
        "paths": int(s.path_count[0]),
        "rss_dbm": float(s.rss_dbm[0]),
        "rss_coherent_dbm": float(s.rss_coherent_dbm[0]),
        "mean_delay_s": float(s.mean_delay_s[0]),
        "delay_spread_s": float(s.delay_spread_s[0]),
        "angular_spread": float(s.angular_spread[0]),
        "k_factor_db": float(s.k_factor_db[0]),
    }


def _row(paths: Paths, k: int, power_dbm: float) -> dict[str, Any]:
    return {
        "power_dbm": float(power_dbm + paths.gain_db[k]),
        "length_m": float(paths.length_m[k]),
        "delay_s": float(paths.delay_s[k]),
        "interactions": paths.sequence(k),
        "vertices_m": paths.vertices[k, : paths.n_interactions[k] + 2],
    }


def _print(rows: list[dict[str, Any]], totals: dict[str, Any]) -> None:
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
            ("mean delay", f"{totals['mean_delay_s'] * 1e9:.2f} ns"),
            ("rms delay spread", f"{totals['delay_spread_s'] * 1e9:.2f} ns"),
            ("angular spread", f"{totals['angular_spread']:.3f} (0 to 1)"),
            ("K factor", f"{totals['k_factor_db']:.2f} dB"),
        ]
    )


def _print_csv(rows: list[dict[str, Any]]) -> None:
    """Print a line per path, with its vertices as "x y z; x y z"."""
    table = csv.writer(sys.stdout, lineterminator="\n")
    table.writerow(CSV_COLUMNS)
    for number, row in enumerate(rows, 1):
        places = "; ".join(" ".join(f"{c:.9g}" for c in vertex) for vertex in row["vertices_m"])
        numbers = (row[key] for key in ("power_dbm", "length_m", "delay_s"))
        table.writerow([number, *numbers, row["interactions"], places])
