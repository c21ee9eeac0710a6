"""What a limit by loss costs and leaves out, beside a number of transmissions: make bench-loss.

    python tests/benchmarks/loss_limits.py

traces generated offices with three reflections and one diffraction, and writes a table into
docs/performance.md. The error is the difference from the map with the widest range.
"""

import argparse
import math
import time
from typing import NamedTuple

import numpy as np
from performance_page import machine, table, write_part

from floorplans import generate_office
from raytrace import (
    Grid,
    Isotropic,
    RadioMap,
    Scene,
    TraceConfig,
    Transmitter,
    compute_radio_map,
)

HEIGHT_M, POWER_DBM, SENSITIVITY_DBM = 1.5, 25.0, -120.0


class Office(NamedTuple):
    """Rooms of a row, rows, side of a cell [m], and dynamic ranges by rising order [dB]."""

    rooms_x: int
    rooms_y: int
    cell_m: float
    ranges_db: tuple[float, ...]


OFFICES = (Office(4, 4, 0.5, (20.0, 25.0, 30.0, 40.0)), Office(15, 10, 4.0, (15.0, 20.0)))


def prepared(office: Office) -> tuple[Scene, Transmitter, Grid]:
    """Return what maps of an office are traced from."""
    plan = generate_office(office.rooms_x, office.rooms_y)
    walls = plan.to_mesh()
    scene = Scene.from_mesh(walls.mesh, walls.face_material, walls.materials)
    source = Transmitter(plan.source, POWER_DBM, antenna=Isotropic())
    return scene, source, Grid.over(plan.bounds, office.cell_m, HEIGHT_M)


def traced(office: Office, config: TraceConfig) -> tuple[RadioMap, float]:
    """Return a map, and the processor time that it took [s]."""
    scene, source, grid = prepared(office)
    started = time.process_time()
    radio_map = compute_radio_map(scene, source, grid, config, receive_antenna=Isotropic())
    return radio_map, time.process_time() - started


def limits(office: Office) -> dict[str, TraceConfig]:
    """Limits to compare, the widest range last."""
    by_loss = {
        f"{range_db:g} dB": TraceConfig(3, 1, None, SENSITIVITY_DBM, dynamic_range_db=range_db)
        for range_db in office.ranges_db
    }
    return {"3 transmissions": TraceConfig(3, 1, 3), **by_loss}


def rows_of(office: Office) -> list[list[str]]:
    """Rows of the table."""
    found = {name: traced(office, config) for name, config in limits(office).items()}
    widest = list(found)[-1]
    best = found[widest][0].rss_dbm
    rows: list[list[str]] = []
    for name, (radio_map, seconds) in found.items():
        rss, left_out = radio_map.rss_dbm, radio_map.left_out_db
        seen = np.isfinite(rss) & (best > SENSITIVITY_DBM)
        error, certified = f"{np.abs(best[seen] - rss[seen]).max():.2f}", ""
        if name == widest:
            error = ""
        if not math.isinf(radio_map.config.min_power_dbm) and left_out is not None:
            bound_db = 10.0 * np.log10(1.0 + 10.0 ** (left_out[seen] / 10.0))
            certified = f"{np.median(bound_db):.0f}"
        dark = int((~np.isfinite(rss) & (best > SENSITIVITY_DBM)).sum())
        rows.append(
            [f"{office.rooms_x} x {office.rooms_y}, {office.cell_m:g} m", name, f"{seconds:.1f}",
             f"{radio_map.path_count.sum() / 1e6:.2f}", f"{dark} of {rss.size}", error, certified]
        )  # fmt: skip
    return rows


PART = """\
## Limits by loss

`make bench-loss` traces generated offices (`floorplans.generate_office`, walls of plasterboard)
with 3 reflections, 1 diffraction, 25 dBm and isotropic antennas: with 3 transmissions, and with
any number of them as far as paths are stronger than -120 dBm and not more than the given range
below what is reflected and transmitted to their receiver. Times are those of all threads
together. A cell is dark where it has no path, but more than -120 dBm with the widest range;
*error* is the largest difference from that map, *bound* the median over cells of what
`left_out_db` certifies. The bound counts every path that could exist in the beams that were not
grown; it says little in such a building.
"""


def main() -> None:
    """Measure and write."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.parse_args()
    for config in limits(OFFICES[0]).values():
        traced(Office(2, 1, 8.0, ()), config)
    head = ["office", "limit", "CPU [s]", "million paths", "dark cells", "error [dB]", "bound [dB]"]
    rows = [row for office in OFFICES for row in rows_of(office)]
    write_part("loss", f"{PART}\n{table(head, rows)}\n\nMeasured on: {machine()}.")


if __name__ == "__main__":
    main()
