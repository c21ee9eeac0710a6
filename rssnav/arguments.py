"""Arguments out of range."""

import math


def is_finite(value: float) -> bool:
    """Whether a number of any type is finite as float64; whole numbers may be too large for it."""
    try:
        return math.isfinite(value)
    except OverflowError:
        return False


def require(holds: bool, name: str, value: object, expected: str) -> None:
    """Raise ValueError, naming the parameter, its value and what is expected, unless it holds."""
    if not holds:
        raise ValueError(f"{name} = {value!r}: expected {expected}")
