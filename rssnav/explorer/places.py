"""Source and start of plans that have none: the page shows both."""

from dataclasses import replace

from floorplans import FloorPlan
from floorplans.importers.assembly.source_and_start import SOURCE_HEIGHT_M, choose_source_and_start


def with_source_and_start(plan: FloorPlan) -> FloorPlan:
    """Return a plan with the source and start it lacks.

    The source is the first transmitter; without one it is chosen away from walls, as importers do.
    """
    if plan.source is not None and plan.start is not None:
        return plan
    source = plan.source or next((t.position for t in plan.transmitters), None)
    beside = None if source is None else source[:2]
    places = choose_source_and_start(plan.outline, plan.walls, plan.height_m, beside)
    chosen = source or (*places.source, min(SOURCE_HEIGHT_M, plan.height_m / 2))
    return replace(plan, source=chosen, start=plan.start or places.start)
