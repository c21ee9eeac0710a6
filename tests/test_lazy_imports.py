"""Importing a package takes no time: each of its names is imported when it is first used."""

import subprocess
import sys
from importlib import import_module

import pytest

HEAVY = ("numba", "scipy", "trimesh", "shapely", "h5py", "matplotlib")


@pytest.mark.parametrize("package", ["raytrace", "rssnav"])
def test_an_import_alone_loads_no_library(package: str) -> None:
    code = f"import sys, {package}; print(*[name for name in {HEAVY} if name in sys.modules])"
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert found.stdout.split() == []


@pytest.mark.parametrize("package", ["raytrace", "rssnav"])
def test_every_name_can_be_imported(package: str) -> None:
    module = import_module(package)
    assert len(module.__all__) > 20
    for name in module.__all__:
        assert getattr(module, name) is not None
    with pytest.raises(AttributeError, match="no_such_name"):
        _ = module.no_such_name
