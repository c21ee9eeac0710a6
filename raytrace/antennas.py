"""Antennas: what a transmitter or a receiver has, and how to write your own.

An antenna is any object with the methods of `Antenna`. `Rotated.towards` points one in a direction,
`AntennaArray` combines several, and `PatternTable` holds a measured pattern.
"""

from raytrace.radio.antenna_array import AntennaArray
from raytrace.radio.antennas import (
    DIPOLE_PEAK_GAIN_DBI,
    Amplitudes,
    Antenna,
    HalfWaveDipole,
    Isotropic,
)
from raytrace.radio.directive import Monopole, Patch, Sector
from raytrace.radio.pattern_table import PatternTable
from raytrace.radio.rotated import Rotated

__all__ = [
    "DIPOLE_PEAK_GAIN_DBI",
    "Amplitudes",
    "Antenna",
    "AntennaArray",
    "HalfWaveDipole",
    "Isotropic",
    "Monopole",
    "Patch",
    "PatternTable",
    "Rotated",
    "Sector",
]
