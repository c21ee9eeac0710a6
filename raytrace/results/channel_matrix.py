"""Channels between the elements of two antenna arrays, from paths between their positions."""

from operator import index

import numpy as np

from raytrace.arrays import Complexes, Floats
from raytrace.memory import check_size
from raytrace.radio.antenna_array import AntennaArray
from raytrace.results.paths import Paths

MAX_OFFSET_HZ = 1e15
"""Largest offset from the carrier [Hz]."""
_SINGLE = AntennaArray()


def channel_matrix(
    paths: Paths,
    transmit: AntennaArray = _SINGLE,
    receive: AntennaArray = _SINGLE,
    *,
    offsets_hz: Floats | tuple[float, ...] = (0.0,),
    n_receivers: int | None = None,
) -> Complexes:
    """Channels from every element of a transmitter's array to every element of a receiver's.

    Each path arrives as a plane wave: its gain is turned by the phase of each element towards its
    direction (`AntennaArray.response`), and by its delay at frequencies off the carrier
    (docs/theory.md, section 13).

    Parameters
    ----------
    paths
        Traced with an element of each array as antenna, not with the arrays.
    transmit, receive
        The arrays; their elements' patterns and weights are not used. One element by default.
    offsets_hz
        (n_offsets,) frequencies off the carrier [Hz], over which antennas and materials are
        regarded as constant.
    n_receivers
        How many; by default up to the last one that a path reaches.

    Returns
    -------
    ndarray
        (n_receivers, n_offsets, n_receive, n_transmit) complex; 0 for a receiver without a path.

    Raises
    ------
    ValueError
        For antennas of unknown polarisation, a path to a receiver beyond `n_receivers`, or offsets
        that are not finite.
    MemoryLimitError
        For more channels than half of the free memory holds.
    """
    offsets = np.asarray(offsets_hz, dtype=np.float64)
    if offsets.ndim != 1 or not (np.abs(offsets) <= MAX_OFFSET_HZ).all():
        raise ValueError(f"offsets_hz = {offsets_hz}: expected a list of numbers, up to 1e15 Hz")
    paths.check_polarisation()
    most = int(paths.receiver.max(initial=-1)) + 1
    n = most if n_receivers is None else index(n_receivers)
    if n < most:
        raise ValueError(f"n_receivers = {n}: expected at least {most}, paths reach so many")
    check_size("channels", 16 * n * max(len(offsets), 1) * len(receive) * len(transmit))
    check_size("phases of paths", 32 * len(paths) * (len(offsets) + len(receive) + len(transmit)))
    departing = transmit.response(paths.departure_direction)
    arriving = receive.response(paths.arrival_direction)
    phase = -2.0 * np.pi * offsets[:, None] * paths.delay_s
    gains = paths.weight * paths.gain * np.exp(1j * phase)
    channels = np.zeros((n, len(gains), len(receive), len(transmit)), dtype=np.complex128)
    for receiver in range(n):
        own = np.flatnonzero(paths.receiver == receiver)
        channels[receiver] = np.einsum(
            "fp,pr,pt->frt", gains[:, own], arriving[own], departing[own], optimize=True
        )
    return channels
