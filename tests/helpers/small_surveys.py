"""A survey of the command line's room, and how it is written."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from cli_plans import ROOM

import floorplans
from floorplans import FloorPlan
from rssnav.measurements.survey import Survey, SurveyTransmitter

HEADING = "tx,x,y,z,rss_dbm"
TRANSMITTERS = (
    SurveyTransmitter("A", (1.2, 1.1, 2.0)),
    SurveyTransmitter("B", (5.0, 3.0, 2.0)),
)


def room() -> FloorPlan:
    """Return a room of 6 m x 4 m with a partition at x = 3 m, and a door in it."""
    return floorplans.loads(ROOM)


def survey_rows() -> list[str]:
    """Return rows of twelve readings, six places of each transmitter, all of them different."""
    places = [(0.5 + k % 3, 0.5 + k // 3) for k in range(6)]
    return [
        f"{name},{x + 3.0 * n},{y},1.5,{-50 - 2 * x - 5 * y - n}"
        for n, name in enumerate("AB")
        for x, y in places
    ]


def written(path: Path, lines: list[str]) -> Path:
    """Write lines to a file."""
    path.write_text("\n".join([*lines, ""]), encoding="utf-8")
    return path


def survey_of(
    points: np.ndarray, rss_dbm: np.ndarray, transmitter: np.ndarray | None = None
) -> Survey:
    """Return a survey of `TRANSMITTERS`; all readings are of the first one by default."""
    n = len(points)
    return Survey(
        transmitters=TRANSMITTERS if transmitter is not None else TRANSMITTERS[:1],
        transmitter=np.zeros(n, dtype=np.int64) if transmitter is None else transmitter,
        points=points,
        rss_dbm=rss_dbm,
        is_censored=np.zeros(n, dtype=bool),
        device=np.zeros(n, dtype=np.int64),
    )
