"""Loads every module and every kernel before workers are forked.

No interrupt comes amid an import then, and no worker spends its first seconds on loading.
"""

import pkgutil
from contextlib import suppress
from importlib import import_module

import matplotlib.pyplot  # noqa: F401

import atomicfiles
import floorplans
import fuzz.worker  # noqa: F401
import raytrace
import rssnav
from fuzz import calls

for package in (atomicfiles, floorplans, raytrace, rssnav):
    for module in pkgutil.walk_packages(package.__path__, f"{package.__name__}."):
        if not module.name.endswith(("__main__", "import_worker")):
            with suppress(ImportError):  # extras that are not installed
                import_module(module.name)

calls.run_right_ones()
