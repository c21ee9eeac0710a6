"""Loads every module before workers are forked, so that no interrupt comes amid an import."""

import pkgutil
from contextlib import suppress
from importlib import import_module

import matplotlib.pyplot  # noqa: F401

import atomicfiles
import floorplans
import fuzz.worker  # noqa: F401
import raytrace
import rssnav

for package in (atomicfiles, floorplans, raytrace, rssnav):
    for module in pkgutil.walk_packages(package.__path__, f"{package.__name__}."):
        if not module.name.endswith(("__main__", "import_worker")):
            with suppress(ImportError):  # extras that are not installed
                import_module(module.name)
