"""Drafts of plans that fail their checks."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import islice
from math import ceil, dist

from floorplans.checks.plan import faults
from floorplans.importers.assembly.outline import Link
from floorplans.importers.imported import DraftPlan, ImportRecord, UnusablePlanError
from floorplans.repair.geometry import at_text
from floorplans.repair.walls import REACH_M

_LISTED = 5


def unusable(record: ImportRecord, gaps: Sequence[Link]) -> UnusablePlanError:
    """Describe what keeps an imported plan from use, with the plan as a draft.

    Parameters
    ----------
    record : ImportRecord
        Its plan fails the checks.
    gaps : sequence of Link
        Where its outline has no wall, in the plan's coordinates [m].
    """
    found = tuple(islice(faults(record.plan), 1000))
    draft = DraftPlan(**vars(record), faults=found, gaps=tuple(gaps))
    return UnusablePlanError(draft, _open(gaps) if gaps else _wrong(draft))


def _open(gaps: Sequence[Link]) -> str:
    widest = sorted((sorted(gap) for gap in gaps), key=lambda gap: -dist(*gap))
    listed = [f"{dist(a, b):.2f} m from {at_text(a)} to {at_text(b)}" for a, b in widest[:_LISTED]]
    more = f" and {len(gaps) - _LISTED} more" if len(gaps) > _LISTED else ""
    width_m = ceil(10 * dist(*widest[0]) + 0.01) / 10
    return (
        f"the building is open: {', '.join(listed)}{more}; draw walls there, or close gaps of up "
        f"to {width_m:g} m"
    )


def _wrong(draft: DraftPlan) -> str:
    listed = "; ".join(fault.problem for fault in draft.faults[:_LISTED])
    more = f"; and {len(draft.faults) - _LISTED} more" if len(draft.faults) > _LISTED else ""
    return (
        f"the plan made from it has {len(draft.faults)} faults that repairs up to {REACH_M:g} m "
        f"do not correct: {listed}{more}"
    )
