"""What the limits by power of a map leave out, measured at random cells."""

from dataclasses import dataclass, replace

import numpy as np

from raytrace.arrays import Floats
from raytrace.config import TraceConfig
from raytrace.results.radio_map import RadioMap
from raytrace.scene import Scene
from raytrace.solver.accumulate import Progress
from raytrace.solver.workers import Stop
from raytrace.trace import received_power

CELLS = 59
"""Cells of a sample: 95 % of all cells miss no more than the worst of 59, with 95 % confidence."""

WIDER_DB = 15.0
"""How much wider limits are for a sample [dB]."""

LEAST_DBM = -100.0
"""RSS of the cells that samples are drawn from, at least [dBm]."""

CONFIDENCE = 0.95
"""Probability with which a share of all cells holds."""


@dataclass(frozen=True, eq=False)
class LeftOutSample:
    """What limits by power leave out at random cells.

    Attributes
    ----------
    points
        (n, 3) the cells' centres [m].
    missing_db
        (n,) level with wider limits over that of the map [dB].
    config
        The wider limits.
    n_cells
        Number of cells that the sample was drawn from.
    """

    points: Floats
    missing_db: Floats
    config: TraceConfig
    n_cells: int

    def __repr__(self) -> str:
        """Say it in one line."""
        return (
            f"<LeftOutSample: {len(self.points)} of {self.n_cells} cells, "
            f"{self.median_db:.2f} dB in the median, {self.largest_db:.2f} dB at most>"
        )

    @property
    def median_db(self) -> float:
        """Median of `missing_db` [dB]."""
        return float(np.median(self.missing_db))

    @property
    def largest_db(self) -> float:
        """Largest of `missing_db` [dB]."""
        return float(self.missing_db.max())

    def share(self, confidence: float = CONFIDENCE) -> float:
        """Bound the share of all cells that miss `largest_db` or less, from below.

        Parameters
        ----------
        confidence
            Probability with which the bound holds. It follows from the number of cells alone: all
            of n random cells are within a share p with probability p^n.

        Raises
        ------
        ValueError
            For a probability that is not between 0 and 1.
        """
        if not 0.0 < confidence < 1.0:
            raise ValueError(f"confidence = {confidence}: expected a probability between 0 and 1")
        if len(self.points) == self.n_cells:
            return 1.0
        return float((1.0 - confidence) ** (1.0 / len(self.points)))


def sample_left_out(
    scene: Scene,
    radio_map: RadioMap,
    cells: int = CELLS,
    *,
    wider_db: float = WIDER_DB,
    above_dbm: float = LEAST_DBM,
    seed: int = 0,
    threads: int | None = None,
    progress: Progress | None = None,
    stop: Stop | None = None,
    max_memory_bytes: int | None = None,
) -> LeftOutSample:
    """Trace random cells of a map again with wider limits by power.

    What even these leave out is not included, nor what a number of reflections, diffractions or
    transmissions does. Beams are grown as for a whole map with the wider limits, which takes most
    of the time.

    Parameters
    ----------
    scene
        What the map was traced in.
    radio_map
        The map.
    cells
        How many, at random; all if there are fewer.
    wider_db
        How much lower the least power is, and how much wider the dynamic range [dB].
    above_dbm
        Cells below this RSS are not drawn [dBm].
    seed
        Of the random numbers.
    threads, progress, stop, max_memory_bytes
        As for `compute_radio_map`.

    Raises
    ------
    ValueError
        For a map without limits by power or without a cell above that RSS, for no cells, and for
        limits that are not wider.
    SceneError, TraceStoppedError, MemoryLimitError
        As for `compute_radio_map`.
    """
    config = _wider(radio_map.config, wider_db)
    if cells < 1:
        raise ValueError(f"cells = {cells}: expected at least 1")
    rss_dbm = radio_map.rss_dbm.ravel()
    known = np.flatnonzero(rss_dbm > above_dbm)
    if not len(known):
        raise ValueError(f"above_dbm = {above_dbm:g}: no cell of the map has a higher RSS")
    drawn = np.random.default_rng(seed).choice(known, min(cells, len(known)), replace=False)
    points = radio_map.grid.points()[drawn]
    found = received_power(
        scene,
        radio_map.transmitter,
        points,
        config,
        receive_antenna=radio_map.receive_antenna,
        threads=threads,
        progress=progress,
        stop=stop,
        max_memory_bytes=max_memory_bytes,
    )
    return LeftOutSample(points, found - rss_dbm[drawn], config, len(known))


def _wider(config: TraceConfig, wider_db: float) -> TraceConfig:
    """Return limits that leave out less."""
    if not 0.0 < wider_db < float("inf"):
        raise ValueError(f"wider_db = {wider_db}: expected a positive number of dB")
    if not config.leaves_out_weak_paths:
        raise ValueError(
            "the map has no limit by power (min_power_dbm, dynamic_range_db, max_paths): "
            "nothing was left out because of one"
        )
    return replace(
        config,
        min_power_dbm=config.min_power_dbm - wider_db,
        dynamic_range_db=config.dynamic_range_db + wider_db,
        max_paths=None,
    )
