"""The layers of a radio map: which there are, and how they follow from the sums over all paths."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from raytrace.arrays import Floats, Ints
from raytrace.constants import SPEED_OF_LIGHT
from raytrace.kernels.sums import COSINE, EXCESS, EXCESS_SQUARED, SINE, STRONGEST, Sums


class LayerInfo(NamedTuple):
    """Unit and description of a layer, and what it may hold.

    Attributes
    ----------
    units, long_name
        As stored with the layer.
    low, high
        Bounds of its values.
    without_path
        Its value where no path arrives; None where it may have several.
    required
        Whether every map has it.
    dtype
        Type of its values.
    """

    units: str
    long_name: str
    low: float
    high: float
    without_path: float | None
    required: bool = False
    dtype: type[np.generic] = np.float64


_LARGEST = float(np.finfo(np.float64).max)
_POWER = (-np.inf, _LARGEST, -np.inf)
_DELAY = (0.0, _LARGEST, 0.0)

LAYERS: dict[str, LayerInfo] = {
    "rss_dbm": LayerInfo(
        "dBm", "received signal strength, sum of the paths' powers", *_POWER, True
    ),
    "rss_coherent_dbm": LayerInfo(
        "dBm", "received signal strength, power of the sum of the paths' fields", *_POWER, True
    ),
    "path_count": LayerInfo("1", "number of paths", 0, np.inf, 0, True, np.int64),
    "strongest_path_dbm": LayerInfo("dBm", "power of the strongest path", *_POWER),
    "mean_delay_s": LayerInfo("s", "mean delay, weighted with power", *_DELAY),
    "delay_spread_s": LayerInfo("s", "RMS delay spread, weighted with power", *_DELAY),
    "angular_spread": LayerInfo("1", "azimuth spread of arrival after Fleury, 0 to 1", 0, 1, 0),
    "k_factor_db": LayerInfo(
        "dB", "power of the strongest path over that of all others", -np.inf, np.inf, -np.inf
    ),
    "left_out_db": LayerInfo(
        "dB", "bound on the level of what was left out over the RSS", -np.inf, np.inf, None
    ),
}
"""The fields of a `RadioMap` that hold one value per cell, in the order they are stored in."""

LABELS = {"rss_dbm": "RSS", "rss_coherent_dbm": "coherent RSS", "k_factor_db": "K factor"}
"""Names of layers in pictures, where they are not that of the field without its unit."""

EMPTY = {
    **{name: info.without_path for name, info in LAYERS.items() if info.without_path is not None},
    "path_count": 0,
    "left_out_db": -np.inf,
}
"""Value of each layer in a cell that no path can reach."""


def label_of(layer: str) -> str:
    """Name and unit of a layer, for the axes of pictures: "RSS [dBm]"."""
    units = LAYERS[layer].units
    name = LABELS.get(layer, layer.removesuffix(f"_{units.lower()}").replace("_", " "))
    return name if units == "1" else f"{name} [{units}]"


def layers_of(sums: Sums, straight_m: Floats, power_dbm: float) -> dict[str, NDArray[Any]]:
    """Return the layers of a map of n receivers, by name.

    Parameters
    ----------
    sums
        Over all paths.
    straight_m
        (n,) distance from the transmitter to each receiver [m].
    power_dbm
        Transmit power [dBm].
    """
    power, moments = sums.power, sums.moments
    n_paths = sums.n_paths.sum(axis=1)
    reached = power > 0.0
    mean = moments / np.where(reached, power, 1.0)[:, None]
    variance = np.maximum(mean[:, EXCESS_SQUARED] - mean[:, EXCESS] ** 2, 0.0)
    focus = mean[:, COSINE] ** 2 + mean[:, SINE] ** 2
    strongest = moments[:, STRONGEST]
    return {
        "rss_dbm": received_dbm(power, power_dbm),
        "rss_coherent_dbm": received_dbm(np.where(reached, coherent_power(sums), 0.0), power_dbm),
        "path_count": path_count(n_paths, power),
        "strongest_path_dbm": received_dbm(strongest, power_dbm),
        "mean_delay_s": np.where(reached, straight_m + mean[:, EXCESS], 0.0) / SPEED_OF_LIGHT,
        "delay_spread_s": np.where(reached, np.sqrt(variance), 0.0) / SPEED_OF_LIGHT,
        "angular_spread": np.where(reached, np.sqrt(np.maximum(1.0 - focus, 0.0)), 0.0),
        "k_factor_db": k_factor_db(strongest, power, n_paths),
        "left_out_db": _ratio_db(sums.left_out, power),
    }


def coherent_power(sums: Sums) -> Floats:
    """Power gains (n,) of the sum of the paths' fields, over all pairs of polarisations."""
    return (np.abs(sums.field) ** 2).sum(axis=1)


def path_count(n_paths: Floats, power: Floats) -> Ints:
    """Return numbers of paths (n,) from their sums of weights, halves upwards.

    At least 1 where any power arrives, also by a grazing path of little weight; 0 where none does,
    as where every path leaves in a null of an antenna.
    """
    rounded = np.maximum(np.floor(n_paths + 0.5), 1.0)
    return np.where(power > 0.0, rounded, 0.0).astype(np.int64)


def received_dbm(power: Floats, power_dbm: float) -> Floats:
    """Received power [dBm] of a power gain, at most the transmit power; -inf for none."""
    dbm = np.full(len(power), -np.inf)
    some = power > 0.0
    dbm[some] = power_dbm + 10.0 * np.log10(np.minimum(power[some], 1.0))
    return dbm


def k_factor_db(strongest: Floats, power: Floats, n_paths: Floats) -> Floats:
    """Strongest path over the sum of all others [dB]; inf for a single path, -inf for none."""
    rest = np.where(n_paths > 1.0, np.maximum(power - strongest, 0.0), 0.0)
    return _ratio_db(strongest, rest)


def _ratio_db(power: Floats, rest: Floats) -> Floats:
    """Power over the rest [dB]: inf where there is no rest, -inf where there is no power."""
    ratio = np.where(power > 0.0, np.inf, -np.inf)
    some = (power > 0.0) & (rest > 0.0)
    ratio[some] = 10.0 * np.log10(power[some] / rest[some])
    return ratio
