"""``rssnav map`` and ``rssnav maps``: radio maps of floor plans."""

from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer

import floorplans
from floorplans import FloorPlan
from raytrace import RadioMap, Scene, Transmitter, TransmitterMaps, sample_left_out
from raytrace.left_out import CONFIDENCE, LEAST_DBM, WIDER_DB
from rssnav.cli.console import (
    StageProgress,
    note,
    print_json,
    print_pairs,
    say,
    stage_progress,
)
from rssnav.cli.options import (
    PICTURE_SUFFIXES,
    UNLIMITED,
    AntennaName,
    CellSize,
    CheckLimits,
    Diffractions,
    DynamicRange,
    Edition,
    Force,
    Frequency,
    FromSeveral,
    Height,
    Json,
    MaxMemory,
    MaxPaths,
    MinPower,
    Picture,
    Plan,
    Power,
    Preset,
    ReceiveAntennaName,
    Reflections,
    Style,
    Threads,
    Transmissions,
    check_suffix,
    examples,
    in_bytes,
)
from rssnav.cli.radio import Radio, radio_of
from rssnav.first_use import compile_kernels
from rssnav.maps import CELL_SIZE_M, HEIGHT_M, cells_inside, make_map
from rssnav.presets import default_preset
from rssnav.scenes import scene_of
from rssnav.transmitter_maps import make_transmitter_maps


def add_to(parent: typer.Typer) -> None:
    """Add the commands ``map`` and ``maps``."""
    parent.command(
        "map",
        epilog=examples(
            "rssnav map flat -o flat.h5 --picture flat-map.png",
            "rssnav map scenario1 -o s1-coarse.h5 --reflections 2",
            "rssnav map flat -o flat-5ghz.h5 --preset building --from 6,4.7,2.4 --frequency 5.2",
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
    source: FromSeveral = None,
    frequency: Frequency = None,
    power: Power = None,
    antenna: AntennaName = None,
    receive_antenna: ReceiveAntennaName = None,
    preset: Preset = None,
    reflections: Reflections = None,
    diffractions: Diffractions = None,
    transmissions: Transmissions = None,
    min_power: MinPower = None,
    dynamic_range: DynamicRange = None,
    max_paths: MaxPaths = None,
    check_limits: CheckLimits = None,
    max_memory: MaxMemory = None,
    edition: Edition = None,
    threads: Threads = None,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Compute the radio map of a plan: RSS in every cell, from all paths up to a given order.

    With several transmitters, FILE holds one map for each. A map that is up to date is not
    recomputed.
    """
    check_suffix(picture, PICTURE_SUFFIXES, "--picture")
    loaded = floorplans.load(plan)
    if not 0.0 < height < loaded.height_m:
        raise typer.BadParameter(
            f"{height:g} m is not between floor and ceiling of {plan}; give a height above 0 and "
            f"below {loaded.height_m:g}.",
            param_hint="--height",
        )
    options = {
        "preset": preset, "reflections": reflections, "diffractions": diffractions,
        "transmissions": transmissions, "min_power": min_power, "max_paths": max_paths,
        "dynamic_range": dynamic_range,
        "power": power, "frequency": frequency, "antenna": antenna,
        "receive_antenna": receive_antenna,
    }  # fmt: skip
    radio = radio_of(plan, loaded, source, options)
    if check_limits is not None and not radio.config.leaves_out_weak_paths:
        raise typer.BadParameter(
            "these limits leave nothing out by its power; give --min-power, --dynamic-range or "
            "--max-paths, or --preset building.",
            param_hint="--check-limits",
        )
    with stage_progress() as show:
        compile_kernels(preset or default_preset(plan), threads=threads)
        maps = _traced(
            loaded,
            output,
            radio,
            cell_size_m=cell_size,
            height_m=height,
            edition=edition,
            threads=threads,
            max_memory_bytes=in_bytes(max_memory),
            progress=partial(show, loaded.name),
            notice=note,
            force=force,
        )
        left_out = dict[str, LeftOut]()
        if check_limits is not None:
            limits = {"threads": threads, "max_memory_bytes": in_bytes(max_memory)}
            left_out = _left_out(scene_of(loaded, edition), maps, check_limits, show, limits)
    strongest = maps.best_server_map if len(maps) > 1 else maps.first
    _note_dark_cells(loaded, strongest)
    if picture is not None:
        _draw(loaded, strongest, picture, style, list(radio.transmitters.values()))
    summary = _summary(loaded, maps, strongest) | {
        "file": str(output),
        "picture": None if picture is None else str(picture),
        "left_out": left_out,
    }
    if as_json:
        print_json({"plan": plan, **summary})
    else:
        _print_summary(summary)


def _traced(plan: FloorPlan, output: Path, radio: Radio, **options: Any) -> TransmitterMaps:
    """The maps of all transmitters; a single one is kept as the map of one transmitter."""
    shared: dict[str, Any] = {
        "config": radio.config,
        "receive_antenna": radio.receive_antenna,
        **options,
    }
    if len(radio.transmitters) > 1:
        return make_transmitter_maps(plan, radio.transmitters, output, **shared)
    ((name, transmitter),) = radio.transmitters.items()
    return TransmitterMaps({name: make_map(plan, output, transmitter=transmitter, **shared)})


LeftOut = dict[str, float]
"""What a sample of cells says of what limits leave out."""


def _left_out(
    scene: Scene,
    maps: TransmitterMaps,
    cells: int,
    show: StageProgress,
    options: dict[str, Any],
) -> dict[str, LeftOut]:
    """Trace random cells of each map again with wider limits; not of those that are all dark."""
    found: dict[str, LeftOut] = {}
    for name, radio_map in maps.items():
        if not (radio_map.rss_dbm > LEAST_DBM).any():
            note(f"no cell of {name} has more than {LEAST_DBM:g} dBm: its limits are not checked")
            continue
        progress = partial(show, f"limits, {name}")
        sample = sample_left_out(scene, radio_map, cells, progress=progress, **options)
        found[name] = {
            "cells": len(sample.points),
            "wider_db": WIDER_DB,
            "above_dbm": LEAST_DBM,
            "median_db": sample.median_db,
            "largest_db": sample.largest_db,
            "share_of_all_cells": sample.share(CONFIDENCE),
            "confidence": CONFIDENCE,
        }
    return found


def _note_dark_cells(plan: FloorPlan, radio_map: RadioMap) -> None:
    """Say what to do about cells that are shut off by walls alone."""
    dark = cells_inside(plan, radio_map.grid) & np.isneginf(radio_map.rss_dbm)
    if not dark.any():
        return
    transmissions = radio_map.config.max_transmissions
    if transmissions is None:
        remedy = "a lower power limit (--min-power)"
    else:
        remedy = f"--transmissions {UNLIMITED}, which lets paths through any number of walls"
        if transmissions == 0:
            remedy = f"--preset building, or {remedy}"
    note(f"no path reaches {dark.sum()} cells inside the building: try {remedy}")


def map_scenarios(
    out: Annotated[Path, typer.Option(metavar="FOLDER", help="Output folder.")] = Path(
        "results/maps"
    ),
    style: Style = None,
    max_memory: MaxMemory = None,
    threads: Threads = None,
    force: Force = False,
) -> None:
    """Compute and draw the radio maps of the paper's two scenarios.

    Maps that are up to date are not recomputed.
    """
    from rssnav.experiments.paper.scenarios import PLANS

    with stage_progress() as show:
        compile_kernels("paper", threads=threads)
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


def _draw(
    plan: FloorPlan,
    radio_map: RadioMap,
    picture: Path,
    style: str | None,
    transmitters: Sequence[Transmitter] = (),
) -> None:
    from rssnav.pictures.radio_map import save_map_picture
    from rssnav.pictures.style import chosen_style

    with chosen_style(style):
        save_map_picture(plan, radio_map, picture, transmitters=transmitters)


def _summary(plan: FloorPlan, maps: TransmitterMaps, radio_map: RadioMap) -> dict[str, Any]:
    """Properties of maps, and of the one that is drawn."""
    covered = radio_map.rss_dbm[np.isfinite(radio_map.rss_dbm)]
    inside = cells_inside(plan, radio_map.grid)
    return {
        "shape": radio_map.grid.shape,
        "cell_size_m": radio_map.grid.cell_size_m,
        "height_m": radio_map.grid.height_m,
        "cells": radio_map.rss_dbm.size,
        "cells_outside": int(np.count_nonzero(~inside)),
        "cells_without_path": int(np.count_nonzero(inside & np.isneginf(radio_map.rss_dbm))),
        "rss_dbm_min": float(covered.min()) if covered.size else None,
        "rss_dbm_max": float(covered.max()) if covered.size else None,
        "transmitters": {name: one.transmitter.position for name, one in maps.items()},
        "paths": int(sum(one.path_count.sum() for one in maps.values())),
        "tracing_s": sum(one.provenance["wall_time_s"] for one in maps.values()),
        "plan_sha256": radio_map.plan_sha256,
    }


def _print_summary(summary: dict[str, Any]) -> None:
    (n_y, n_x), names = summary["shape"], summary["transmitters"]
    outside = summary["cells_outside"]
    outside = f", {outside} outside the building" if outside else ""
    rss = "no cell has a path"
    if summary["rss_dbm_min"] is not None:
        rss = f"{summary['rss_dbm_min']:.2f} to {summary['rss_dbm_max']:.2f} dBm"
    pairs = [
        ("map", summary["file"]),
        *([("transmitters", ", ".join(names))] if len(names) > 1 else []),
        ("cells", f"{n_x} x {n_y}{outside}, {summary['cells_without_path']} without a path"),
        ("strongest RSS" if len(names) > 1 else "RSS", rss),
        ("paths", f"{summary['paths']:,}".replace(",", " ")),
        ("tracing", f"{summary['tracing_s']:.1f} s"),
    ]
    for name, sample in summary["left_out"].items():
        label = f"left out, {name}" if len(names) > 1 else "left out"
        pairs += zip((label, ""), _words_of(sample), strict=True)
    if summary["picture"] is not None:
        pairs.append(("picture", summary["picture"]))
    print_pairs(pairs)


def _words_of(sample: LeftOut) -> tuple[str, str]:
    """Two lines on what limits leave out."""
    return (
        f"{sample['median_db']:.2f} dB in the median, {sample['largest_db']:.2f} dB at most, in "
        f"{sample['cells']} random cells above {sample['above_dbm']:g} dBm;",
        f"no more in {sample['share_of_all_cells']:.0%} of all such cells, with "
        f"{sample['confidence']:.0%} confidence",
    )
