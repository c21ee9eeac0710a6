"""``rssnav map`` and ``rssnav maps``: radio maps of floor plans."""

import math
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer

import floorplans
from floorplans import FloorPlan
from raytrace import RadioMap, TraceConfig
from rssnav.cli.console import note, print_json, print_pairs, say, stage_progress
from rssnav.cli.options import (
    PICTURE_SUFFIXES,
    CellSize,
    Diffractions,
    Edition,
    Force,
    Frequency,
    Height,
    Json,
    MaxMemory,
    MaxPaths,
    MinPower,
    Picture,
    Plan,
    Power,
    Reflections,
    Style,
    Threads,
    Transmissions,
    check_suffix,
    examples,
    in_bytes,
)
from rssnav.kernel_cache import tracer_cache
from rssnav.maps import CELL_SIZE_M, FREQUENCY_HZ, HEIGHT_M, POWER_DBM, cells_inside, make_map


def add_to(parent: typer.Typer) -> None:
    """Add the commands ``map`` and ``maps``."""
    parent.command(
        "map",
        epilog=examples(
            "rssnav map flat -o flat.h5 --picture flat-map.png",
            "rssnav map scenario1 -o s1-coarse.h5 --reflections 2",
        ),
    )(map_plan)
    parent.command(
        "maps", epilog=examples("rssnav maps", "rssnav maps --out results/maps --threads 2")
    )(map_scenarios)


def map_plan(
    plan: Plan,
    output: Annotated[
        Path, typer.Option("-o", "--output", metavar="FILE", help="File of the map (HDF5).")
    ],
    picture: Picture = None,
    style: Style = None,
    cell_size: CellSize = CELL_SIZE_M,
    height: Height = HEIGHT_M,
    frequency: Frequency = FREQUENCY_HZ / 1e9,
    power: Power = POWER_DBM,
    reflections: Reflections = TraceConfig.max_reflections,
    diffractions: Diffractions = TraceConfig.max_diffractions,
    transmissions: Transmissions = TraceConfig.max_transmissions,
    min_power: MinPower = None,
    max_paths: MaxPaths = None,
    max_memory: MaxMemory = None,
    edition: Edition = None,
    threads: Threads = None,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Trace the radio map of a plan: RSS in every cell, from all paths of bounded order.

    A map that is up to date is not recomputed. Ctrl-C leaves the old file or none.
    """
    check_suffix(picture, PICTURE_SUFFIXES, "--picture")
    loaded = floorplans.load(plan)
    if not 0.0 < height < loaded.height_m:
        raise typer.BadParameter(
            f"{height:g} m is not between floor and ceiling of {plan}; give a height above 0 and "
            f"below {loaded.height_m:g}.",
            param_hint="--height",
        )
    with stage_progress(compiles=not tracer_cache().n_compiled) as show:
        radio_map = make_map(
            loaded,
            output,
            cell_size_m=cell_size,
            height_m=height,
            config=TraceConfig(
                reflections,
                diffractions,
                transmissions,
                -math.inf if min_power is None else min_power,
                max_paths,
            ),
            frequency_hz=frequency * 1e9,
            power_dbm=power,
            edition=edition,
            threads=threads,
            max_memory_bytes=in_bytes(max_memory),
            progress=lambda done, total: show(loaded.name, done, total),
            notice=note,
            force=force,
        )
    if picture is not None:
        _draw(loaded, radio_map, picture, style)
    summary = _summary(loaded, radio_map, output, picture)
    if as_json:
        print_json({"plan": plan, **summary})
    else:
        _print_summary(summary)


def map_scenarios(
    out: Annotated[Path, typer.Option(metavar="FOLDER", help="Folder of the maps.")] = Path(
        "results/maps"
    ),
    style: Style = None,
    max_memory: MaxMemory = None,
    threads: Threads = None,
    force: Force = False,
) -> None:
    """Trace the radio maps of the paper's two scenarios, and draw them.

    Only what has changed is recomputed.
    """
    from rssnav.experiments.paper.scenarios import PLANS

    with stage_progress(compiles=not tracer_cache().n_compiled) as show:
        for name in PLANS:
            plan, file, picture = floorplans.load(name), out / f"{name}.h5", out / f"{name}.png"

            def progress(done: int, total: int, stage: str = name) -> None:
                show(stage, done, total)

            radio_map = make_map(
                plan,
                file,
                threads=threads,
                max_memory_bytes=in_bytes(max_memory),
                progress=progress,
                notice=note,
                force=force,
            )
            if style is not None or _is_older(picture, file):
                _draw(plan, radio_map, picture, style)
    for name in PLANS:
        say(str(out / f"{name}.h5"))
        say(str(out / f"{name}.png"))


def _is_older(picture: Path, map_file: Path) -> bool:
    return not picture.exists() or picture.stat().st_mtime < map_file.stat().st_mtime


def _draw(plan: FloorPlan, radio_map: RadioMap, picture: Path, style: str | None) -> None:
    from rssnav.pictures.radio_map import save_map_picture
    from rssnav.pictures.style import chosen_style

    with chosen_style(style):
        save_map_picture(plan, radio_map, picture)


def _summary(
    plan: FloorPlan, radio_map: RadioMap, output: Path, picture: Path | None
) -> dict[str, Any]:
    covered = radio_map.rss_dbm[np.isfinite(radio_map.rss_dbm)]
    inside = cells_inside(plan, radio_map.grid)
    return {
        "file": str(output),
        "picture": None if picture is None else str(picture),
        "shape": radio_map.grid.shape,
        "cell_size_m": radio_map.grid.cell_size_m,
        "height_m": radio_map.grid.height_m,
        "cells": radio_map.rss_dbm.size,
        "cells_outside": int(np.count_nonzero(~inside)),
        "cells_without_path": int(np.count_nonzero(inside & np.isneginf(radio_map.rss_dbm))),
        "rss_dbm_min": float(covered.min()) if covered.size else None,
        "rss_dbm_max": float(covered.max()) if covered.size else None,
        "paths": int(radio_map.path_count.sum()),
        "tracing_s": radio_map.provenance["wall_time_s"],
        "plan_sha256": radio_map.plan_sha256,
    }


def _print_summary(summary: dict[str, Any]) -> None:
    n_y, n_x = summary["shape"]
    outside = summary["cells_outside"]
    outside = f", {outside} outside the building" if outside else ""
    rss = "no cell has a path"
    if summary["rss_dbm_min"] is not None:
        rss = f"{summary['rss_dbm_min']:.2f} to {summary['rss_dbm_max']:.2f} dBm"
    pairs = [
        ("map", summary["file"]),
        ("cells", f"{n_x} x {n_y}{outside}, {summary['cells_without_path']} without a path"),
        ("RSS", rss),
        ("paths", f"{summary['paths']:,}".replace(",", " ")),
        ("tracing", f"{summary['tracing_s']:.1f} s"),
    ]
    if summary["picture"] is not None:
        pairs.append(("picture", summary["picture"]))
    print_pairs(pairs)
