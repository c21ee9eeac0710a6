"""Which interpretations of the paper allow flights of its printed lengths.

The printed lengths are first decomposed into numbers of straight and diagonal steps. An exact
search on the empty floor then tells, for every interpretation of start, source, goal and count,
which of these flights exist at all.
"""

from __future__ import annotations

from rssnav.experiments.studies.readings import figure, tables
from rssnav.experiments.studies.readings.interpretations import geometries, offsets
from rssnav.experiments.studies.readings.outcome import measure
from rssnav.experiments.studies.study import Study

GEOMETRIES = geometries()
N_GEOMETRIES = len(GEOMETRIES)

STUDY = Study(
    name="readings",
    runs=1,
    quick_runs=1,
    pieces=(*GEOMETRIES, *offsets()),
    measure=lambda geometry, _: (measure(geometry),),
    tables=lambda outcomes: (
        tables.diagonals(),
        tables.lengths(outcomes[:N_GEOMETRIES]),
        tables.parities(),
        tables.interpretations(outcomes[:N_GEOMETRIES]),
        tables.source_offsets(outcomes[N_GEOMETRIES:]),
    ),
    figures=lambda outcomes: {
        "readings": figure.draw(outcomes[:N_GEOMETRIES], outcomes[N_GEOMETRIES:])
    },
    needs_maps=False,
)
