"""The list of commands needs no library, and says what the commands themselves say."""

from __future__ import annotations

import shlex
import subprocess
import sys

import pytest
from cli_plans import all_commands, run, whole_group
from typer.testing import CliRunner

import rssnav
from rssnav.cli import app
from rssnav.cli.commands import COMMANDS

HEAVY = {"numba", "trimesh", "matplotlib", "scipy", "h5py", "numpy"}


def test_the_list_of_commands_imports_no_heavy_library() -> None:
    code = "import sys, rssnav.cli; print(*{name.split('.')[0] for name in sys.modules})"
    loaded = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    )
    assert not HEAVY & set(loaded.stdout.split())


@pytest.mark.parametrize("name", COMMANDS)
def test_the_list_says_what_the_command_says(name) -> None:
    command = whole_group().commands[name]
    assert isinstance(command.help, str)
    assert command.help.split("\n\n")[0].replace("\n", " ").startswith(COMMANDS[name].summary)


def test_every_command_is_listed() -> None:
    text = run("--help").stdout
    assert all(f" {name} " in text for name in COMMANDS)


def test_a_mistyped_command_is_wrong_usage_and_names_the_right_one() -> None:
    result = run("trian")
    assert result.exit_code == 2
    assert "train" in result.stderr


@pytest.mark.parametrize(
    ("words", "completed"),
    [
        ("rssnav tra", "train"),
        ("rssnav plan lis", "list"),
        ("rssnav plan show sc", "scenario1\nscenario2"),
        ("rssnav train --goal-r", "--goal-rss"),
    ],
)
def test_the_shell_completes_commands_plans_and_options(words, completed) -> None:
    shell = {"_RSSNAV_COMPLETE": "complete_bash", "COMP_WORDS": words}
    shell["COMP_CWORD"] = str(len(words.split()) - 1)
    result = CliRunner().invoke(app, [], env=shell, prog_name="rssnav")
    assert result.stdout.strip() == completed


def test_every_public_name_is_there_and_no_other() -> None:
    assert all(getattr(rssnav, name) is not None for name in rssnav.__all__)
    assert set(rssnav.__all__) <= set(dir(rssnav))
    with pytest.raises(AttributeError, match="Trainer"):
        _ = rssnav.Trainer  # type: ignore[attr-defined]


EXAMPLES = {name: command.epilog for name, command in all_commands().items()}
LONG = {"benchmark", "maps", "experiments", "report", "explore", "calibrate"}
"""Commands that take long or do not end; their examples are parsed only."""


@pytest.mark.parametrize("name", EXAMPLES)
def test_examples_of_the_help_run_when_pasted(name, tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    lines = [shlex.split(line)[1:] for line in EXAMPLES[name].split("\n\n")[1:]]
    assert any(line[: len(name.split())] == name.split() for line in lines)
    for line in lines:
        if line[0] in LONG:
            all_commands()[line[0]].make_context(line[0], line[1:])
        else:
            result = run(*line)
            assert result.exit_code == 0, f"rssnav {shlex.join(line)}\n{result.output}"


def test_examples_of_the_list_of_commands_are_there() -> None:
    lines = [shlex.split(line)[1:] for line in whole_group().epilog.split("\n\n")[1:]]
    assert len(lines) >= 3
    for first, *arguments in lines:
        words = 2 if first == "plan" else 1
        command = all_commands()[" ".join([first, *arguments][:words])]
        command.make_context(first, [first, *arguments][words:])
