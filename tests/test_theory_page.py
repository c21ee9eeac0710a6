"""The equations and sections of docs/theory.md that the code cites are there."""

import re

from documents import ROOT

PAGE = (ROOT / "docs" / "theory.md").read_text("utf-8")
CODE = " ".join(
    " ".join(path.read_text("utf-8").split())
    for package in ("raytrace", "tests")
    for path in sorted((ROOT / package).rglob("*.py"))
)


def cited(kind: str) -> set[str]:
    """Numbers behind a kind of citation; of a range or a list, each end."""
    lists = re.findall(rf"docs/theory\.md, {kind}s?\.? ((?:\d+[a-z]?(?:-|, | and )?)+)", CODE)
    return {number for found in lists for number in re.findall(r"\d+[a-z]?", found)}


def test_cited_equations_are_there() -> None:
    numbered = set(re.findall(r"\\tag\{(\w+)\}", PAGE))
    assert len(cited("eq")) > 10
    assert cited("eq") <= numbered


def test_cited_sections_are_there() -> None:
    numbered = set(re.findall(r"^## (\d+)\. ", PAGE, flags=re.MULTILINE))
    assert len(cited("section")) > 2
    assert cited("section") <= numbered
