"""Checks of the numbers that define an antenna, before fields are computed from them."""

from math import hypot, isfinite

from raytrace.arrays import Floats

Vector = tuple[float, float, float]

MAX_GAIN_DB = 300.0
"""Magnitude up to which a gain [dB] is accepted: products of gains stay within float64."""
MAX_WEIGHT = 1e15
"""Largest magnitude of an element's weight, of that gain."""
MAX_ELEMENTS = 4096
"""Most elements of an array."""
MAX_OFFSET = 1e6
"""Largest offset of an element [wavelengths]; its phase is then known to 1e-9 of a turn."""


def check_gain_db(name: str, gain_db: float) -> None:
    """Raise ValueError for a gain [dB] that is NaN or beyond `MAX_GAIN_DB`."""
    if not abs(gain_db) <= MAX_GAIN_DB:
        raise ValueError(
            f"{name} = {gain_db}: expected a number from {-MAX_GAIN_DB:g} to {MAX_GAIN_DB:g} dB"
        )


def unit_vector(name: str, direction: Vector | Floats) -> Vector:
    """Return a direction of any length as a unit vector.

    Raises
    ------
    ValueError
        Where it is none.
    """
    length = hypot(*direction)
    if abs(length - 1.0) < 1e-12:  # so that a unit vector stays the same to the last bit
        length = 1.0
    if len(direction) != 3 or not (isfinite(length) and length > 0.0):
        raise ValueError(f"{name} = {direction}: expected three finite numbers, not all 0")
    x, y, z = (float(part) / length for part in direction)
    return x, y, z


def check_elements(name: str, n: float) -> None:
    """Raise ValueError for a number of elements that is not an integer in range."""
    if not (1 <= n <= MAX_ELEMENTS and n % 1 == 0):
        raise ValueError(f"{name} = {n}: expected an integer from 1 to {MAX_ELEMENTS}")
