"""What users of the benchmark can correct."""


class BenchmarkError(ValueError):
    """An option, a policy or a file of results that the benchmark cannot use."""


def check(holds: bool, name: str, value: object, expected: str) -> None:
    """Raise `BenchmarkError`, with the option, its value and what is expected, unless it holds."""
    if not holds:
        raise BenchmarkError(f"{name}: {value!r}; expected {expected}")
