"""The page on the paper's statements names code, tests and claims that exist, and every claim."""

import re
from importlib import import_module
from pathlib import Path

import pytest

import rssnav.experiments.paper.claims as paper_claims

ROOT = Path(__file__).resolve().parents[1]
PAGE = (ROOT / "docs" / "paper_statements.md").read_text(encoding="utf-8")
ROWS = [
    [cell.strip() for cell in line.strip("|").split(" | ")]
    for line in PAGE.splitlines()
    if line.startswith("| ") and not line.startswith("| the paper")
]
CODE_ROWS = [row for row in ROWS if "::" in row[2]]
CLAIM_ROWS = [row for row in ROWS if "::" not in row[2]]
TESTS = sorted({row[2].strip("`") for row in CODE_ROWS})
NAMES = sorted(
    {
        name
        for row in CODE_ROWS
        for name in re.findall(r"`((?:raytrace|rssnav|floorplans)[./][\w./]+)`", row[1])
    }
)


@pytest.mark.parametrize("name", TESTS)
def test_its_tests_exist(name: str) -> None:
    path, _, function = name.partition("::")
    assert f"def {function}(" in (ROOT / path).read_text(encoding="utf-8")


@pytest.mark.parametrize("name", NAMES)
def test_its_code_exists(name: str) -> None:
    if "/" in name:
        assert (ROOT / name).exists()
        return
    module, _, attribute = name.rpartition(".")
    found = import_module(module)
    assert hasattr(found, attribute) or import_module(name)


def test_it_has_every_claim_once() -> None:
    named = [key for row in CLAIM_ROWS for key in re.findall(r"`([\w-]+)`", row[1])]
    assert sorted(named) == sorted(claim.key for claim in paper_claims.CLAIMS)
