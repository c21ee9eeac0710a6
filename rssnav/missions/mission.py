"""The world of a mission: steps and radio field in each mode, their chain, and the starts."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from rssnav.missions.layout import Layout, WorldError
from rssnav.missions.modes import ModeProcess


def _no_doors() -> NDArray[np.bool_]:
    return np.empty((0, 0), dtype=np.bool_)


@dataclass(frozen=True, eq=False)
class Mission:
    """Steps (layout, cell, action), a radio field per mode, a chain of modes, and starts.

    All layouts have the same S cells; a step that a closed door blocks is missing in some.

    Attributes
    ----------
    layouts : tuple of Layout
        G tables of steps.
    layout_of_mode : (M,) int64
        Which of them each mode has.
    rss_dbm : (M, S) float64
        RSS of each cell in each mode [dBm]; -inf without a path.
    distance_m : (M, S) float64
        Horizontal distance to the transmitter [m].
    modes : ModeProcess
        How modes follow one another.
    starts : (n,) int32
        Cells where an episode may begin.
    start_probability : (n,) float64
        Their probabilities.
    closed : (M, D) bool
        Doors that are closed in each mode; (0, 0) without doors.
    sees : (S, D) bool
        Doors whose position is seen from each cell; (0, 0) without doors.
    source : (M, 2) float64
        Transmitter (x, y) in each mode [m].
    name : str
        Short name, for messages and tables.

    Raises
    ------
    WorldError
        For arrays whose shapes do not fit together, or starts that are no cells.
    """

    layouts: tuple[Layout, ...]
    layout_of_mode: NDArray[np.int64]
    rss_dbm: NDArray[np.float64]
    distance_m: NDArray[np.float64]
    modes: ModeProcess
    starts: NDArray[np.int32]
    start_probability: NDArray[np.float64]
    source: NDArray[np.float64]
    name: str
    closed: NDArray[np.bool_] = field(default_factory=_no_doors)
    sees: NDArray[np.bool_] = field(default_factory=_no_doors)

    def __post_init__(self) -> None:
        m, s = self.modes.n_modes, self.layouts[0].n_states
        for name, shape in (
            ("layout_of_mode", (m,)),
            ("rss_dbm", (m, s)),
            ("distance_m", (m, s)),
            ("source", (m, 2)),
            ("start_probability", self.starts.shape),
        ):
            found = getattr(self, name).shape
            if found != shape:
                raise WorldError(f"mission {self.name!r}: {name} has shape {found}, not {shape}")
        if any(layout.n_states != s for layout in self.layouts):
            raise WorldError(f"mission {self.name!r}: layouts must have the same {s} cells")
        if not (self.starts.size and self.starts.min() >= 0 and self.starts.max() < s):
            raise WorldError(f"mission {self.name!r}: starts must be some of the {s} cells")

    def __repr__(self) -> str:
        """Cells and modes in one line."""
        return f"<Mission {self.name!r}: {self.n_states} cells, {self.n_modes} modes>"

    @property
    def layout(self) -> Layout:
        """Layout of the first mode: cells, positions and lengths are those of all."""
        return self.layouts[0]

    @property
    def n_modes(self) -> int:
        """Number M of modes."""
        return self.modes.n_modes

    @property
    def n_states(self) -> int:
        """Number S of cells."""
        return self.layout.n_states

    @cached_property
    def next_state(self) -> NDArray[np.int32]:
        """Steps of all layouts, shape (G, S, 8)."""
        return np.stack([layout.next_state for layout in self.layouts])

    def with_modes(self, modes: ModeProcess) -> Mission:
        """Return the same mission with another chain of its modes."""
        return replace(self, modes=modes)

    def from_starts(self, starts: NDArray[np.integer]) -> Mission:
        """Return the same mission with episodes that begin in any of some cells (k,).

        Raises
        ------
        WorldError
            For what are no cells, or none.
        """
        numbers = np.asarray(starts).reshape(-1)
        if numbers.size and not np.issubdtype(numbers.dtype, np.integer):
            raise WorldError(
                f"mission {self.name!r}: starts must be numbers of cells, got {numbers}"
            )
        cells = np.clip(numbers, -1, self.n_states).astype(np.int32)  # checked when it is made
        return replace(
            self, starts=cells, start_probability=np.full(cells.size, 1.0 / max(cells.size, 1))
        )
