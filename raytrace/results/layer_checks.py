"""Whether the layers of a map fit together: what two of them say of one cell.

A grazing path counts with its weight, so the strongest path (its power without weight) may exceed
the sum of all, and `path_count` is a rounded sum of weights. What is held takes that into account.
"""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from raytrace.arrays import Floats
from raytrace.constants import SPEED_OF_LIGHT
from raytrace.results.layers import LAYERS

Layers = Mapping[str, NDArray[Any]]

POWERS = ("rss_dbm", "rss_coherent_dbm", "strongest_path_dbm")
"""Layers of received powers."""

_TOLERANCE_DB = 1e-6
_RELATIVE = 1e-6
_MOST_OF_ALL = 0.999
"""Share of the strongest path up to which the K factor follows from the rounded levels."""


def contradictions(layers: Layers, straight_m: Floats, power_dbm: float) -> Iterator[str]:
    """Yield what contradicts another layer, in words that begin with the dataset's name.

    Parameters
    ----------
    layers
        (n_y, n_x) each, by name; `rss_dbm`, `rss_coherent_dbm` and `path_count` at least.
    straight_m
        (n_y, n_x) distance from the transmitter [m].
    power_dbm
        Transmit power [dBm].
    """
    yield from _where_there_is_no_path(layers)
    yield from _where_there_are_paths(layers, straight_m)
    for name in POWERS:
        if name in layers and (layers[name] > power_dbm + _TOLERANCE_DB).any():
            yield f"dataset {name!r}: expected at most the transmit power of {power_dbm:g} dBm"
    yield from _bounds_by_the_number(layers)
    yield from _k_factor(layers, power_dbm)


def _where_there_is_no_path(layers: Layers) -> Iterator[str]:
    without = np.isneginf(layers["rss_dbm"])
    for name, layer in layers.items():
        value = LAYERS[name].without_path
        if value is not None and (layer[without] != value).any():
            yield (
                f"dataset {name!r}: expected {value:g} in cells without a path, where rss_dbm is "
                "-inf"
            )


def _where_there_are_paths(layers: Layers, straight_m: Floats) -> Iterator[str]:
    reached = ~np.isneginf(layers["rss_dbm"])
    where = "in cells with a path, where rss_dbm is finite"
    if (layers["path_count"][reached] == 0).any():
        yield f"dataset 'path_count': expected at least 1 {where}"
    for name in ("strongest_path_dbm", "k_factor_db"):
        if name in layers and np.isneginf(layers[name][reached]).any():
            yield f"dataset {name!r}: expected more than -inf {where}"
    if "mean_delay_s" in layers:
        least_s = straight_m[reached] * (1.0 - _RELATIVE) / SPEED_OF_LIGHT
        if (layers["mean_delay_s"][reached] < least_s).any():
            yield (
                "dataset 'mean_delay_s': expected at least the time along the straight line from "
                f"transmitter_position_m to receiver_height_m {where}"
            )


def _bounds_by_the_number(layers: Layers) -> Iterator[str]:
    """The field of n paths has at most n times their power, and the strongest one n-th of it."""
    rss, count = layers["rss_dbm"], layers["path_count"]
    reached = (count > 0) & np.isfinite(rss)
    most_db = 10.0 * np.log10(count[reached] + 0.5) + _TOLERANCE_DB
    if (layers["rss_coherent_dbm"][reached] > rss[reached] + most_db).any():
        yield "dataset 'rss_coherent_dbm': more than path_count paths of rss_dbm can have"
    strongest = layers.get("strongest_path_dbm")
    if strongest is not None and (strongest[reached] < rss[reached] - most_db).any():
        yield "dataset 'strongest_path_dbm': less than the mean of path_count paths of rss_dbm"


def _k_factor(layers: Layers, power_dbm: float) -> Iterator[str]:
    """The K factor follows from the powers of the strongest path and of all, below their bound."""
    if not {"strongest_path_dbm", "k_factor_db"} <= layers.keys():
        return
    rss, strongest, k = (layers[n] for n in ("rss_dbm", "strongest_path_dbm", "k_factor_db"))
    several = (layers["path_count"] > 1) & np.isfinite(rss) & (rss < power_dbm - _TOLERANCE_DB)
    share = 10.0 ** (np.minimum(strongest[several] - rss[several], 0.0) / 10.0)
    known = (share > 0.0) & (share < _MOST_OF_ALL)
    expected = 10.0 * np.log10(share[known] / (1.0 - share[known]))
    if (np.abs(k[several][known] - expected) > _TOLERANCE_DB).any():
        yield "dataset 'k_factor_db': does not follow from strongest_path_dbm and rss_dbm"
