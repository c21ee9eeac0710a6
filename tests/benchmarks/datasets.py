"""What the engines of data sets cost besides tracing, and how they scale.

``python tests/benchmarks/datasets.py`` makes a data set of 100 maps of about 0.1 s, or of more with
``--plans``, and prints a table: processor time of tracing alone, of the command's work in one
process, and of a local Dask cluster of one and of two processes, each with the wall time.
"""

from __future__ import annotations

import argparse
import os
import sys
import tempfile
import time
import warnings
from collections.abc import Callable
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "helpers"))

from small_datasets import made, spec_of

from rssnav.datasets.engines.cluster import Cluster
from rssnav.datasets.engines.job import Engine
from rssnav.datasets.engines.threads import Threads
from rssnav.datasets.engines.warming import warm_kernels
from rssnav.datasets.tracing import Limits, trace_plan

SPEC = """
name = "benchmark"
[[plans]]
kind = "office"
seeds = {plans}
area_m2 = 300
[transmitters]
count = 10
[receivers]
cell_size_m = 0.5
[presets.benchmark]
base = "building"
reflections = 2
transmissions = 2
"""


def cpu_s() -> float:
    """Processor time of this process, and of its children that have ended [s]."""
    found = os.times()
    return found.user + found.system + found.children_user + found.children_system


def measured(work: Callable[[], object]) -> tuple[float, float]:
    """Return processor and wall time of some work [s]."""
    before, started = cpu_s(), time.perf_counter()
    work()
    return cpu_s() - before, time.perf_counter() - started


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--plans", type=int, default=10, help="of ten maps each")
    plans = parser.parse_args().plans
    warnings.simplefilter("ignore")
    text = SPEC.format(plans=plans)
    spec = spec_of(text)
    configuration = spec.configuration
    warm_kernels(configuration)

    def trace() -> None:
        for source in spec.plans:
            trace_plan(source.plan(), configuration, Limits())

    rows = [("tracing alone", *measured(trace))]
    engines: dict[str, Engine] = {
        "one thread": Threads(1),
        "two threads": Threads(2),
        "cluster of one process": Cluster(1),
        "cluster of two processes": Cluster(2),
    }
    with tempfile.TemporaryDirectory() as base:
        for name, engine in engines.items():
            folder = Path(base) / name
            rows.append((name, *measured(lambda f=folder, e=engine: made(f, text, engine=e))))
    print(f"| {10 * plans} maps | processor time [s] | wall time [s] |\n| --- | ---: | ---: |")
    for name, processor_s, wall_s in rows:
        print(f"| {name} | {processor_s:.1f} | {wall_s:.1f} |")


if __name__ == "__main__":
    main()
