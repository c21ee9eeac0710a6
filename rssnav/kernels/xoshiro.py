"""xoshiro256++ (Blackman and Vigna, 2021), a generator whose state lives in registers.

The state is four ``uint64``: passed and returned by value by :func:`next_uint64`, so that a loop
can keep it in local variables, or kept in an array by :func:`draw`.
:class:`numpy.random.SeedSequence` supplies the seeds; see :mod:`rssnav.training`.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from rssnav.kernels.compiling import jit

_23 = np.uint64(23)
_41 = np.uint64(41)
_17 = np.uint64(17)
_45 = np.uint64(45)
_19 = np.uint64(19)
_32 = np.uint64(32)
_11 = np.uint64(11)
_LOW_32 = np.uint64(0xFFFFFFFF)
_UNIT_32 = 2.0**-32
_UNIT_53 = 2.0**-53


@jit(inline=True)
def next_uint64(
    s0: np.uint64, s1: np.uint64, s2: np.uint64, s3: np.uint64
) -> tuple[np.uint64, np.uint64, np.uint64, np.uint64, np.uint64]:
    """Next 64 random bits and the advanced state: ``(bits, s0, s1, s2, s3)``."""
    total = s0 + s3
    bits = ((total << _23) | (total >> _41)) + s0
    shifted = s1 << _17
    s2 ^= s0
    s3 ^= s1
    s1 ^= s2
    s0 ^= s3
    s2 ^= shifted
    s3 = (s3 << _45) | (s3 >> _19)
    return bits, s0, s1, s2, s3


@jit(inline=True)
def draw(generator: NDArray[np.uint64]) -> np.uint64:
    """Next 64 random bits of a generator kept in an array (4,), which advances."""
    bits, generator[0], generator[1], generator[2], generator[3] = next_uint64(
        generator[0], generator[1], generator[2], generator[3]
    )
    return bits


@jit(inline=True)
def unit_from_high_bits(bits: np.uint64) -> float:
    """Uniform number in [0, 1) from the upper 32 bits."""
    return np.float64(bits >> _32) * _UNIT_32


@jit(inline=True)
def index_from_low_bits(bits: np.uint64, count: np.uint64) -> np.uint64:
    """Uniform index in 0..count-1 from the lower 32 bits (multiply-shift; bias < count / 2^32)."""
    return ((bits & _LOW_32) * count) >> _32


@jit(inline=True)
def gaussian(bits_a: np.uint64, bits_b: np.uint64) -> float:
    """Standard normal number from two draws (Box-Muller), at most 8.6 in magnitude."""
    radius = math.sqrt(-2.0 * math.log((np.float64(bits_a >> _11) + 1.0) * _UNIT_53))
    return radius * math.cos(2.0 * math.pi * _UNIT_53 * np.float64(bits_b >> _11))
