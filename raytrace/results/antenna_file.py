"""Antennas in map files: by name and parameters where they are known, otherwise as a table."""

from dataclasses import fields
from typing import Any

import h5py
import numpy as np

from raytrace.errors import AntennaError
from raytrace.radio.antennas import Antenna, HalfWaveDipole, Isotropic
from raytrace.radio.directive import Monopole, Patch, Sector
from raytrace.radio.pattern_table import PatternTable
from raytrace.results.checked_hdf5 import Checked, Hdf5ContentError
from raytrace.results.hdf5 import write_array

TRANSMIT, RECEIVE = "transmit_antenna", "receive_antenna"
"""Prefixes of an antenna's attributes, and names of the groups of their arrays."""

_OF_NUMBERS = {kind.__name__: kind for kind in (Monopole, Patch, Sector)}
"""Antennas that are given by numbers alone, by name."""
_NAMED = (HalfWaveDipole, Isotropic, PatternTable, *_OF_NUMBERS.values())
_PATTERN_ARRAYS = {
    "theta_deg": ("deg", "angle from the zenith"),
    "phi_deg": ("deg", "angle from +x towards +y"),
    "e_theta": ("1", "amplitude along theta-hat, relative to a 0 dBi radiator"),
    "e_phi": ("1", "amplitude along phi-hat, relative to a 0 dBi radiator"),
}


def as_stored(antenna: Antenna) -> Antenna:
    """Return an antenna as a file gives it back: an unknown one as a `PatternTable`."""
    return antenna if type(antenna) in _NAMED else PatternTable.of(antenna)


def antenna_attributes(key: str, antenna: Antenna) -> dict[str, Any]:
    """Return kind and parameters of an antenna, without its arrays, as attributes."""
    stored = as_stored(antenna)
    parameters = {k: v for k, v in _fields(stored).items() if not isinstance(v, np.ndarray)}
    return {key: type(stored).__name__, **{f"{key}_{k}": v for k, v in parameters.items()}}


def write_pattern(antenna: Antenna, file: h5py.Group, key: str) -> None:
    """Write the arrays of an antenna that has any."""
    for name, value in _fields(as_stored(antenna)).items():
        if isinstance(value, np.ndarray):
            units, long_name = _PATTERN_ARRAYS[name]
            write_array(file.require_group(key), name, value, units, long_name)


def read_antenna(file: Checked, key: str) -> Antenna:
    """Read an antenna.

    Raises
    ------
    Hdf5ContentError
        Where it is no antenna of a map file, or its parameters are wrong.
    """
    try:
        return _read(file, key)
    except Hdf5ContentError:
        raise
    except AntennaError as error:
        raise Hdf5ContentError(f"attribute {key!r}: {error}") from error
    except ValueError as error:  # it begins with the name of a parameter
        raise Hdf5ContentError(f"attribute {key}_{error}") from error


def _read(file: Checked, key: str) -> Antenna:
    """Read an antenna, whose class raises ValueError for wrong parameters."""
    kind = file.text(key)
    if kind == HalfWaveDipole.__name__:
        gain_db = file.number(f"{key}_peak_gain_db")
        if (axis := f"{key}_axis") not in file.attribute_names:
            return HalfWaveDipole(gain_db)
        x, y, z = file.numbers(axis, 3)
        return HalfWaveDipole(gain_db, (x, y, z))
    if kind == Isotropic.__name__:
        return _read_isotropic(file, key)
    if kind in _OF_NUMBERS:
        of_numbers = _OF_NUMBERS[kind]
        return of_numbers(**{f.name: file.number(f"{key}_{f.name}") for f in fields(of_numbers)})
    if kind != PatternTable.__name__:
        raise Hdf5ContentError(f"attribute {key!r}: {kind!r} is not an antenna of a map file")
    pattern, sizes = file.within(key), (f"{key}.n_theta", f"{key}.n_phi")
    return PatternTable(
        pattern.array("theta_deg", np.float64, sizes[:1]),
        pattern.array("phi_deg", np.float64, sizes[1:]),
        pattern.array("e_theta", np.complex128, sizes),
        pattern.array("e_phi", np.complex128, sizes),
        file.text(f"{key}_name"),
    )


def _read_isotropic(file: Checked, key: str) -> Isotropic:
    """Read an isotropic antenna; files of before it had a polarisation have vertical ones."""
    gain_db, name = file.number(f"{key}_gain_db"), f"{key}_polarisation"
    polarisation: Any = file.text(name) if name in file.attribute_names else "vertical"
    return Isotropic(gain_db, polarisation)


def _fields(antenna: Antenna) -> dict[str, Any]:
    """Return what defines an antenna of a known kind, by name."""
    assert isinstance(antenna, _NAMED)
    return {field.name: getattr(antenna, field.name) for field in fields(antenna)}


def read_receive_antenna(file: Checked) -> Antenna:
    """Read the receivers' antenna; the default one in a file of before it was stored."""
    return read_antenna(file, RECEIVE) if RECEIVE in file.attribute_names else HalfWaveDipole()
