"""What the README tells a newcomer to run, run."""

import re
import shlex
import tomllib
from pathlib import Path

import numpy as np
import pytest
import yaml
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


def test_the_commands_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    lines = [line for block in blocks("sh") for line in block.splitlines()]
    commands = [shlex.split(line, comments=True) for line in lines if line.startswith("rssnav ")]
    assert len(commands) > 8
    for _, *arguments in commands:
        if arguments[0] == "explore":  # serves until Ctrl-C
            continue
        result = CliRunner().invoke(app, arguments)
        assert result.exit_code == 0, result.output
        for target in re.findall(r"\S+\.(?:png|h5|gif|dxf|toml)", " ".join(arguments)):
            assert (tmp_path / target).stat().st_size > 1000


def peers_of(page: str) -> list[list[str]]:
    """Cells of the rows between the marks of a table of ray tracers."""
    (table,) = re.findall(r"<!-- peers:.*?-->(.*?)<!-- end of peers -->", page, flags=re.DOTALL)
    rows = re.findall(r"^\| (.*) \|$", table, flags=re.MULTILINE)
    return [[cell.strip() for cell in row.split("|")] for row in rows]


def test_its_comparison_is_that_of_the_performance_page() -> None:
    page = (ROOT / "docs" / "performance.md").read_text(encoding="utf-8")
    measured = {tuple(row[:2]): row for row in peers_of(page)}
    _, _, *rows = peers_of(README)
    assert len(rows) >= 5
    for plan, tracer, found, missed, spurious, median_db, time_s in rows:
        _, _, time, _, *counts, _, median, _ = measured[plan, tracer]
        assert [found, missed, spurious, time_s] == [*counts, time]
        assert median_db == (median or "–")


def test_one_version_everywhere() -> None:
    found = {
        file: re.findall(pattern, (ROOT / file).read_text(encoding="utf-8"), flags=re.MULTILINE)[0]
        for file, pattern in {
            "pyproject.toml": r'^version = "(.*)"$',
            "CITATION.cff": r"^version: (.*)$",
            "README.md": r"^  version = \{(.*)\},$",
            "CHANGELOG.md": r"^## (\d.*) \(",
        }.items()
    }
    assert len(set(found.values())) == 1, found


def test_the_citation_has_the_date_of_the_release() -> None:
    (date,) = re.findall(r"^date-released: (.*)$", (ROOT / "CITATION.cff").read_text("utf-8"), re.M)
    changelog = (ROOT / "CHANGELOG.md").read_text("utf-8")
    assert re.findall(r"^## \d.* \((.*)\)$", changelog, re.M)[0] == date


def test_every_make_target_it_names_exists() -> None:
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    named = set(re.findall(r"`?make ([a-z]+)", README))
    assert named <= set(re.findall(r"^([a-z]+):", makefile, flags=re.MULTILINE))


def badge(name: str) -> tuple[str, str]:
    """Both texts of a badge, which is a link to what it is about."""
    assert re.search(rf"\[!\[.*\]\(docs/images/badges/{name}\.svg\)\]\(\S+\)", README)
    picture = (ROOT / "docs" / "images" / "badges" / f"{name}.svg").read_text(encoding="utf-8")
    left, right = re.findall(r"<text .*>(.*)</text>", picture)
    return left, right


def test_badges_say_what_the_project_does() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    oldest = project["requires-python"].removeprefix(">=")
    assert badge("python") == ("Python", f"{oldest} or newer")
    assert badge("licence") == ("licence", project["license"])
    workflow = yaml.safe_load((ROOT / ".github" / "workflows" / "ci.yml").read_text("utf-8"))
    steps = workflow["jobs"]["check"]["steps"]
    (run,) = [step["run"] for step in steps if "run" in step]
    (python,) = [step["with"]["python-version"] for step in steps if "python" in str(step)]
    assert badge("ci") == ("CI", f"{run} on Python {python}")
    assert (ROOT / run).stat().st_mode & 0o100
