"""How time and memory grow with cells, rooms and order: make bench-growth.

    python tests/benchmarks/growth.py --minutes 5

traces generated offices, each map in a process of its own, and writes curves to
docs/images/growth.png and a table into docs/performance.md. A map with a predicted cost
above the limit is skipped, and the page lists it. Finished maps are kept in
results/growth.json; the next call resumes from there, and --again starts from the beginning.
"""

import argparse
import json
import resource
import subprocess
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import matplotlib.pyplot as plt
from performance_page import PAGE, machine, table, write_part

from atomicfiles import atomic_write
from floorplans import generate_office
from raytrace import (
    CostEstimate,
    Grid,
    Scene,
    TraceConfig,
    Transmitter,
    compute_radio_map,
    estimate_cost,
)

HEIGHT_M = 1.5
KEPT = Path("results/growth.json")
PICTURE = PAGE.parent / "images" / "growth.png"

Finished = dict[str, dict[str, Any]]


class Size(NamedTuple):
    """A map of an office: rooms of a row, rows, side of a cell [m], reflections."""

    rooms_x: int
    rooms_y: int
    cell_m: float
    order: int

    @property
    def name(self) -> str:
        """Key of the map among the finished ones."""
        return f"{self.rooms_x}x{self.rooms_y} {self.cell_m:g} m {self.order}"

    @property
    def rooms(self) -> int:
        """Number of rooms."""
        return self.rooms_x * self.rooms_y


OFFICES = ((2, 1), (3, 2), (4, 4), (6, 5), (10, 6), (12, 8), (15, 10))
CURVES: dict[str, tuple[Size, ...]] = {
    "cells": tuple(Size(4, 4, cell, 4) for cell in (4.0, 2.0, 1.0, 0.5, 0.25)),
    "rooms": tuple(Size(x, y, 1.0, 4) for x, y in OFFICES),
    "order": tuple(Size(4, 4, 1.0, order) for order in range(1, 8)),
    "whole building": tuple(Size(15, 10, 0.5, order) for order in (2, 3, 4, 5, 6)),
}
"""15 x 10 rooms stand on 152 m x 90 m: 55 000 cells of 0.5 m."""


def prepared(size: Size) -> tuple[Scene, Transmitter, Grid, TraceConfig]:
    """Return what a map is traced from."""
    plan = generate_office(size.rooms_x, size.rooms_y)
    walls = plan.to_mesh()
    scene = Scene.from_mesh(walls.mesh, walls.face_material, walls.materials)
    grid = Grid.over(plan.bounds, size.cell_m, HEIGHT_M)
    return scene, Transmitter(plan.source), grid, TraceConfig(size.order, 1)


def measure(size: Size, limit_s: float) -> dict[str, Any]:
    """Estimate a map's cost, and trace it unless that is over the limit."""
    scene, source, grid, config = prepared(size)
    few = Grid(grid.x[::8], grid.y[::8], HEIGHT_M, size.cell_m)
    compute_radio_map(scene, source, few, TraceConfig(1, 1))
    cost = estimate_cost(scene, source, grid, config)
    result = {"cells": grid.x.size * grid.y.size, "predicted_s": cost.seconds}
    if cost.seconds > limit_s:
        return {**result, "skipped": True, "predicted_paths": cost.paths}
    started = time.perf_counter()
    radio_map = compute_radio_map(scene, source, grid, config)
    seconds = time.perf_counter() - started
    return {**result, **_measured(radio_map.path_count.sum(), seconds, cost)}


def _measured(paths: int, seconds: float, cost: CostEstimate) -> dict[str, Any]:
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
    return {
        "paths": int(paths),
        "predicted_paths": cost.paths,
        "seconds": seconds,
        "peak_bytes": peak,
    }


def in_own_process(size: Size, limit_s: float) -> dict[str, Any]:
    """Measure in a fresh process, for its memory; end it at three times the limit."""
    command = [sys.executable, __file__, "--one", json.dumps(size), "--minutes", f"{limit_s / 60}"]
    most_s = 3.0 * limit_s + 60.0
    try:
        done = subprocess.run(
            command, check=True, stdout=subprocess.PIPE, text=True, timeout=most_s
        )
    except subprocess.TimeoutExpired:
        return {"predicted_s": most_s, "skipped": True}
    return json.loads(done.stdout)


def run(sizes: Sequence[Size], limit_s: float, finished: Finished) -> None:
    """Measure what is not finished, keeping each result at once."""
    for k, size in enumerate(sizes, 1):
        found = finished.get(size.name)
        if found and not ("skipped" in found and found["predicted_s"] <= limit_s):
            continue
        print(f"{k} of {len(sizes)}: {size.name}", file=sys.stderr)
        finished[size.name] = in_own_process(size, limit_s)
        KEPT.parent.mkdir(parents=True, exist_ok=True)
        with atomic_write(KEPT) as place:
            place.write_text(json.dumps(finished, indent=1))


def draw(finished: Finished) -> None:
    """Draw time and memory over cells, rooms and order."""
    figure, rows = plt.subplots(2, 3, figsize=(10.0, 5.6), sharey="row", layout="constrained")
    labels = ("cells, 16 rooms, order 4", "rooms, 1 m cells, order 4", "order, 16 rooms, 1 m cells")
    for column, (curve, label) in enumerate(zip(("cells", "rooms", "order"), labels, strict=True)):
        sizes = [s for s in CURVES[curve] if "seconds" in finished.get(s.name, {})]
        values = [finished[s.name] for s in sizes]
        at = {
            "cells": [v["cells"] for v in values],
            "rooms": [s.rooms for s in sizes],
            "order": [s.order for s in sizes],
        }[curve]
        if not sizes:
            continue
        time_axes, memory_axes = rows[0, column], rows[1, column]
        time_axes.plot(at, [v["seconds"] for v in values], "o-", color="C0")
        memory_axes.plot(at, [v["peak_bytes"] / 2**20 for v in values], "s-", color="C1")
        time_axes.set_yscale("log")
        memory_axes.set_xlabel(label)
        if curve != "order":
            time_axes.set_xscale("log")
            memory_axes.set_xscale("log")
            for axes in (time_axes, memory_axes):
                axes.set_xticks(at, [f"{value}" for value in at])
    rows[1, 0].set_ylim(bottom=0.0)
    rows[0, 0].set_ylabel("time [s]")
    rows[1, 0].set_ylabel("peak memory [MB]")
    for axes in rows.flat:
        axes.minorticks_off()
        axes.grid(alpha=0.3)
    figure.savefig(PICTURE, dpi=110)


def page(finished: Finished, limit_s: float) -> str:
    """Return the part of the page: introduction, picture, table, and what was skipped."""
    head = ["office", "cell [m]", "cells", "order", "paths", "predicted", "time [s]",
            "predicted [s]", "peak memory [MB]"]  # fmt: skip
    sizes = list(dict.fromkeys(s for curve in CURVES.values() for s in curve))
    rows, skipped = [], []
    for size in [size for size in sizes if size.name in finished]:
        found = finished[size.name]
        office = f"{size.rooms_x} x {size.rooms_y} rooms"
        if "skipped" in found:
            skipped.append(f"{office}, {size.cell_m:g} m, order {size.order}")
            continue
        rows.append(
            [office, f"{size.cell_m:g}", f"{found['cells']}", f"{size.order}", f"{found['paths']}",
             f"{found['predicted_paths']}", f"{found['seconds']:.2g}",
             f"{found['predicted_s']:.2g}", f"{found['peak_bytes'] / 2**20:.0f}"]
        )  # fmt: skip
    left_out = f" Skipped, at more than {limit_s / 60:g} minutes: {'; '.join(skipped)}."
    left_out = left_out if skipped else ""
    return f"{INTRODUCTION}\n\n{table(head, rows)}\n\nMeasured on: {machine()}.{left_out}"


INTRODUCTION = """\
## Scaling

`make bench-growth` traces offices of 2 to 150 rooms (`floorplans.generate_office`) with reflections
up to the given order and one diffraction, on all threads, with compiled kernels. *Predicted* is the
result of `raytrace.estimate_cost`; peak memory is that of the whole process, including Python and
compiled kernels.

![Time and memory over cells, rooms and order](images/growth.png)"""


def main() -> None:
    """Measure, draw and write."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--minutes", type=float, default=5.0, help="skip maps over this")
    parser.add_argument("--most-rooms", type=int, default=150, help="skip larger offices")
    parser.add_argument("--again", action="store_true", help="forget what is finished")
    parser.add_argument("--one", help=argparse.SUPPRESS)
    chosen = parser.parse_args()
    limit_s = 60.0 * chosen.minutes
    if chosen.one:
        print(json.dumps(measure(Size(*json.loads(chosen.one)), limit_s)))
        return
    finished = json.loads(KEPT.read_text()) if KEPT.exists() and not chosen.again else {}
    sizes = [s for curve in CURVES.values() for s in curve if s.rooms <= chosen.most_rooms]
    run(sizes, limit_s, finished)
    draw(finished)
    write_part("growth", page(finished, limit_s))


if __name__ == "__main__":
    main()
