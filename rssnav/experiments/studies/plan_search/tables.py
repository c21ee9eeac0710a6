"""Tables of the search for plans: all plans that remained, and what the best of them predict."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from itertools import product

import numpy as np
from scipy.stats import rankdata

from rssnav.experiments.paper.data import CONFIGURATIONS
from rssnav.experiments.studies.plan_search.fits import BLOCK, BUILT_IN, CLOSE, Fit
from rssnav.experiments.tables import Cell, Column, Table

AS_GOOD = 1
"""A plan fits as well as the best one if its score is lower by no more than this."""


def best_first(found: Sequence[Fit]) -> list[Fit]:
    """Sort fits by score, those of equal score by the largest deviation."""
    return sorted(found, key=lambda fit: (-fit.score, fit.worst()))


def best_plans(found: Sequence[Fit]) -> dict[str, str]:
    """Return the best drawn plan of each scenario, as the text of its file, by the file's name."""
    return {
        f"plans/scenario{scenario}.toml": best_first(drawn)[0].toml
        for scenario in (1, 2)
        if (drawn := _drawn(scenario, found))
    }


def fits(found: Sequence[Fit]) -> Table:
    """Make a row per plan, the built-in one first, then the best ones."""
    ordered = sorted(best_first(found), key=lambda f: (f.piece.scenario, f.piece.block != BUILT_IN))
    shown = [key for key in CONFIGURATIONS if key.scenario == 1]
    return Table(
        "plans",
        "Floor plans that allow the printed flights and have a path to every cell",
        "Mean length of the learned flights over the paper's, less 1, with the last step left out. "
        f"Lengths: how many are within {100 * CLOSE:g} % of the paper's. Claims: at how many "
        "speeds the RSS-based agent flies farther, and with more turns. Score: their sum.",
        (
            Column("scenario", "Scenario"),
            Column("block", "Block"),
            Column("number", "Number"),
            Column("score", "Score of 12"),
            Column("lengths", "Lengths of 6"),
            Column("claims", "Claims of 6"),
            Column("worst_percent", "Largest deviation [%]", 1),
            *(
                Column(f"{key.agent}_{key.speed}_percent", f"{key.agent}, {key.speed} m/s [%]", 1)
                for key in shown
            ),
        ),
        tuple(_row(fit) for fit in ordered),
    )


def _row(fit: Fit) -> tuple[Cell, ...]:
    return (
        fit.piece.scenario,
        fit.piece.label,
        fit.number,
        fit.score,
        fit.lengths(),
        fit.claims(),
        _percent(fit.worst()),
        *(
            _percent(fit.deviation[key])
            for key in CONFIGURATIONS
            if key.scenario == fit.piece.scenario
        ),
    )


def summary(found: Sequence[Fit], n_blocks: Mapping[int, int]) -> Table:
    """Make a row per scenario: how many plans were drawn, remained, and fit as well as the best."""
    return Table(
        "plans_summary",
        "How many floor plans fit",
        f"As good: drawn plans whose score is at most {AS_GOOD} below the best one's.",
        (
            Column("scenario", "Scenario"),
            Column("drawn", "Drawn"),
            Column("allowed", "Meet the conditions"),
            Column("best_score", "Best score of 12"),
            Column("as_good", "As good"),
            Column("best_percent", "Smallest largest deviation [%]", 1),
            Column("built_in_score", "Score of the built-in plan"),
            Column("built_in_percent", "Its largest deviation [%]", 1),
        ),
        tuple(_summary(scenario, found, n) for scenario, n in n_blocks.items()),
    )


def _summary(scenario: int, found: Sequence[Fit], n_blocks: int) -> tuple[Cell, ...]:
    drawn = _drawn(scenario, found)
    ours = [f for f in found if f.piece.scenario == scenario and f.piece.block == BUILT_IN]
    best = max((fit.score for fit in drawn), default=None)
    return (
        scenario,
        n_blocks * BLOCK,
        len(drawn),
        best,
        sum(fit.score >= best - AS_GOOD for fit in drawn) if best is not None else 0,
        _percent(min((fit.worst() for fit in drawn), default=np.inf)),
        *((ours[0].score, _percent(ours[0].worst())) if ours else (None, None)),
    )


def _slow(fit: Fit) -> float:
    """Largest deviation at 1 and 2 m/s."""
    return fit.worst(lambda key: key.speed < 4)


def _fast(fit: Fit) -> float:
    """Largest deviation at 4 m/s."""
    return fit.worst(lambda key: key.speed == 4)


_PREDICTIONS: dict[str, tuple[Callable[[Fit], float], Callable[[Fit], float], int]] = {
    "lengths at 1 and 2 m/s, deviation at 4 m/s [%]": (_slow, lambda fit: 100.0 * _fast(fit), 1),
    "all lengths, claims of 6": (Fit.worst, Fit.claims, -1),
}
"""What plans are chosen by (least first), what they predict, and the sign of good predictions."""


def held_out(found: Sequence[Fit]) -> Table:
    """Make a row per scenario and prediction: what plans that fit some lengths well predict."""
    return Table(
        "plans_held_out",
        "What the lengths determine",
        "Drawn plans are sorted by the largest deviation of the lengths that they are fitted to. "
        "Chosen: the first one's prediction; best tenth, all: the mean of the first tenth, of all. "
        "Correlation: Spearman's, positive where plans that fit better predict better.",
        (
            Column("scenario", "Scenario"),
            Column("prediction", "Fitted, predicted"),
            Column("chosen", "Chosen", 1),
            Column("best_tenth", "Best tenth", 1),
            Column("all", "All", 1),
            Column("correlation", "Correlation", 2),
        ),
        tuple(
            (scenario, name, *_prediction(_drawn(scenario, found), *_PREDICTIONS[name]))
            for scenario, name in product((1, 2), _PREDICTIONS)
        ),
    )


def _prediction(
    drawn: Sequence[Fit],
    misfit: Callable[[Fit], float],
    predicted: Callable[[Fit], float],
    sign: int,
) -> tuple[Cell, ...]:
    pairs = np.array([(misfit(fit), predicted(fit)) for fit in drawn]).reshape(-1, 2)
    pairs = pairs[np.isfinite(pairs).all(axis=1)]
    pairs = pairs[np.argsort(pairs[:, 0], kind="stable")]
    if not len(pairs):
        return None, None, None, None
    tenth = pairs[: -(-len(pairs) // 10), 1]
    varies = all(len(np.unique(values)) > 1 for values in pairs.T)
    rho = np.corrcoef(rankdata(pairs[:, 0]), rankdata(pairs[:, 1]))[0, 1] if varies else None
    return (
        float(pairs[0, 1]),
        float(tenth.mean()),
        float(pairs[:, 1].mean()),
        sign * float(rho) if rho is not None else None,
    )


def _drawn(scenario: int, found: Sequence[Fit]) -> list[Fit]:
    return [f for f in found if f.piece.scenario == scenario and f.piece.block != BUILT_IN]


def _percent(value: float) -> float | None:
    return 100.0 * value if np.isfinite(value) else None
