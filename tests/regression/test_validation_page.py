"""The tables of docs/validation.md are what the code finds in the shipped survey."""

from __future__ import annotations

import re

import pytest
from regression.validation_page import PAGE, Cells, marked, tables

NUMBER = re.compile(r"\d+(?:\.\d+)?(?:e[-+]?\d+)?")


@pytest.fixture(scope="module")
def computed() -> dict[str, Cells]:
    return tables()


@pytest.mark.parametrize("name", ["models", "materials", "places"])
def test_the_page_has_the_computed_tables(computed: dict[str, Cells], name: str) -> None:
    """Words are the same, and numbers to 2 %, or to the last digit shown."""
    found = marked(name).search(PAGE.read_text("utf-8"))
    assert found is not None
    rows = [
        [cell.strip() for cell in line.strip("|").split(" | ")] for line in found[2].splitlines()
    ]
    assert len(rows) == len(computed[name])
    for shown, expected in zip(rows, computed[name], strict=True):
        for cell, wanted in zip(shown, expected, strict=True):
            assert NUMBER.sub("", cell) == NUMBER.sub("", wanted)
            numbers = [[float(n) for n in NUMBER.findall(text)] for text in (cell, wanted)]
            assert numbers[0] == pytest.approx(numbers[1], rel=0.03, abs=0.02)


def test_calibration_meets_its_targets(computed: dict[str, Cells]) -> None:
    """3.9 dB held out by space becomes 3.5 dB or less, and new transmitters gain too."""
    sigma = {row[0]: [float(n) if n != "–" else 0.0 for n in row[1:]] for row in computed["models"]}
    before = sigma["traced, vertical dipoles"]
    after = sigma["traced, vertical dipoles, materials fitted"]
    assert before[0] == pytest.approx(3.9, abs=0.05)
    assert after[0] <= 3.5
    assert after[1] < before[1]
