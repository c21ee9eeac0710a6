"""Arguments out of range."""

import sys


def is_finite(value: float) -> bool:
    """Whether a number is finite as float64; whole numbers of any size are compared as they are."""
    return -sys.float_info.max <= value <= sys.float_info.max


def require(holds: bool, name: str, value: object, expected: str) -> None:
    """Raise ValueError, naming the parameter, its value and what is expected, unless it holds."""
    if not holds:
        raise ValueError(f"{name} = {value!r}: expected {expected}")
