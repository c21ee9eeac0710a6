"""Physical constants (CODATA 2018), SI."""

from math import pi

SPEED_OF_LIGHT = 299_792_458.0
"""Speed of light in vacuum [m/s]."""

VACUUM_PERMITTIVITY = 8.854_187_8128e-12
"""Vacuum permittivity [F/m]."""

TWO_PI = 2.0 * pi
