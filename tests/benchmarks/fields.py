"""What an unknown polarisation and a further frequency cost: make bench-fields.

    python tests/benchmarks/fields.py

traces the built-in flat and a generated office and writes a table into docs/performance.md. All
times are processor time on one thread, the best of several.
"""

import math
from dataclasses import replace

import numpy as np
from evaluation import seconds
from performance_page import machine, table, write_part

import floorplans
from raytrace import (
    Antenna,
    Grid,
    Isotropic,
    Scene,
    TraceConfig,
    Transmitter,
    compute_radio_map,
    compute_radio_maps,
)
from rssnav.presets import PRESETS
from rssnav.scenes import scene_of

HEIGHT_M, FURTHER_HZ, TIMES = 1.5, 5.2e9, 3
UNKNOWN = Isotropic(polarisation="mean")
PLANS = {
    "flat, 0.2 m": (floorplans.load("flat"), 0.2),
    "4 x 4 rooms, 0.5 m": (floorplans.generate_office(4, 4), 0.5),
}
LIMITS = {"3 transmissions": TraceConfig(3, 1, 3), "preset `building`": PRESETS["building"].config}
WIDE_DB = 15.0
HEAD = ["map", "limit", "vertical [s]", "unknown [s]", "unknown, two frequencies [s]",
        "further frequency over the first", "left out at 5.2 GHz [dB]", "alone [dB]"]  # fmt: skip


def of_one(
    scene: Scene, source: Transmitter, grid: Grid, config: TraceConfig, antenna: Antenna
) -> float:
    """Time of a map [s]."""
    sender = replace(source, antenna=antenna)
    return seconds(
        lambda: compute_radio_map(scene, sender, grid, config, receive_antenna=antenna, threads=1),
        TIMES,
    )


def row(name: str, limit: str) -> list[str]:
    """Measure one map."""
    (plan, cell_m), config = PLANS[name], LIMITS[limit]
    scene, grid = scene_of(plan), Grid.over(plan.bounds, cell_m, HEIGHT_M)
    source = Transmitter(plan.require_source(), 25.0, antenna=UNKNOWN)
    both = {"first": source, "further": replace(source, frequency_hz=FURTHER_HZ)}
    vertical, unknown = (
        of_one(scene, source, grid, config, antenna) for antenna in (Isotropic(), UNKNOWN)
    )
    two = seconds(
        lambda: compute_radio_maps(scene, both, grid, config, receive_antenna=UNKNOWN, threads=1),
        TIMES,
    )
    ratio = f"{100.0 * (two - unknown) / unknown:.0f} %"
    times = [f"{vertical:.2f}", f"{unknown:.2f}", f"{two:.2f}", ratio]
    return [name, limit, *times, *left_out(scene, both, grid, config)]


def left_out(
    scene: Scene, both: dict[str, Transmitter], grid: Grid, config: TraceConfig
) -> list[str]:
    """Say what is missing at the further frequency: with shared paths, and with its own."""
    if math.isinf(config.dynamic_range_db):
        return ["", ""]
    wide = replace(config, dynamic_range_db=config.dynamic_range_db + WIDE_DB)
    alone = [
        compute_radio_map(scene, both["further"], grid, limits, receive_antenna=UNKNOWN).rss_dbm
        for limits in (wide, config)
    ]
    shared = compute_radio_maps(scene, both, grid, config, receive_antenna=UNKNOWN)
    reached = np.isfinite(alone[0])
    found: list[str] = []
    for rss_dbm in (shared["further"].rss_dbm, alone[1]):
        missing = (alone[0] - rss_dbm)[reached]
        found.append(f"{np.median(missing):.2f}, {np.percentile(missing, 99):.2f}")
    return found


def main() -> None:
    """Measure, and write the table."""
    row("flat, 0.2 m", "3 transmissions")
    rows = [row(name, limit) for name in PLANS for limit in LIMITS]
    write_part("fields", f"{table(HEAD, rows)}\n\nMeasured on: {machine()}.")


if __name__ == "__main__":
    main()
