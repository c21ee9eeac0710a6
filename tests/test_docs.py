"""Links of the documentation lead somewhere, and what it tells to run runs."""

from __future__ import annotations

import ast
import importlib
import re
import sys
from pathlib import Path
from types import ModuleType

import matplotlib.pyplot as plt
import pytest
from documents import PAGES, ROOT, Block, anchors, blocks, links
from matplotlib.animation import Animation
from typer.testing import CliRunner

from rssnav.cli import app

GENERATED = ROOT / "docs" / "examples"
NOT_OURS = {"pip", "python", "make", "git", "cd", "source", "sbatch", "ls"}
"""Programs that the pages name and the tests do not run."""

LESSONS = [ROOT / "docs" / "tutorial.md", *sorted((ROOT / "docs" / "how_to").glob("*.md"))]
GALLERY = sorted((ROOT / "docs" / "gallery").glob("*.py"))


def name(page: Path) -> str:
    return str(page.relative_to(ROOT))


@pytest.fixture(autouse=True)
def no_window() -> None:
    plt.switch_backend("Agg")


@pytest.mark.parametrize("page", PAGES, ids=name)
def test_every_link_leads_somewhere(page: Path) -> None:
    broken = [target for target in links(page.read_text("utf-8")) if not exists(page, target)]
    assert broken == []


def exists(page: Path, target: str) -> bool:
    if re.match(r"[a-z]+:", target):
        return True
    file, _, anchor = target.partition("#")
    linked = (page.parent / file).resolve() if file else page
    if GENERATED in linked.parents:
        return True
    if not linked.exists():
        return False
    return not anchor or anchor in anchors(linked.read_text("utf-8"))


@pytest.mark.parametrize("page", LESSONS, ids=name)
def test_a_lesson_runs_from_its_beginning_to_its_end(
    page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    lesson = ModuleType("lesson")
    monkeypatch.setitem(sys.modules, lesson.__name__, lesson)  # dataclasses look it up
    for block in blocks(page.read_text("utf-8")):
        if block.file is not None:
            (tmp_path / block.file).write_text(block.text, "utf-8")
        if block.runs:
            run(block, lesson.__dict__)
    plt.close("all")


def run(block: Block, names: dict[str, object]) -> None:
    if block.language == "python":
        exec(compile(block.text, block.file or "python block", "exec"), names)
    if block.language == "console":
        for program, *arguments in block.commands:
            if program in NOT_OURS:
                continue
            assert program == "rssnav", f"{program}: not a program that the tests run"
            result = CliRunner().invoke(app, arguments)
            assert result.exit_code == 0, f"rssnav {' '.join(arguments)}\n{result.output}"


@pytest.mark.parametrize("example", GALLERY, ids=name)
def test_an_example_of_the_gallery_runs(
    example: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    with plt.rc_context():
        text = example.read_text("utf-8")
        names: dict[str, object] = {"__name__": "__main__"}
        exec(compile(text, example.name, "exec"), names)
        for film in names.values():
            if isinstance(film, Animation):
                assert "<img" in film.to_jshtml()
        assert plt.get_fignums()
    plt.close("all")
    assert ast.get_docstring(ast.parse(text))


def test_a_block_that_is_not_run_says_why() -> None:
    page = "<!-- not run: needs a file of yours -->\n```console\n$ rssnav doctor\n```\n"
    (not_run,) = blocks(page)
    (runs,) = blocks(page.removeprefix("<!-- not run: needs a file of yours -->\n"))
    assert (not_run.runs, runs.runs) == (False, True)
    assert runs.commands == [["rssnav", "doctor"]]


@pytest.mark.parametrize("package", ["floorplans", "raytrace", "rssnav"])
def test_the_api_reference_lists_all_that_a_package_exports(package: str) -> None:
    pages = "".join(page.read_text("utf-8") for page in (ROOT / "docs" / "api").glob("*.md"))
    exported: list[str] = importlib.import_module(package).__all__
    assert [name for name in exported if not re.search(rf"\b{name}\b", pages)] == []
