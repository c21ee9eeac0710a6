"""A radio map: what a receiver in each cell of a grid reads, and how it was made."""

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from raytrace.grid import Grid, TraceConfig
from raytrace.transmitter import Transmitter


@dataclass(frozen=True, eq=False)
class RadioMap:
    """Received signal strength over a grid.

    Attributes
    ----------
    rss_dbm
        (n_y, n_x) sum of the paths' powers [dBm]; -inf where no path arrives.
    rss_coherent_dbm
        (n_y, n_x) power of the sum of the paths' fields [dBm]; -inf where no path arrives.
    path_count
        (n_y, n_x) number of paths, int64.
    grid, transmitter, config
        What the map was made with.
    plan_text, plan_sha256
        The floor plan's whole text and its hash; empty for a scene without a plan.
    provenance
        Material edition, software versions, wall time and the like.
    """

    rss_dbm: NDArray[np.float64]
    rss_coherent_dbm: NDArray[np.float64]
    path_count: NDArray[np.int64]
    grid: Grid
    transmitter: Transmitter
    config: TraceConfig
    plan_text: str = ""
    plan_sha256: str = ""
    provenance: dict[str, Any] = field(default_factory=dict[str, Any])

    def with_plan(self, text: str, sha256: str) -> "RadioMap":
        """Return the same map, marked as the map of a plan."""
        return replace(self, plan_text=text, plan_sha256=sha256)

    def save(self, path: str | Path) -> None:
        """Write to HDF5, whole or not at all (see `raytrace.store`)."""
        from raytrace.store import save_radio_map

        save_radio_map(self, Path(path))

    @classmethod
    def load(cls, path: str | Path) -> "RadioMap":
        """Read from HDF5; raise `MapFileError` where the file is not a whole map."""
        from raytrace.store import load_radio_map

        return load_radio_map(Path(path))
