"""Claims, and how a test decides on them.

A claim is tested in several cases (scenarios, speeds, agents). In each, a statistic and its 95 %
interval over realisations are measured, and

* the case is *reproduced* when the whole interval lies where the claim says,
* *not reproduced* when the whole interval lies elsewhere,
* *inconclusive* otherwise.

The claim as a whole is reproduced when all its cases are, not reproduced when at least one case
is not, and inconclusive otherwise. Its cases are reported too, so that a claim that fails in one of
twelve can be distinguished from one that fails in all. Intervals are not corrected for multiple
testing.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import StrEnum

from rssnav.experiments.paper.data import PaperData
from rssnav.experiments.statistics import Estimate


class Verdict(StrEnum):
    """Result of a test."""

    REPRODUCED = "reproduced"
    NOT_REPRODUCED = "not reproduced"
    INCONCLUSIVE = "inconclusive"


@dataclass(frozen=True)
class Case:
    """One case of a claim.

    Attributes
    ----------
    name : str
        Scenario, agent and speed.
    compared : tuple of (str, float)
        The quantities that the statistic compares.
    estimate : Estimate or None
        The statistic with its interval; None if no run has a value.
    verdict : Verdict
    """

    name: str
    compared: tuple[tuple[str, float], ...]
    estimate: Estimate | None
    verdict: Verdict


@dataclass(frozen=True)
class Claim:
    """A sentence of the paper, and its test.

    Attributes
    ----------
    key : str
        Short name.
    paper : str
        The paper's statement, paraphrased.
    test : str
        What is measured, and when the claim counts as reproduced.
    statistic : str
        Name of the statistic, with its unit.
    cases : callable
        From the data to the cases.
    """

    key: str
    paper: str
    test: str
    statistic: str
    cases: Callable[[PaperData], Sequence[Case]]


@dataclass(frozen=True)
class ClaimResult:
    """A claim and the results of its cases.

    Attributes
    ----------
    claim : Claim
    cases : tuple of Case
    """

    claim: Claim
    cases: tuple[Case, ...]

    @property
    def verdict(self) -> Verdict:
        """Verdict on the whole claim."""
        verdicts = {case.verdict for case in self.cases}
        if Verdict.NOT_REPRODUCED in verdicts:
            return Verdict.NOT_REPRODUCED
        if verdicts == {Verdict.REPRODUCED}:
            return Verdict.REPRODUCED
        return Verdict.INCONCLUSIVE

    @property
    def reproduced_cases(self) -> int:
        """Number of cases that are reproduced."""
        return sum(case.verdict is Verdict.REPRODUCED for case in self.cases)


def positive(estimate: Estimate) -> Verdict:
    """Decide on "the statistic is greater than zero"."""
    if estimate.low > 0.0:
        return Verdict.REPRODUCED
    return Verdict.NOT_REPRODUCED if estimate.high <= 0.0 else Verdict.INCONCLUSIVE


def between(low: float, high: float) -> Callable[[Estimate], Verdict]:
    """Return the decision on "the statistic lies in [low, high]"."""

    def decide(estimate: Estimate) -> Verdict:
        if low <= estimate.low and estimate.high <= high:
            return Verdict.REPRODUCED
        apart = estimate.high < low or high < estimate.low
        return Verdict.NOT_REPRODUCED if apart else Verdict.INCONCLUSIVE

    return decide


def case(
    name: str,
    compared: Sequence[tuple[str, float]],
    estimate: Estimate,
    decide: Callable[[Estimate], Verdict] = positive,
) -> Case:
    """Decide on a case."""
    return Case(name, tuple(compared), estimate, decide(estimate))


def undecided(name: str) -> Case:
    """Return a case without a statistic, because no run has a value."""
    return Case(name, (), None, Verdict.INCONCLUSIVE)
