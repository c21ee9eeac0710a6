"""Where the transmitter may be, and the radio map that each place would have."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import dijkstra

from floorplans import FloorPlan
from raytrace import Antenna, Isotropic, TraceConfig
from rssnav.arguments import is_finite, require
from rssnav.missions.layout import Layout
from rssnav.missions.mission import Mission
from rssnav.missions.places import fields_of_places, places_beside
from rssnav.missions.task import Task
from rssnav.progress import Progress

COARSE = TraceConfig(max_reflections=2, max_diffractions=0, max_transmissions=8)
"""Limits of the maps of hypotheses: a tenth of the time of the preset `building`, and errors of
some dB in the shadow."""

NO_WAY = 1_000_000
"""Steps to where no step leads."""


@dataclass(frozen=True, eq=False)
class Hypotheses:
    """H places of the transmitter, each with the map that it would have.

    Attributes
    ----------
    layout : Layout
        Plan with S cells, all steps known; where doors differ, all are open.
    rss_dbm : (S, H) float64
        RSS of each cell under each hypothesis [dBm].
    found : (S, H) bool
        Where the transmitter would be found.
    position : (H, 2) float64
        Places [m].
    transition : (H, H) float64 or None
        Probability of another place after a second; None for a transmitter that stays.
    layouts : tuple of Layout
        Steps under each hypothesis, where doors differ; empty where they are those of ``layout``.
    hops : (S, H) int32
        Fewest steps from each cell to where it would be found.

    Raises
    ------
    ValueError
        For arrays whose shapes do not fit together, or another number of layouts.
    """

    layout: Layout
    rss_dbm: NDArray[np.float64]
    found: NDArray[np.bool_]
    position: NDArray[np.float64]
    transition: NDArray[np.float64] | None = None
    layouts: tuple[Layout, ...] = ()
    hops: NDArray[np.int32] = field(init=False)

    def __post_init__(self) -> None:
        shape = (self.layout.n_states, self.position.shape[0])
        for name in ("rss_dbm", "found"):
            if getattr(self, name).shape != shape:
                raise ValueError(f"{name}: shape {getattr(self, name).shape}, expected {shape}")
        layouts = self.layouts or (self.layout,) * shape[1]
        if len(layouts) != shape[1]:
            raise ValueError(f"layouts: {len(layouts)}, expected {shape[1]}, or none")
        columns = [_hops(layouts[h], self.found[:, h]) for h in range(shape[1])]
        object.__setattr__(self, "hops", np.stack(columns, axis=1))

    def __repr__(self) -> str:
        """Numbers of cells and places in one line."""
        return f"<Hypotheses: {len(self.position)} places, {self.layout.n_states} cells>"

    @classmethod
    def of_mission(cls, mission: Mission, task: Task) -> Hypotheses:
        """Return the modes of a mission: true places, states of doors and maps, and their chain.

        Parameters
        ----------
        mission : Mission
        task : Task
            Its goal tells where the transmitter is found.
        """
        several = len(mission.layouts) > 1
        return cls(
            layout=mission.layout,
            rss_dbm=np.ascontiguousarray(mission.rss_dbm.T),
            found=np.ascontiguousarray(task.goal.cells(mission).T),
            position=mission.source,
            transition=mission.modes.transition if mission.modes.changes else None,
            layouts=tuple(mission.layouts[g] for g in mission.layout_of_mode) if several else (),
        )

    @classmethod
    def of_plan(
        cls,
        plan: FloorPlan,
        layout: Layout,
        *,
        level_dbm: float = -21.0,
        height_m: float = 1.2,
        config: TraceConfig = COARSE,
        antenna: Antenna | None = None,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> Hypotheses:
        """Trace the map of a transmitter in some cells, one step from every other.

        Parameters
        ----------
        plan : FloorPlan
            Walls and materials.
        layout : Layout
            Its cells, as of `Layout.of_plan` with cells of 1 m.
        level_dbm : float
            RSS above which the transmitter is found [dBm]. Where no cell has as much, it would be
            found in the cell of the highest.
        height_m : float
            Of the transmitter [m].
        config : TraceConfig
            Limits of the traces.
        antenna : Antenna, optional
            At both ends; by default of unknown orientation.
        threads, progress
            As for `rssnav.maps.make_map`.

        Raises
        ------
        ValueError
            For a level that is not finite.
        """
        require(is_finite(level_dbm), "level_dbm", level_dbm, "a finite level [dBm]")
        centres = layout.position[_dominating(layout)]
        position = places_beside(plan, centres, _BESIDE_M, height_m)
        fields_dbm = fields_of_places(
            plan,
            layout,
            [(x, y, height_m) for x, y in position.tolist()],
            config=config,
            antenna=antenna or Isotropic(polarisation="mean"),
            threads=threads,
            progress=progress,
        )
        rss_dbm = np.ascontiguousarray(fields_dbm.T)
        found = (rss_dbm > level_dbm) | (rss_dbm == rss_dbm.max(axis=0))
        return cls(layout, rss_dbm, found, position)


_BESIDE_M = (0.1373, 0.0619)  # off the centre, where a receiver is, and off walls at round numbers


def _dominating(layout: Layout) -> NDArray[np.int64]:
    """Cells of which none is a step from another, but all other cells are from one."""
    free = np.ones(layout.n_states, dtype=np.bool_)
    chosen: list[int] = []
    for cell in range(layout.n_states):
        if free[cell]:
            chosen.append(cell)
            free[layout.next_state[cell, layout.action_mask[cell]]] = False
    return np.array(chosen, dtype=np.int64)


def _hops(layout: Layout, found: NDArray[np.bool_]) -> NDArray[np.int32]:
    """Fewest steps from each cell to any of some cells, shape (S,)."""
    size = layout.n_states
    state, action = np.nonzero(layout.action_mask)
    arrived = layout.next_state[state, action]
    back = coo_array((np.ones(state.size), (arrived, state)), shape=(size, size)).tocsr()
    steps = dijkstra(back, indices=np.flatnonzero(found), unweighted=True, min_only=True)
    return np.where(np.isfinite(steps), steps, NO_WAY).astype(np.int32)
