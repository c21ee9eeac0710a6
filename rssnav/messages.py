"""Errors and names in words, for people."""

import unicodedata

JOINERS = "\u200c\u200d"
"""Characters of format that only join letters or emoji."""


def printable(text: str) -> str:
    """Return a text with escapes for characters that a terminal would not show but obey."""
    if text.isprintable():
        return text
    return "".join(c if _is_shown(c) else c.encode("unicode_escape").decode() for c in text)


def _is_shown(c: str) -> bool:
    return c.isprintable() or c == "\n" or c in JOINERS or unicodedata.category(c) == "Zs"


def describe(error: Exception) -> str:
    """Return an error's message on one line; of an `OSError`, the file and the reason."""
    if isinstance(error, OSError) and error.strerror:
        text = f"{error.filename}: {error.strerror}" if error.filename else error.strerror
    else:
        text = str(error)
    return printable(" ".join(text.split()))
