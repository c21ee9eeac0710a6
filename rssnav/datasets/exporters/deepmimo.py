"""Paths in the arrays of DeepMIMO: a file (npz) for each plan and transmitter.

Keys and units are those of a DeepMIMO 4 data set: ``power`` [dBm at 0 dBm transmitted], ``phase``,
``aoa_az``, ``aoa_el``, ``aod_az``, ``aod_el`` [deg, elevation from +z], ``delay`` [s], ``inter``,
``inter_pos``, ``rx_pos``, ``tx_pos``. Users are the cells inside the building; what is not there is
NaN, as DeepMIMO has it. An interaction code has a digit for each interaction: 1 reflection,
2 diffraction, 4 transmission; 0 is line of sight.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rssnav.datasets.errors import DatasetError
from rssnav.datasets.exporters.pieces import PlanPiece, index_of, new_folder, plan_pieces
from rssnav.datasets.plan_maps import MapIndex
from rssnav.progress import Progress

CODES = np.array([0, 1, 2, 4])
"""Digits of the interactions 0 to 3 of `raytrace.Paths.interactions`."""


def export_deepmimo(folder: Path, out: Path, n_plans: int, progress: Progress) -> None:
    """Write the strongest paths of a data set; parameters as of `export_challenge`.

    Raises
    ------
    DatasetError
        Where no paths are kept.
    """
    with new_folder(out) as new:
        for piece in plan_pieces(folder):
            if not piece.maps.paths:
                raise DatasetError(
                    "no paths are kept: expected strongest_paths in [keep] of the spec", folder
                )
            for row in piece.rows:
                index = index_of(row)
                name = "_".join(f"{key[0]}{value}" for key, value in index._asdict().items())
                path = new / piece.about.split / piece.about.name / f"{name}.npz"
                path.parent.mkdir(parents=True, exist_ok=True)
                np.savez_compressed(path, allow_pickle=False, **arrays_of(piece, index))
            progress(piece.number + 1, n_plans)


def arrays_of(piece: PlanPiece, index: MapIndex) -> dict[str, NDArray[Any]]:
    """Return the arrays of a map: (n_users, n_paths, ...) by the names of DeepMIMO."""
    maps = piece.maps
    inside = maps.inside[index.height]
    paths = {name: values[index][inside] for name, values in maps.paths.items()}
    none = np.isneginf(paths["path_power_dbm"])
    interactions = paths["path_interactions"]

    def masked(values: NDArray[Any]) -> NDArray[np.float32]:
        return np.where(none, np.nan, values).astype(np.float32)

    x, y = np.meshgrid(maps.x, maps.y)
    z = np.full(x.shape, maps.heights_m[index.height])
    points = np.where((interactions > 0)[..., None], paths["path_points"], np.nan)
    return {
        "power": masked(paths["path_power_dbm"] - maps.power_dbm),
        "phase": masked(paths["path_phase_deg"]),
        "delay": masked(paths["path_delay_s"]),
        "aod_az": masked(paths["path_departure_deg"][..., 0]),
        "aod_el": masked(paths["path_departure_deg"][..., 1]),
        "aoa_az": masked(paths["path_arrival_deg"][..., 0]),
        "aoa_el": masked(paths["path_arrival_deg"][..., 1]),
        "inter": np.where(none, np.nan, _codes(interactions)),
        "inter_pos": points.astype(np.float32),
        "rx_pos": np.stack([x[inside], y[inside], z[inside]], axis=-1).astype(np.float32),
        "tx_pos": maps.positions[index.transmitter][None].astype(np.float32),
        "frequency_hz": np.array(maps.frequencies_hz[index.frequency]),
    }


def _codes(interactions: NDArray[np.int8]) -> NDArray[np.float64]:
    """Digits of the interactions (n, n_paths, most), the first one first."""
    code = np.zeros(interactions.shape[:-1])
    for k in range(interactions.shape[-1]):
        digit = CODES[interactions[..., k]]
        code = np.where(digit > 0, 10.0 * code + digit, code)
    return code
