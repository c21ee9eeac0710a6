"""How the API pages read the docstrings of attributes."""

from __future__ import annotations

import importlib
from collections.abc import Sequence
from typing import Any

from sphinx.application import Sphinx

BEFORE_NAPOLEON, AFTER_NAPOLEON = 400, 600
"""Priorities of handlers; napoleon's is 500."""

ATTRIBUTES = ("attribute", "data", "property")

_aside: dict[str, list[str]] = {}


def setup(app: Sphinx) -> dict[str, Any]:
    """Register the handlers; Sphinx calls this."""
    app.connect("autodoc-process-docstring", set_aside, priority=BEFORE_NAPOLEON)
    app.connect("autodoc-process-docstring", put_back, priority=AFTER_NAPOLEON)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def set_aside(
    _app: Sphinx, what: str, name: str, _object: Any, _options: Any, lines: list[str]
) -> None:
    """Keep the docstring of an attribute: napoleon takes what precedes a colon for its type."""
    if what in ATTRIBUTES:
        _aside[name] = lines.copy()


def put_back(
    _app: Sphinx, _what: str, name: str, _object: Any, _options: Any, lines: list[str]
) -> None:
    """Restore the docstring of an attribute."""
    lines[:] = _aside.pop(name, lines)


def properties_of(name: str, attributes: Sequence[str]) -> list[str]:
    """Attributes of a class that have a docstring of their own, as fields have not."""
    module, _, class_name = name.rpartition(".")
    documented = getattr(importlib.import_module(module), class_name)
    return [item for item in attributes if isinstance(getattr(documented, item, None), property)]
