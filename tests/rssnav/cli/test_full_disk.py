"""A full disk ends every command that writes with exit code 1 and a line that says what is full."""

from __future__ import annotations

import errno
import os
import tempfile
from pathlib import Path

import pytest
from cli_plans import QUICK, done, edited, room_file, run
from small_disk import no_file_above

from raytrace import RadioMap
from rssnav import TrainingResult
from rssnav.experiments.paper import scenarios


@pytest.fixture(scope="module")
def files(tmp_path_factory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("room")
    text = edited("points = [[3, 0], [3, 4]]", "points = [[3, 0], [3, 2.5]]")
    found = {"plan": room_file(folder, text), "map": folder / "room.h5", "run": folder / "run.h5"}
    done("map", found["plan"], "-o", found["map"])
    done("train", found["plan"], "--map", found["map"], "--agent", "location", "--runs", 2,
         "--episodes", 60, "-o", found["run"])  # fmt: skip
    found["dxf"], found["misfit"] = folder / "room.dxf", folder / "misfit.toml"
    misfit = text.replace("points = [[3, 0], [3, 2.5]]", "points = [[3, 0.01], [3, 2.5]]")
    found["misfit"].write_text(misfit, encoding="utf-8")
    done("plan", "export", found["plan"], "-o", found["dxf"])
    done("paths", found["plan"], "--to", "5,3", *QUICK)  # keeps its kernels while there is room
    return found


COMMANDS = {
    "map": ("map", "{plan}", *QUICK, "-o", "{out}/map.h5"),
    "map picture": (
        "map", "{plan}", "--force", "-o", "{out}/map.h5", "--picture", "{out}/map.png"
    ),
    "train": ("train", "{plan}", "--map", "{map}", "--agent", "location", "--runs", 2,
              "--episodes", 60, "-o", "{out}/run.h5"),
    "fly": ("fly", "{plan}", "{run}", "--map", "{map}", "-o", "{out}/flight.gif"),
    "plan export dxf": ("plan", "export", "{plan}", "-o", "{out}/room.dxf"),
    "plan export obj": ("plan", "export", "{plan}", "-o", "{out}/room.obj"),
    "plan export yaml": ("plan", "export", "{plan}", "-o", "{out}/room.yaml"),
    "plan export glb": ("plan", "export", "{plan}", "-o", "{out}/room.glb"),
    "plan import": ("plan", "import", "{dxf}", "-o", "{out}/room.toml"),
    "plan export geojson": ("plan", "export", "{plan}", "-o", "{out}/room.geojson"),
    "plan check": ("plan", "check", "{misfit}", "--fix", "-o", "{out}/fixed.toml"),
    "plan new": ("plan", "new", "-o", "{out}/new.toml"),
    "plan generate": ("plan", "generate", "flat", "-o", "{out}/flat.toml"),
    "plan show": ("plan", "show", "{plan}", "-o", "{out}/plan.png"),
    "paths": ("paths", "{plan}", "--to", "5,3", *QUICK, "--picture", "{out}/paths.png"),
    "maps": ("maps", "--out", "{out}"),
}  # fmt: skip


@pytest.mark.parametrize("name", COMMANDS)
def test_the_file_that_is_full_is_named(name, files, tmp_path, monkeypatch) -> None:
    monkeypatch.setattr(scenarios, "PLANS", ("flat",))  # `maps` traces the paper's for a minute
    out = tmp_path / "out"
    out.mkdir()
    arguments = [str(word).format(out=out, **files) for word in COMMANDS[name]]
    with no_file_above(64):
        result = run(*arguments)
    assert result.exit_code == 1, result.output
    (line,) = [text for text in result.stderr.splitlines() if text.startswith("rssnav: ")]
    assert "File too large" in line
    assert str(out) in line
    assert [path for path in out.rglob("*") if path.is_file()] == []


@pytest.mark.parametrize(("name", "kind"), [("map", RadioMap), ("train", TrainingResult)])
def test_what_was_computed_is_kept_elsewhere(name, kind, files, tmp_path, monkeypatch) -> None:
    elsewhere, out, save = tmp_path / "elsewhere", tmp_path / "out", kind.save
    elsewhere.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(elsewhere))

    def save_unless_full(content, path) -> None:
        if Path(path).parent == out:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(path))
        save(content, path)

    monkeypatch.setattr(kind, "save", save_unless_full)
    result = run(*(str(word).format(out=out, **files) for word in COMMANDS[name]))
    assert result.exit_code == 1
    (kept,) = elsewhere.glob("rssnav-*/*.h5")
    assert f"the result was saved to {kept} instead" in result.stderr
    kind.load(kept)
