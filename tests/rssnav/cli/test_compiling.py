"""Kernels are compiled once, by ``rssnav doctor``, and whoever waits for them is told."""

import json
import subprocess
import sys

import numba
import pytest

from rssnav.cli.console import COMPILING, stage_progress

AFTER_DOCTOR = """
import importlib, json, pkgutil
from typer.testing import CliRunner
import raytrace.kernels, rssnav.kernels
from rssnav.cli import app

def run(line):
    result = CliRunner().invoke(app, line.split())
    assert result.exit_code == 0, result.output

def signatures():
    found = set()
    for package in (raytrace.kernels, rssnav.kernels):
        for info in pkgutil.iter_modules(package.__path__, package.__name__ + "."):
            for name, kernel in vars(importlib.import_module(info.name)).items():
                found |= {f"{name}{s}" for s in getattr(kernel, "overloads", ())}
    return found

run("doctor")
before = signatures()
run("map flat -o flat.h5 --reflections 1 --preset paper")
run("map flat -o walls.h5 --reflections 1 --preset building")
run("paths flat --to 9.5,6.5 --reflections 1")
for options in ("--agent location", "", "--tolerance 0.5 --fluctuation 0.2", "--interval 1"):
    run(f"train flat --map flat.h5 --goal-rss -30 --runs 1 --episodes 2 {options}")
print(json.dumps([len(before), sorted(signatures() - before)]))
"""


def test_doctor_loads_every_kernel_that_a_first_map_and_training_need(tmp_path) -> None:
    command = [sys.executable, "-c", AFTER_DOCTOR]
    output = subprocess.run(command, cwd=tmp_path, check=True, capture_output=True, text=True)
    n_before, new = json.loads(output.stdout)
    assert n_before > 5
    assert new == []


@pytest.mark.parametrize("terminal", [False, True])
def test_compiling_is_announced_only_where_it_happens(monkeypatch, capsys, terminal) -> None:
    if terminal:
        monkeypatch.setenv("FORCE_COLOR", "1")
        monkeypatch.setenv("TTY_COMPATIBLE", "1")
    function = numba.njit(lambda x: x + 1.0)
    with stage_progress():
        function(1.0)
    assert COMPILING in capsys.readouterr().err
    with stage_progress():
        function(1.0)
    assert COMPILING not in capsys.readouterr().err
