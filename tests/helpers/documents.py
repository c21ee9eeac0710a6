"""Read the project's Markdown pages: their code blocks, links and headings."""

from __future__ import annotations

import re
import shlex
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[2]
PAGES = sorted(
    [*ROOT.glob("*.md"), *(ROOT / "docs").glob("*.md"), *(ROOT / "docs" / "how_to").glob("*.md")]
)

NOT_RUN = re.compile(r"<!-- not run: \S.*-->\s*\Z")
"""Stands before a code block that a test cannot run, with the reason."""

_FENCE = re.compile(r"^(`{3,})([^\n]*)\n(.*?)^\1[ ]*$", re.DOTALL | re.MULTILINE)
_CAPTION = re.compile(r"\A:caption: (\S+)\n+")
_LINK = re.compile(r"!?\[[^\]]*\]\(([^)\s]+)\)")
_HEADING = re.compile(r"^#+ +(.*?) *$", re.MULTILINE)


@dataclass(frozen=True)
class Block:
    """A fenced code block.

    Attributes
    ----------
    language
        "console", "python", "toml" and so on.
    text
        What it holds, without options of its directive.
    file
        The name that the page gives the file it shows; None for other blocks.
    runs
        Whether the page leaves it to the tests.
    """

    language: str
    text: str
    file: str | None
    runs: bool

    @property
    def commands(self) -> list[list[str]]:
        """The words of each command line of a console block, lines ended by a backslash joined."""
        joined = self.text.replace("\\\n", " ")
        lines = [line[2:] for line in joined.splitlines() if line.startswith("$ ")]
        return [shlex.split(line, comments=True) for line in lines]


def blocks(text: str) -> Iterator[Block]:
    """Yield the code blocks of a page in their order."""
    for fence in _FENCE.finditer(text):
        language = fence[2].removeprefix("{code-block}").strip()
        caption = _CAPTION.match(fence[3])
        content = fence[3][caption.end() :] if caption else fence[3]
        runs = not NOT_RUN.search(text[: fence.start()])
        yield Block(language, content, caption and caption[1], runs)


def links(text: str) -> list[str]:
    """Return what a page's links and pictures point at."""
    return _LINK.findall(_FENCE.sub("", text))


def anchors(text: str) -> set[str]:
    """Return the anchors of a page's headings, as GitHub and MyST make them."""
    headings = _HEADING.findall(_FENCE.sub("", text))
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}
