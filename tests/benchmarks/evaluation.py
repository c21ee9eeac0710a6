"""What an evaluation of known paths costs beside a new trace: make bench-evaluation.

    python tests/benchmarks/evaluation.py

traces the survey of the measured flat and writes a table into docs/performance.md. All times are
processor time on one thread, the best of several.
"""

import time
from collections.abc import Callable
from importlib.resources import files
from pathlib import Path

from performance_page import machine, table, write_part

import floorplans
from raytrace import Scene, received_power
from rssnav.measurements.calibration import TracedSurvey
from rssnav.measurements.material_values import material_values, plan_values
from rssnav.measurements.survey import Survey
from rssnav.measurements.survey_csv import read_survey, transmitters_of
from rssnav.measurements.traced import TraceSettings
from rssnav.scenes import scene_of

LEFT_OUT = (0.0, 1e-3, 3e-3)
HEAD = ["`max_left_out`", "paths", "memory [MB]", "trace and keep [s]", "evaluate [s]",
        "with derivatives [s]", "new trace [s]"]  # fmt: skip


def seconds(work: Callable[[], object], times: int = 5) -> float:
    """Processor time of some work [s], the best of several."""
    taken: list[float] = []
    for _ in range(times):
        started = time.process_time()
        work()
        taken.append(time.process_time() - started)
    return min(taken)


def new_trace(scene: Scene, survey: Survey, settings: TraceSettings) -> None:
    """Trace the survey without keeping a path."""
    for k in range(len(survey.transmitters)):
        points = survey.points[survey.transmitter == k]
        received_power(scene, settings.transmitter(survey, k), points, settings.config, threads=1)


def row(
    scene: Scene, survey: Survey, settings: TraceSettings, max_left_out: float, new_s: float
) -> list[str]:
    """Measure with some of the power left out."""

    def traced_survey() -> TracedSurvey:
        return TracedSurvey.of(scene, survey, settings, max_left_out=max_left_out)

    keep_s, traced = seconds(traced_survey, 2), traced_survey()
    of = material_values(scene.slabs, settings.frequency_hz)
    values = plan_values(of)
    kept = [part.traced for part in traced.parts]
    return [
        f"{max_left_out:g}",
        f"{sum(points.n_paths for points in kept):,}".replace(",", " "),
        f"{sum(array.nbytes for points in kept for array in points.kept.lanes) / 1e6:.0f}",
        f"{keep_s:.2f}",
        f"{seconds(lambda: traced.levels_db(of, values, slopes=False)):.3f}",
        f"{seconds(lambda: traced.levels_db(of, values, slopes=True)):.3f}",
        f"{new_s:.2f}",
    ]


def main() -> None:
    """Measure, and write the table."""
    folder = Path(str(files("rssnav.measurements") / "measured_flat"))
    plan = floorplans.load(str(folder / "flat.toml"))
    survey = read_survey(folder / "survey.csv", plan, transmitters_of(plan, folder))
    scene = scene_of(plan)
    settings = TraceSettings(frequency_hz=survey.frequency_hz or 2.4e9, threads=1)
    row(scene, survey, settings, LEFT_OUT[-1], 0.0)
    new_s = seconds(lambda: new_trace(scene, survey, settings))
    rows = [row(scene, survey, settings, left_out, new_s) for left_out in LEFT_OUT]
    write_part("evaluation", f"{table(HEAD, rows)}\n\nMeasured on: {machine()}.")


if __name__ == "__main__":
    main()
