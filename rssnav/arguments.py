"""Arguments out of range."""


def require(holds: bool, name: str, value: object, expected: str) -> None:
    """Raise ValueError, naming the parameter, its value and what is expected, unless it holds."""
    if not holds:
        raise ValueError(f"{name} = {value!r}: expected {expected}")
