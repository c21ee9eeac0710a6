"""Limits of a trace are checked, and kept as the types that kernels are compiled for."""

import math

import numpy as np
import pytest

from raytrace import TraceConfig, Transmitter

LIMITS = ("max_reflections", "max_diffractions", "max_transmissions", "max_paths")


def test_numbers_of_other_types_are_converted() -> None:
    config = TraceConfig(np.int64(3), True, 1.0, np.float32(-90), np.uint8(7))
    values = [getattr(config, name) for name in (*LIMITS, "min_power_dbm")]
    assert config == TraceConfig(3, 1, 1, -90.0, 7)
    assert [type(value) for value in values] == [int, int, int, int, float]
    transmitter = Transmitter((1, 2, 3), np.float32(20), 2_400_000_000)
    assert type(transmitter.power_dbm) is type(transmitter.frequency_hz) is float


@pytest.mark.parametrize("name", LIMITS)
@pytest.mark.parametrize("value", [-1, 0.5, 2**63, math.inf, math.nan])
def test_limits_are_integers_within_range(name: str, value: float) -> None:
    with pytest.raises(ValueError, match=rf"{name} = .*: expected an integer from [01] to "):
        TraceConfig(**{name: value})
