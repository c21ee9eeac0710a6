"""Every command that writes: its arguments, and the files that it works on."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import dxf_drawings
from cli_plans import ROOM

import floorplans
from floorplans.exporters import export

QUICK = ("--reflections", "1", "--diffractions", "0")
OPEN = ("--diffractions", "1", "--reflections", "1")
LIMIT_S = 900.0

MISFIT = ROOM.replace("points = [[3, 0], [3, 4]]", "points = [[3, 0.01], [3, 3.99]]")
"""The room with a partition that does not quite meet the outer walls."""


@dataclass(frozen=True)
class Job:
    """A command that writes.

    Attributes
    ----------
    arguments
        Of ``rssnav``, run in a folder of its own that holds `jobs.inputs`.
    needs
        Jobs whose files must be there first.
    kills
        How often it is ended before it is left alone to finish.
    """

    arguments: tuple[str, ...]
    needs: tuple[str, ...] = ()
    kills: int = 4


_TRAIN = ("train", "room.toml", "--map", "room.h5", "--agent", "location", "--seed", "3")
_STUDY = ("--out", "results", "--quick", "--threads", "1")

JOBS = {
    "map": Job(("map", "room.toml", "-o", "room.h5", *OPEN)),
    "map over an old one": Job(
        ("map", "room.toml", "-o", "room.h5", "--force", "--picture", "room.png", *QUICK), ("map",)
    ),
    "train": Job((*_TRAIN, "--runs", "2000", "--episodes", "300", "-o", "result.h5"), ("map",)),
    "fly": Job(
        ("fly", "room.toml", "few.h5", "--map", "room.h5", "-o", "flight.gif"), ("map", "few runs")
    ),
    "paths": Job(("paths", "room.toml", "--to", "5,3", "--picture", "paths.png", *OPEN)),
    "plan new": Job(("plan", "new", "-o", "new.toml", "--force")),
    "plan generate": Job(("plan", "generate", "flat", "-o", "flat.toml", "--force")),
    "plan import": Job(("plan", "import", "flat.dxf", "-o", "flat.toml", "--force")),
    "plan import of GeoJSON": Job(
        ("plan", "import", "room.geojson", "-o", "venue.toml", "--force")
    ),
    "plan export": Job(("plan", "export", "room.toml", "-o", "room.glb")),
    "plan export of two files": Job(("plan", "export", "room.toml", "-o", "grid.yaml")),
    "plan show": Job(("plan", "show", "room.toml", "-o", "plan.png")),
    "plan check": Job(("plan", "check", "misfit.toml", "--fix", "-o", "fixed.toml")),
    "dataset": Job(("dataset", "make", "demo", "-o", "set", "--threads", "1"), kills=6),
    "dataset on a cluster": Job(("dataset", "make", "demo", "-o", "set", "--workers", "2")),
    "maps": Job(("maps", "--out", "results/maps"), kills=6),
    "experiments": Job(("experiments", "--runs", "1", *_STUDY), ("maps",), kills=6),
    "noise": Job(("experiments", "noise", *_STUDY), ("maps",), kills=6),
    "sensitivity": Job(("experiments", "sensitivity", *_STUDY), ("maps",), kills=6),
    "comparison": Job(("experiments", "comparison", *_STUDY), ("maps",), kills=6),
    "benchmark": Job(
        (
            "benchmark", "--split", "train", "--buildings", "1", "--seeds", "1", "--track", "RSS",
            "--threads", "1", "--out", "results/benchmark",
        ),
        kills=6,
    ),
    "report": Job(("report", "--out", "results", "--threads", "1"), ("experiments",), kills=6),
}  # fmt: skip
"""By name; the first ones take seconds, the last ones minutes."""

FAST = tuple(name for name in JOBS if "results" not in " ".join(JOBS[name].arguments))

PREPARATIONS = {
    "few runs": Job((*_TRAIN, "--runs", "3", "--episodes", "50", "-o", "few.h5"), ("map",))
}
"""What only other jobs need."""


def command(arguments: Sequence[str]) -> list[str]:
    """Return the command line of a job."""
    return [sys.executable, "-m", "rssnav", *arguments]


def environment() -> dict[str, str]:
    """Return the environment of a job: its modules are those of this process."""
    root = Path(floorplans.__file__).parents[1]
    paths = [str(root), os.environ.get("PYTHONPATH", "")]
    return os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, paths))}


class Workshop:
    """Folders with everything that a job needs, and what it leaves when nobody disturbs it."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._durations_s: dict[str, float] = {}

    def before(self, name: str) -> Path:
        """Return a new folder in which a job can start."""
        folder = Path(tempfile.mkdtemp(dir=self._folder))
        _write_inputs(folder)
        for need in self._job(name).needs:
            shutil.copytree(self.after(need), folder, dirs_exist_ok=True)
        return folder

    def after(self, name: str) -> Path:
        """Return the folder that a job has left undisturbed; it is run once."""
        done = self._folder / f"after {name}"
        if not done.exists():
            folder, began_s = self.before(name), time.monotonic()
            run_to_end(self._job(name), folder)
            self._durations_s[name] = time.monotonic() - began_s
            folder.rename(done)
        return done

    def duration_s(self, name: str) -> float:
        """Return how long a job took undisturbed [s]."""
        self.after(name)
        return self._durations_s[name]

    def _job(self, name: str) -> Job:
        return (JOBS | PREPARATIONS)[name]


def _write_inputs(folder: Path) -> None:
    (folder / "room.toml").write_text(ROOM)
    (folder / "misfit.toml").write_text(MISFIT)
    export(floorplans.loads(ROOM), folder / "room.geojson")
    dxf_drawings.save(dxf_drawings.flat_of_bodies(), folder)


def run_to_end(job: Job, folder: Path) -> None:
    """Run a job undisturbed, which must succeed."""
    done = subprocess.run(
        command(job.arguments), cwd=folder, env=environment(), capture_output=True, timeout=LIMIT_S
    )
    if done.returncode:
        raise RuntimeError(f"{' '.join(job.arguments)}: {done.stderr.decode(errors='replace')}")
