"""The same plans through rssnav, Sionna RT and pyroomacoustics, side by side: make bench-peers.

    python tests/benchmarks/peers.py --sionna PYTHON

traces the flat and a small office to receivers drawn at random, path by path, and writes the
tables into docs/performance.md. rssnav's paths are those of the brute force (tests/brute_force.py);
the tables count how many of them the others find, and their spurious paths. PYTHON
has sionna-rt, which needs libLLVM 17 or newer; without it the tables lack Sionna RT.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from peer_workers import plan_named
from performance_page import machine, table, write_part
from scipy.spatial import cKDTree

from floorplans.exporters import ExportOptions, export

sys.path.insert(0, str(Path(__file__).parents[1]))
from brute_force import Found
from brute_force_facets import Facets
from brute_force_field import Radio, path_gains

from raytrace import Isotropic, Transmitter

Floats = NDArray[np.float64]

HERE = Path(__file__).parent
FREQUENCY_HZ = 2.4e9
N_RECEIVERS = 24
SAME_M = 0.005
"""Paths whose points are this near to each other are the same [m]; others compute in float32."""

PLANS = ("flat", "office")
LIMITS = {"reflections": (3, 0), "with one diffraction": (2, 1)}
SHARED_LIBRARIES = ("/usr/lib", "/usr/local/lib", "/opt/homebrew/opt/llvm/lib")


class Case(NamedTuple):
    """A plan and how many reflections and diffractions are allowed."""

    plan: str
    max_reflections: int
    max_diffractions: int


@dataclass(frozen=True)
class Run:
    """What a tracer found; `points` (n, k) tell paths apart, `gain` (n,) where it gives one."""

    seconds: float
    peak_mb: float
    points: Floats
    gain: NDArray[np.complex128] | None
    raw: dict[str, NDArray]


def request_for(case: Case, n_receivers: int, folder: Path) -> dict:
    """Write the plan for Sionna RT and say what is asked for."""
    plan = plan_named(case.plan)
    scene, *_ = export(
        plan, folder / f"{case.plan}.xml", "sionna", ExportOptions(frequency_hz=FREQUENCY_HZ)
    )
    x_min, y_min, x_max, y_max = plan.bounds
    low, high = (x_min + 0.2, y_min + 0.2, 0.5), (x_max - 0.2, y_max - 0.2, plan.height_m - 0.5)
    receivers = np.random.default_rng(81).uniform(low, high, (n_receivers, 3))
    return {
        "plan": case.plan, "scene": str(scene), "frequency_hz": FREQUENCY_HZ,
        "source": list(plan.source), "receivers": receivers.tolist(),
        "max_reflections": case.max_reflections, "max_diffractions": case.max_diffractions,
    }  # fmt: skip


def run(command: list[str], request: dict, folder: Path) -> dict[str, NDArray] | None:
    """Run a tracer in a process of its own; None, and a message, where it cannot."""
    asked, result = folder / "request.json", folder / "result.npz"
    asked.write_text(json.dumps(request))
    environment = {**os.environ, **newest_llvm()}
    done = subprocess.run(
        [*command, str(asked), str(result)], env=environment, capture_output=True, text=True
    )
    if done.returncode:
        last = done.stderr.strip().splitlines()[-1:] or ["no message"]
        print(f"  {' '.join(command)} did not run: {last[0]}", file=sys.stderr)
        return None
    with np.load(result) as file:
        return {name: file[name] for name in file.files}


def newest_llvm() -> dict[str, str]:
    """Tell Sionna RT where the newest libLLVM is, unless the environment does."""
    found = [p for place in SHARED_LIBRARIES for p in Path(place).glob("**/libLLVM-[0-9]*.so*")]
    versions = {p.name.removeprefix("libLLVM-").split(".")[0]: p for p in found}
    numbers = [int(v) for v in versions if v.isdigit()]
    if "DRJIT_LIBLLVM_PATH" in os.environ or not numbers:
        return {}
    return {"DRJIT_LIBLLVM_PATH": str(versions[str(max(numbers))])}


def as_run(found: dict[str, NDArray], case: Case) -> Run:
    """Return paths within the limits; what tells them apart depends on what a tracer gives."""
    seconds, peak_mb = float(found["seconds"]), float(found["peak_bytes"]) / 2**20
    receiver = 1e3 * found["receiver"][:, None]
    if "length_m" in found:
        return Run(seconds, peak_mb, np.hstack([receiver, found["length_m"][:, None]]), None, found)
    kinds, n = found["interactions"], len(found["receiver"])
    width = case.max_reflections + case.max_diffractions
    reflections, diffractions = ((kinds == k).sum(axis=1) for k in (1, 2))
    kept = (reflections <= case.max_reflections) & (diffractions <= case.max_diffractions)
    flat = found["vertices"][:, : width + 2].reshape(n, -1)
    points = np.hstack([receiver, 10.0 * kinds[:, :width], flat])
    raw = {name: found[name][kept] for name in ("receiver", "interactions", "vertices", "gain")}
    return Run(seconds, peak_mb, points[kept], found["gain"][kept], raw)


def lengths_of(ours: Run) -> Floats:
    """Return receiver and length of paths, to compare with a tracer that gives no points."""
    steps = np.diff(ours.raw["vertices"], axis=1)
    length = np.linalg.norm(steps, axis=2).sum(axis=1)
    return np.column_stack([1e3 * ours.raw["receiver"], length])


def compare(ours: Run, theirs: Run, exact: NDArray[np.complex128]) -> list[str]:
    """Found, missed, beside them and twice; dB off the textbook's gain, median and most."""
    points = ours.points if theirs.gain is not None else lengths_of(ours)
    far, theirs_of = cKDTree(theirs.points).query(points, distance_upper_bound=SAME_M)
    beside, ours_of = cKDTree(points).query(theirs.points, distance_upper_bound=SAME_M)
    found = np.isfinite(far)
    known = np.isfinite(beside)
    twice = int(known.sum()) - len(set(ours_of[known].tolist()))
    cells = [f"{found.sum()}", f"{(~found).sum()}", f"{(~known).sum()}", f"{twice}"]
    if theirs.gain is None:
        return [*cells, "", ""]
    gain, reference = np.abs(theirs.gain[theirs_of[found]]), np.abs(exact[found])
    heard = (reference > 1e-8) & (gain > 0.0)
    off = np.abs(20.0 * np.log10(gain[heard] / reference[heard]))
    return [*cells, f"{np.median(off):.2g}", f"{off.max():.2g}"]


def textbook_gains(ours: Run, case: Case) -> NDArray[np.complex128]:
    """Gain of each path by the formulas alone: slabs, and Kouyoumjian and Pathak's wedge."""
    plan = plan_named(case.plan)
    walls = plan.to_mesh()
    facets = Facets(np.asarray(walls.mesh.triangles), walls.face_material)
    found = Found(*(ours.raw[n].astype(t) for n, t in (("receiver", int), ("interactions", int))),
                  ours.raw["vertices"])  # fmt: skip
    source = Transmitter(tuple(plan.source), frequency_hz=FREQUENCY_HZ, antenna=Isotropic())
    return path_gains(facets, found, Radio(walls.materials, source, Isotropic()))


def rows_of(
    case: Case, request: dict, commands: dict[str, list[str]], folder: Path
) -> list[list[str]]:
    """Return one row for each tracer that can do a case."""
    what = next(words for words, limits in LIMITS.items() if limits == case[1:])
    rows: list[list[str]] = []
    for name, command in commands.items():
        if case.max_diffractions and name == "pyroomacoustics":
            continue
        print(f"{case.plan}, {what}: {name}", file=sys.stderr)
        found = run(command, request, folder)
        if found is None:
            continue
        result = as_run(found, case)
        if not rows:
            ours, exact = result, textbook_gains(result, case)
        cells = compare(ours, result, exact)
        first = [f"{case.plan}, {what}", name]
        rows.append([*first, f"{result.seconds:.2g}", f"{result.peak_mb:.0f}", *cells])
    return rows


def main() -> None:
    """Trace every case with every tracer that is there and write the table."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--sionna", metavar="PYTHON", help="a Python that has sionna-rt")
    parser.add_argument("--receivers", type=int, default=N_RECEIVERS, help="how many")
    chosen = parser.parse_args()
    own = [sys.executable, str(HERE / "peer_workers.py")]
    commands = {name: [*own, name] for name in ("rssnav", "pyroomacoustics")}
    if chosen.sionna:
        commands["Sionna RT"] = [chosen.sionna, str(HERE / "sionna_worker.py")]
    cases = [Case(plan, *limits) for plan in PLANS for limits in LIMITS.values()]
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        rows = [
            row
            for case in cases
            for row in rows_of(case, request_for(case, chosen.receivers, folder), commands, folder)
        ]
    head = ["plan", "tracer", "time [s]", "peak memory [MB]", "found", "missed", "spurious",
            "duplicate", "median [dB]", "max [dB]"]  # fmt: skip
    introduction = INTRODUCTION.format(chosen.receivers)
    text = f"{introduction}\n\n{table(head, rows)}\n\nMeasured on: {machine()}."
    write_part("peers", text)
    print(text)


INTRODUCTION = """\
## Comparison with other tracers

`make bench-peers` traces the flat and an office of two rooms from their transmitter to {} random
receivers, with up to three reflections, or two reflections and a diffraction, at 2.4 GHz with
vertically polarised isotropic antennas. The tracers are rssnav, Sionna RT (CPU, a million rays, no
transmission) and pyroomacoustics, which has neither diffraction nor fields. Each runs twice in its
own process; the second run is timed. *Found* and *missed* count rssnav's paths, which are those of
the brute force in `tests/brute_force.py`; *spurious* are paths beyond those, *duplicate* are
repeated ones. The last columns compare the gains of found paths with the textbook formulas (slabs,
and Kouyoumjian and Pathak's wedge; `tests/brute_force_field.py`). Sionna RT's diffraction term has
a wrong sign."""


if __name__ == "__main__":
    main()
