"""What the README tells a newcomer to run, run."""

import re
import shlex
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from rssnav.cli import app

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")


def blocks(language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", README, flags=re.DOTALL)


def test_the_library_example_runs() -> None:
    (example,) = blocks("python")
    names: dict[str, object] = {}
    exec(compile(example, "README.md", "exec"), names)
    radio_map, result, paths = names["radio_map"], names["result"], names["paths"]
    assert radio_map.rss_dbm.shape == (26, 96)  # type: ignore[attr-defined]
    assert np.isfinite(result.path_length_m).all()  # type: ignore[attr-defined]
    assert (np.diff(np.abs(paths.gain)) <= 0).all()  # type: ignore[attr-defined]


@pytest.mark.parametrize("command", ["plan show flat", "map flat", "paths flat"])
def test_the_commands_on_a_plan_run(
    command: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    lines = [line.split("#")[0].strip() for block in blocks("sh") for line in block.splitlines()]
    (line,) = [line for line in lines if line.startswith(f"rssnav {command}")]
    monkeypatch.chdir(tmp_path)
    result = CliRunner().invoke(app, shlex.split(line)[1:])
    assert result.exit_code == 0, result.output
    for target in re.findall(r"\S+\.(?:png|h5)", line):
        assert (tmp_path / target).stat().st_size > 1000


def test_every_make_target_it_names_exists() -> None:
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    named = set(re.findall(r"`?make ([a-z]+)", README))
    assert named <= set(re.findall(r"^([a-z]+):", makefile, flags=re.MULTILINE))


def test_every_file_it_links_to_exists() -> None:
    targets = re.findall(r"\]\(([^)]+)\)", README)
    assert [t for t in targets if not (ROOT / t).exists()] == []
