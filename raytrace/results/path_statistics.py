"""Statistics of a receiver's paths: powers, delays, directions (docs/theory.md, section 13).

The map's kernels compute the same sums per cell; this is the plain computation from single paths.
"""

from dataclasses import dataclass

import numpy as np

from raytrace.arrays import Floats, Ints
from raytrace.results.layers import k_factor_db, path_count
from raytrace.results.paths import Paths


@dataclass(frozen=True, eq=False)
class PathStatistics:
    """Statistics of n receivers, each weighted with the paths' power gains.

    A receiver without a path, or with every path in a null of an antenna, has levels of -inf and
    0 for the rest.

    Attributes
    ----------
    path_count
        (n,) int64 number of paths; at least 1 where any power arrives.
    rss_dbm
        (n,) sum of the paths' powers [dBm], eq. 33.
    rss_coherent_dbm
        (n,) power of the sum of the paths' fields [dBm].
    strongest_path_dbm
        (n,) power of the strongest path [dBm].
    mean_delay_s, delay_spread_s
        (n,) mean delay and RMS delay spread [s], eqs. 34-35.
    angular_spread
        (n,) spread of the azimuths of arrival after Fleury, 0 to 1, eq. 36.
    k_factor_db
        (n,) strongest path over the sum of all others [dB], eq. 37; inf for a single path.
    """

    path_count: Ints
    rss_dbm: Floats
    rss_coherent_dbm: Floats
    strongest_path_dbm: Floats
    mean_delay_s: Floats
    delay_spread_s: Floats
    angular_spread: Floats
    k_factor_db: Floats

    @classmethod
    def of(cls, paths: Paths, power_dbm: float, n_receivers: int) -> "PathStatistics":
        """Compute them.

        Parameters
        ----------
        paths
            To any of the receivers 0 to n_receivers - 1.
        power_dbm
            Transmit power [dBm].
        n_receivers
            How many there are, reached or not.
        """
        sums = _Sums(paths, n_receivers)
        power = sums.of(sums.power)
        strongest = np.zeros(n_receivers)
        np.maximum.at(strongest, paths.receiver, np.abs(paths.gain) ** 2)
        mean_s = sums.mean(paths.delay_s)
        variance = sums.mean((paths.delay_s - mean_s[paths.receiver]) ** 2)
        azimuth = paths.arrival[:, 0]
        east, north = sums.mean(np.cos(azimuth)), sums.mean(np.sin(azimuth))
        spread = np.sqrt(np.maximum(1.0 - east**2 - north**2, 0.0))
        coherent = sums.coherent_power(paths)
        return cls(
            path_count=path_count(sums.of(paths.weight), power),
            rss_dbm=power_dbm + _decibels(power),
            rss_coherent_dbm=power_dbm + _decibels(coherent),
            strongest_path_dbm=power_dbm + _decibels(strongest),
            mean_delay_s=mean_s,
            delay_spread_s=np.sqrt(variance),
            angular_spread=np.where(power > 0.0, spread, 0.0),
            k_factor_db=k_factor_db(strongest, power, sums.of(paths.weight)),
        )


class _Sums:
    """Sums over each receiver's paths, plain and weighted with power."""

    def __init__(self, paths: Paths, n_receivers: int) -> None:
        self.power = paths.weight * np.abs(paths.gain) ** 2
        self._receiver = paths.receiver
        self._n = n_receivers
        self._total = self.of(self.power)

    def of(self, values: Floats) -> Floats:
        """Sum (n,) of the paths' values at each receiver."""
        sums = np.zeros(self._n)
        np.add.at(sums, self._receiver, values)
        return sums

    def coherent_power(self, paths: Paths) -> Floats:
        """Power (n,) of the sum of the paths' fields at each receiver, over all polarisations."""
        pairs = paths.gain[:, None] if paths.pair_gains is None else paths.pair_gains
        power = np.zeros(self._n)
        for gain in pairs.T:
            weighted = paths.weight * gain
            power += self.of(weighted.real) ** 2 + self.of(weighted.imag) ** 2
        return power

    def mean(self, values: Floats) -> Floats:
        """Mean (n,) of the paths' values at each receiver, weighted with power; 0 without."""
        total = np.where(self._total > 0.0, self._total, 1.0)
        return self.of(self.power * values) / total


def _decibels(power: Floats) -> Floats:
    with np.errstate(divide="ignore"):
        return 10.0 * np.log10(power)
