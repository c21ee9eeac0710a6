"""The API pages show docstrings as they are written."""

from __future__ import annotations

import subprocess
import sys

import pytest

pytest.importorskip("sphinx")

from documents import ROOT

MODULE = '''
class Ray:
    """A ray.

    Attributes
    ----------
    near, far : float
        Ends [m].
    """

    @property
    def direction(self) -> float:
        """Direction at the start: azimuth [rad]."""


def trace(first: int, second: int) -> None:
    """Trace.

    Parameters
    ----------
    first, second
        Two places.
    """
'''


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> str:
    """A page of a class and a function, by the configuration of the documentation."""
    folder = tmp_path_factory.mktemp("docs")
    own = (ROOT / "docs" / "conf.py").read_text("utf-8")
    chosen = [line for line in own.splitlines() if line.startswith(("napoleon_", "autodoc_"))]
    paths = [str(folder), str(ROOT / "docs" / "_extensions")]
    extensions = ["sphinx.ext.autodoc", "sphinx.ext.napoleon", "docstrings"]
    settings = [f"import sys; sys.path[:0] = {paths}", f"extensions = {extensions}", *chosen]
    (folder / "conf.py").write_text("\n".join(settings), "utf-8")
    (folder / "rays_of_a_test.py").write_text(MODULE, "utf-8")
    (folder / "index.rst").write_text(
        "Rays\n====\n\n.. automodule:: rays_of_a_test\n   :members:\n", "utf-8"
    )
    built = folder / "built"
    command = [sys.executable, "-m", "sphinx", "-q", "-b", "text", folder, built]
    subprocess.run(command, check=True)
    return (built / "index.txt").read_text("utf-8")


@pytest.mark.parametrize("names", ["near, far", "first, second"])
def test_names_that_share_a_line_stay_together(page: str, names: str) -> None:
    assert f"**{names}**" in page


def test_a_colon_in_the_docstring_of_a_property_makes_no_type(page: str) -> None:
    assert "Direction at the start: azimuth [rad]." in page
    assert "Type:" not in page
