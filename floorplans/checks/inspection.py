"""All errors and warnings of a plan, each with its place.

Errors make a plan unusable (`floorplans.checks.plan`). Warnings are common drawing mistakes
(`floorplans.checks.warnings`).
"""

from itertools import islice

from floorplans.checks.plan import MAX_FAULTS, building_faults, geos_flags_ignored, number_faults
from floorplans.checks.warnings import Finding as Finding
from floorplans.checks.warnings import warnings_of
from floorplans.errors import PlanError
from floorplans.unchecked import PlanFile


def inspect(file: PlanFile) -> tuple[Finding, ...]:
    """Find all errors and warnings of a plan.

    Parameters
    ----------
    file : PlanFile
        The plan, and how its walls are numbered in its file.

    Returns
    -------
    tuple of Finding
        Errors first.
    """
    wrong_numbers = [_error(fault, file) for fault in number_faults(file.plan)]
    if wrong_numbers:
        return tuple(wrong_numbers)
    errors = [_error(fault, file) for fault in building_faults(file.plan)]
    with geos_flags_ignored():
        return (*errors, *islice(warnings_of(file), MAX_FAULTS))


def _error(fault: PlanError, file: PlanFile) -> Finding:
    place = file.place_in_file(fault.place)
    text = str(fault.located(place=place))
    return Finding("error", str(place[0]) if place else "plan", text, fault.at)
