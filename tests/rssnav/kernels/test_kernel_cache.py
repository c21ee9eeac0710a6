"""The machine code of the loops is kept apart for every state of their sources."""

import os
from pathlib import Path

import numba.core.config
import pytest

from rssnav.kernels import compiling, sensed, tabular
from rssnav.kernels.compiling import jit, sources_digest


@pytest.fixture
def sources(tmp_path):
    for name in ("caller.py", "callee.py"):
        (tmp_path / name).write_text("x = 1\n")
    return tmp_path


@pytest.mark.parametrize("name", ["caller.py", "callee.py", "new.py"])
def test_a_change_in_any_source_changes_the_digest(sources, name):
    before = sources_digest(sources)
    assert sources_digest(sources) == before
    (sources / name).write_text("x = 2\n")
    assert sources_digest(sources) != before


def test_moving_text_between_sources_changes_the_digest(sources):
    before = sources_digest(sources)
    (sources / "callee.py").write_text("")
    (sources / "caller.py").write_text("x = 1\nx = 1\n")
    assert sources_digest(sources) != before


@pytest.mark.skipif("NUMBA_CACHE_DIR" in os.environ, reason="the user has chosen a folder")
@pytest.mark.parametrize("loop", [tabular.learn, sensed.learn])
def test_the_loops_are_kept_in_the_folder_of_their_sources(loop):
    digest = sources_digest(Path(compiling.__file__).parent)
    assert digest in str(loop.stats.cache_path)


def test_compiling_leaves_the_setting_of_other_packages_alone(monkeypatch):
    monkeypatch.setattr(numba.core.config, "CACHE_DIR", "elsewhere")
    jit()(lambda x: x)
    assert numba.core.config.CACHE_DIR == "elsewhere"
