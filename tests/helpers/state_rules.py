"""Rules for discrete states, applied to readings outside of a training."""

import numpy as np

from rssnav import Fluctuation
from rssnav.kernels.reading_states import discrete_state_of
from rssnav.missions import Layout, Mission, ModeProcess, Observation, Task
from rssnav.missions.tables import SensorTables, sensor_tables


def tables_of(rule, fluctuation, rss_dbm) -> SensorTables:
    """Tables of a row of cells with these readings."""
    n = len(rss_dbm)
    cell = np.column_stack((np.zeros(n, int), np.arange(n)))
    steps = np.full((n, 8), -1, np.int32)
    layout = Layout(steps, cell[:, ::-1] + 0.5, cell, (1, n), 1, np.ones(8), "row")
    mission = Mission(
        layouts=(layout,),
        layout_of_mode=np.zeros(1, int),
        rss_dbm=np.array([rss_dbm]),
        distance_m=np.ones((1, n)),
        modes=ModeProcess.steady(),
        starts=np.zeros(1, np.int32),
        start_probability=np.ones(1),
        source=np.zeros((1, 2)),
        name="row",
    )
    return sensor_tables(mission, Task(), Observation(rule, fluctuation=fluctuation))


def states_of(rule, readings):
    """Discrete states that a rule gives to readings (which also span its range) as they come."""
    readings = np.array(readings, dtype=float)
    sensor = tables_of(rule, Fluctuation(), readings).of_one_run()
    return [discrete_state_of(sensor, cell, reading) for cell, reading in enumerate(readings)]
