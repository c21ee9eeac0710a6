"""Arguments out of range."""

import math
from numbers import Integral


def is_finite(value: float) -> bool:
    """Whether a number of any type is finite as float64; whole numbers may be too large for it."""
    try:
        return math.isfinite(value)
    except OverflowError:
        return False


def is_whole(value: object, low: int, high: int) -> bool:
    """Whether something is a whole number, of Python or NumPy, from ``low`` to ``high``."""
    if isinstance(value, bool) or not isinstance(value, Integral):
        return False
    return low <= int(value) <= high


def require(holds: bool, name: str, value: object, expected: str) -> None:
    """Raise ValueError, naming the parameter, its value and what is expected, unless it holds."""
    if not holds:
        raise ValueError(f"{name} = {value!r}: expected {expected}")
