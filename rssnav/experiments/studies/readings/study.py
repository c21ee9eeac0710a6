"""Which interpretations of the paper allow flights of its printed lengths.

The printed lengths are first decomposed into numbers of straight and diagonal steps. An exact
search on the empty floor then tells, for every interpretation of start, source, goal and count,
which of these flights exist at all.
"""

from __future__ import annotations

from collections.abc import Sequence

from rssnav.experiments.studies.readings import figure, tables
from rssnav.experiments.studies.readings.interpretations import Geometry, geometries, offsets
from rssnav.experiments.studies.readings.outcome import Outcome, measure
from rssnav.experiments.studies.study import Study


def _of(outcomes: Sequence[Outcome], wanted: tuple[Geometry, ...]) -> list[Outcome]:
    """Outcomes of these interpretations, in their order."""
    by_geometry = {outcome.geometry: outcome for outcome in outcomes}
    return [by_geometry[geometry] for geometry in wanted]


STUDY = Study(
    name="readings",
    runs=1,
    quick_runs=1,
    pieces=tuple(dict.fromkeys((*geometries(), *offsets()))),
    measure=lambda geometry, _: (measure(geometry),),
    tables=lambda outcomes: (
        tables.diagonals(),
        tables.lengths(_of(outcomes, geometries())),
        tables.parities(),
        tables.interpretations(_of(outcomes, geometries())),
        tables.source_offsets(_of(outcomes, offsets())),
    ),
    figures=lambda outcomes: {
        "readings": figure.draw(_of(outcomes, geometries()), _of(outcomes, offsets()))
    },
    needs_maps=False,
)
