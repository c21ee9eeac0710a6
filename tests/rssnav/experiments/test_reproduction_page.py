"""docs/reproduction.md has a row for every alternative of the sensitivity study."""

from documents import ROOT

from rssnav.experiments.studies.sensitivity.alternatives import ALTERNATIVES, FLOWN, OURS

PAGE = (ROOT / "docs" / "reproduction.md").read_text(encoding="utf-8")


def test_every_alternative_has_its_row() -> None:
    alternatives = (OURS, FLOWN, *ALTERNATIVES)
    rows = [f"| {a.parameter} | {a.choice} |" for a in alternatives]
    assert [row for row in rows if row not in PAGE] == []
