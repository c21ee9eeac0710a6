"""Small missions: a room with a door in its half-wall and a transmitter in either corner."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from small_worlds import SmallGrid, room_plan

from rssnav.missions import Layout, Mission, ModeProcess

WALL_X_M, DOOR_Y_M = 4.0, (1.0, 2.0)
PLACES = ((1.0, 1.0), (1.2, 4.1))


def room_mission(modes: ModeProcess | None = None, start=(6.5, 1.5)) -> Mission:
    """Four modes: the transmitter's place, times a door that is open (0, 1) or closed (2, 3)."""
    closed_plan = replace(room_plan(), segments=(((4.0, 0.0), (4.0, 4.0)),))
    parts = (((4.0, 0.0), (4.0, DOOR_Y_M[0])), ((4.0, DOOR_Y_M[1]), (4.0, 4.0)))
    grid = SmallGrid(np.arange(8) + 0.5, np.arange(5) + 0.5)
    layouts = tuple(
        Layout.of_plan(plan, grid) for plan in (replace(closed_plan, segments=parts), closed_plan)
    )
    distance = np.array([layouts[0].distance_m(*place) for place in PLACES] * 2)
    rss_dbm = -20.5 - 25.0 * np.log10(distance / 1.9)
    rss_dbm += 1e-3 * np.arange(rss_dbm.size).reshape(rss_dbm.shape)
    rss_dbm[2:] -= 3.0 * (distance[2:] > 3.0)
    sees = np.zeros((layouts[0].n_states, 1), dtype=bool)
    sees[[layouts[0].nearest(x, 1.5) for x in (3.5, 4.5)]] = True
    return Mission(
        layouts=layouts,
        layout_of_mode=np.array([0, 0, 1, 1]),
        rss_dbm=rss_dbm,
        distance_m=distance,
        modes=modes or ModeProcess.steady(4),
        starts=np.array([layouts[0].nearest(*start)], dtype=np.int32),
        start_probability=np.ones(1),
        source=np.array(PLACES * 2),
        name="room",
        closed=np.array([[False], [False], [True], [True]]),
        sees=sees,
    )
