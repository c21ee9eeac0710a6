"""The paper's claims, each as a statistical test over realisations.

To add one, list it in the module of its subject; a new subject gets a module, listed here.
"""

from collections.abc import Sequence

from rssnav.experiments.paper.claims import compartments, convergence, flights, learning
from rssnav.experiments.paper.claims.verdicts import Case, Claim, ClaimResult, Verdict
from rssnav.experiments.paper.data import PaperData
from rssnav.experiments.tables import Cell, Column, Table

CLAIMS: tuple[Claim, ...] = (
    *flights.CLAIMS,
    *compartments.CLAIMS,
    *learning.CLAIMS,
    *convergence.CLAIMS,
)
"""All claims, in the paper's order of subjects."""

__all__ = ["CLAIMS", "Case", "Claim", "ClaimResult", "Verdict", "claims_table", "examine"]


def examine(data: PaperData) -> tuple[ClaimResult, ...]:
    """Test every claim."""
    return tuple(ClaimResult(claim, tuple(claim.cases(data))) for claim in CLAIMS)


def claims_table(findings: Sequence[ClaimResult]) -> Table:
    """Make a row per case."""
    rows = [_row(finding, case) for finding in findings for case in finding.cases]
    return Table(
        "claims",
        "Claims",
        "Every case of every claim, with its statistic and 95 % interval.",
        (
            Column("claim", "Claim"),
            Column("case", "Case"),
            Column("statistic", "Statistic"),
            Column("value", "Value", 3),
            Column("low", "2.5 %", 3),
            Column("high", "97.5 %", 3),
            Column("verdict", "Verdict of the case"),
            Column("claim_verdict", "Verdict of the claim"),
        ),
        tuple(rows),
    )


def _row(finding: ClaimResult, case: Case) -> tuple[Cell, ...]:
    estimate = case.estimate
    numbers = (None,) * 3 if estimate is None else (estimate.value, estimate.low, estimate.high)
    claim = finding.claim
    return (
        claim.key,
        case.name,
        claim.statistic,
        *numbers,
        case.verdict.value,
        finding.verdict.value,
    )
