"""Repairs of pages that other extensions write: links back from the code, icons of animations."""

from __future__ import annotations

import re
from typing import Any

from sphinx.application import Sphinx

BACK_LINK = re.compile(r'(generated/([\w.]*?)(\w+)\.html#)[\w.]*?\b\3(?=[."])')
"""Link to the page of an object whose module another object of the same file may have given."""

ICON_FONT = re.compile(r'<link rel="stylesheet"\s+href="https:[^"]*font-awesome[^"]*">')
ICON = re.compile(r'<i class="fa fa-([a-z-]*)( fa-flip-horizontal)?"></i>')
SIGNS = {
    "minus": "\u2212", "plus": "+", "pause": "\u23f8", "fast-backward": "\u23ee",
    "fast-forward": "\u23ed", "step-backward": "\u23f4", "step-forward": "\u23f5",
    "play": "\u25b6", "play flipped": "\u25c0",
}  # fmt: skip


def setup(app: Sphinx) -> dict[str, Any]:
    """Register the repairs; Sphinx calls this."""
    app.connect("html-page-context", repair)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def repair(_app: Sphinx, page: str, _template: str, context: dict[str, Any], _tree: Any) -> None:
    """Repair the body of a page."""
    body = context.get("body", "")
    if page.startswith("_modules/"):
        context["body"] = with_whole_names(body)
    elif "fa fa-play" in body:
        context["body"] = with_own_icons(body)


def with_whole_names(body: str) -> str:
    """Return a page of code whose links back lead to the full names of objects."""
    return BACK_LINK.sub(r"\1\2\3", body)


def with_own_icons(body: str) -> str:
    """Return a page of an animation whose buttons need no font from elsewhere."""

    def sign(found: re.Match[str]) -> str:
        return SIGNS[found.group(1) + (" flipped" if found.group(2) else "")]

    return ICON.sub(sign, ICON_FONT.sub("", body))
