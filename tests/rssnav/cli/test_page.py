"""docs/cli.md lists the commands and options there are, and its examples run."""

from __future__ import annotations

import re
import shlex

import pytest
from cli_plans import all_commands, run
from documents import ROOT

PAGE = (ROOT / "docs" / "cli.md").read_text(encoding="utf-8")
SECTION = re.compile(r"^## rssnav ([a-z ]+)\n(.*?)(?=^## |\Z)", re.DOTALL | re.MULTILINE)
SECTIONS = dict(SECTION.findall(PAGE))
LONG = ("benchmark", "maps", "explore", "experiments", "report")


COMMANDS = all_commands()


def examples(text: str) -> list[str]:
    """Command lines of a text's console blocks."""
    blocks = re.findall(r"^```console\n(.*?)^```", text, re.DOTALL | re.MULTILINE)
    return [line.removeprefix("$ ") for block in blocks for line in block.splitlines()]


def test_page_has_a_section_for_every_command() -> None:
    assert set(SECTIONS) == set(COMMANDS)


@pytest.mark.parametrize("name", COMMANDS)
def test_table_has_every_option_of_the_command(name) -> None:
    rows = re.findall(r"^\| (`-.*?) \|", SECTIONS[name], re.MULTILINE)
    listed = {option for row in rows for option in re.findall(r"(?<!\w)--?[a-z][a-z-]*", row)}
    options = [p for p in COMMANDS[name].params if p.param_type_name == "option"]
    real = {flag for option in options for flag in (*option.opts, *option.secondary_opts)}
    assert listed == real - {"--help", "-h"}


@pytest.mark.parametrize("name", COMMANDS)
def test_section_has_an_example_of_its_command(name) -> None:
    assert any(line.startswith(f"rssnav {name}") for line in examples(SECTIONS[name]))


@pytest.mark.parametrize("name", [name for name in COMMANDS if name not in LONG])
def test_examples_run_as_they_stand(name, tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    for line in examples(SECTIONS[name]):
        program, *arguments = shlex.split(line)
        result = run(*arguments)
        assert program == "rssnav"
        assert result.exit_code == 0, f"{line}\n{result.output}"


@pytest.mark.parametrize("name", LONG)
def test_long_examples_parse(name) -> None:
    for line in examples(SECTIONS[name]):
        arguments = shlex.split(line)[2:]
        COMMANDS[name].make_context(name, arguments)


def test_page_begins_with_version_and_help() -> None:
    first = PAGE.split("\n## ")[0]
    for line in examples(first):
        assert run(*shlex.split(line)[1:]).exit_code == 0
