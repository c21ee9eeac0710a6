"""An antenna given by a table of its pattern, from arrays or from a CSV file."""

import csv
import io
from dataclasses import dataclass
from itertools import product
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import RegularGridInterpolator

from raytrace.arrays import Complexes, Floats, Ints
from raytrace.errors import AntennaError
from raytrace.radio.antenna_checks import MAX_WEIGHT
from raytrace.radio.antennas import Amplitudes, Antenna

ANGLE_KEYS = ("theta_deg", "phi_deg")
GAIN_KEYS = ("gain_dbi", "gain_theta_dbi", "gain_phi_dbi")
PHASE_KEYS = ("phase_theta_deg", "phase_phi_deg")
TOLERANCE_DEG = 1e-6
MAX_CHARACTERS = 30_000_000
"""Largest pattern file that is read."""
LEAST_STEP_DEG = 0.1
"""Smallest step of a table that is made of another antenna [deg]."""


@dataclass(frozen=True, eq=False)
class PatternTable:
    """An antenna whose field is given on a grid of directions and interpolated linearly.

    Amplitudes are relative to a 0 dBi radiator: the sum of their squared
    magnitudes is the gain. Nothing is normalised; `mean_gain` of a lossless antenna is 1.

    Attributes
    ----------
    theta_deg
        (n_theta,) rising from 0, the zenith, to 180 [deg].
    phi_deg
        (n_phi,) rising from 0, +x, towards +y to 360 [deg].
    e_theta, e_phi
        (n_theta, n_phi) complex amplitudes along theta-hat and phi-hat, for e^(+j omega t).
    name
        For `describe`.

    Raises
    ------
    AntennaError
        Where the angles do not cover the sphere, or the amplitudes are of another
        shape or too large.
    """

    theta_deg: Floats
    phi_deg: Floats
    e_theta: Complexes
    e_phi: Complexes
    name: str = "pattern table"

    def __post_init__(self) -> None:
        """Check the grid; raise `AntennaError` where it does not cover the sphere."""
        shape = (np.size(self.theta_deg), np.size(self.phi_deg))
        for key, values, last in (
            ("theta_deg", self.theta_deg, 180.0),
            ("phi_deg", self.phi_deg, 360.0),
        ):
            if np.ndim(values) != 1 or np.size(values) < 2:
                raise AntennaError(f"{self.name}: {key} of shape {np.shape(values)}: expected (n,)")
            ends = np.abs(np.array([values[0], values[-1]]) - (0.0, last))
            if not (np.diff(values) > 0.0).all() or ends.max() > TOLERANCE_DEG:
                raise AntennaError(
                    f"{self.name}: {key} runs from {values[0]:g} to {values[-1]:g}: expected "
                    f"rising values from 0 to {last:g}"
                )
        for key, values in (("e_theta", self.e_theta), ("e_phi", self.e_phi)):
            if values.shape != shape or not (np.abs(values) <= MAX_WEIGHT).all():
                raise AntennaError(
                    f"{self.name}: {key} of shape {values.shape}: expected finite numbers {shape}, "
                    f"up to {MAX_WEIGHT:g}"
                )

    def __repr__(self) -> str:
        """Name and directions in one line."""
        n, m = self.e_theta.shape
        return f"<PatternTable {self.name!r}: {n} x {m} directions>"

    def __eq__(self, other: object) -> bool:
        """Whether another antenna has the same table."""
        return isinstance(other, PatternTable) and all(
            np.array_equal(getattr(self, key), getattr(other, key))
            for key in ("theta_deg", "phi_deg", "e_theta", "e_phi")
        )

    def __hash__(self) -> int:
        """Equal tables have equal hashes."""
        return hash((self.e_theta.tobytes(), self.e_phi.tobytes()))

    @classmethod
    def of_gain(
        cls, theta_deg: ArrayLike, phi_deg: ArrayLike, gain_dbi: ArrayLike, name: str = "gain table"
    ) -> "PatternTable":
        """Make a vertically polarised antenna without phase from a gain [dBi] (n_theta, n_phi)."""
        with np.errstate(over="ignore"):  # infinite ones are refused below
            amplitude = np.asarray(10.0 ** (np.asarray(gain_dbi) / 20.0), dtype=np.complex128)
        theta, phi = (np.asarray(angle, dtype=np.float64) for angle in (theta_deg, phi_deg))
        return cls(theta, phi, -amplitude, np.zeros_like(amplitude), name)

    @classmethod
    def of(cls, antenna: Antenna, step_deg: float = 1.0) -> "PatternTable":
        """Tabulate any antenna.

        Parameters
        ----------
        antenna
            Of known polarisation.
        step_deg
            Between directions [deg], 0.1 to 90; a divisor of 180.

        Raises
        ------
        AntennaError
            For a step out of range.
        """
        if not LEAST_STEP_DEG <= step_deg <= 90.0:
            raise AntennaError(f"step_deg = {step_deg}: expected {LEAST_STEP_DEG:g} to 90 deg")
        theta = np.linspace(0.0, 180.0, round(180.0 / step_deg) + 1)
        phi = np.linspace(0.0, 360.0, round(360.0 / step_deg) + 1)
        sine = np.sin(np.radians(90.0 - theta))
        at = np.meshgrid(sine, np.radians(phi), indexing="ij")
        v, h = (np.asarray(part, dtype=np.complex128) for part in antenna.amplitudes(*at))
        return cls(theta, phi, -v, h, antenna.describe())

    @classmethod
    def from_csv(cls, path: str | Path) -> "PatternTable":
        """Read a pattern from a CSV file with a line of headings.

        Parameters
        ----------
        path
            Columns ``theta_deg`` and ``phi_deg``, and either ``gain_dbi`` (vertically polarised) or
            ``gain_theta_dbi`` and ``gain_phi_dbi``, the latter optionally with ``phase_theta_deg``
            and ``phase_phi_deg``. One line for every pair of angles, in any order.

        Raises
        ------
        AntennaError
            For a file of another form; the message names file, line and column.
        """
        columns = _read_columns(Path(path))
        theta, phi = (np.unique(columns[key]) for key in ANGLE_KEYS)
        order = _grid_order(columns, theta, phi, Path(path))
        grids = {
            key: column[order].reshape(len(theta), len(phi)) for key, column in columns.items()
        }
        if "gain_dbi" in grids:
            return cls.of_gain(theta, phi, grids["gain_dbi"], Path(path).name)
        return cls(theta, phi, _field(grids, "theta"), _field(grids, "phi"), Path(path).name)

    @property
    def mean_gain(self) -> float:
        """Gain averaged over the sphere, the radiated part of the power fed; 1 without loss."""
        theta, phi = np.radians(self.theta_deg), np.radians(self.phi_deg)
        gain = np.abs(self.e_theta) ** 2 + np.abs(self.e_phi) ** 2
        around = np.trapezoid(gain, phi, axis=1)
        return float(np.trapezoid(around * np.sin(theta), theta) / (4.0 * np.pi))

    def amplitudes(self, sine: Floats, azimuth: Floats) -> Amplitudes:
        """Field amplitudes towards directions; see `raytrace.radio.antennas.Antenna.amplitudes`."""
        theta = np.degrees(np.arccos(np.clip(sine, -1.0, 1.0)))
        at = np.stack([theta, np.degrees(azimuth) % 360.0], axis=-1)
        fields = np.stack([-self.e_theta, self.e_phi], axis=-1)
        found = RegularGridInterpolator((self.theta_deg, self.phi_deg), fields)(at)
        return Amplitudes(found[..., 0], found[..., 1])

    def describe(self) -> str:
        """Name and size in one line."""
        n_theta, n_phi = self.e_theta.shape
        return f"{self.name}, {n_theta} x {n_phi} directions, mean gain {self.mean_gain:.3g}"


def _field(grids: dict[str, Floats], part: str) -> Complexes:
    """Complex amplitudes of one component, from its gain [dBi] and its phase [deg] if given."""
    phase = np.radians(grids.get(f"phase_{part}_deg", np.zeros(1)))
    with np.errstate(over="ignore", invalid="ignore"):  # infinite ones are refused afterwards
        amplitude = 10.0 ** (grids[f"gain_{part}_dbi"] / 20.0)
        return np.asarray(amplitude * np.exp(1j * phase), dtype=np.complex128)


def _read_columns(path: Path) -> dict[str, Floats]:
    """Columns of a pattern file by their headings."""
    try:
        with path.open(newline="", encoding="utf-8") as file:
            text = file.read(MAX_CHARACTERS + 1)
        if len(text) > MAX_CHARACTERS:
            raise AntennaError(f"{path}: more than {MAX_CHARACTERS} characters")
        rows = list(csv.DictReader(io.StringIO(text, newline="")))
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise AntennaError(f"{path}: the file cannot be read: {error}") from error
    keys = tuple(rows[0]) if rows else ()
    if None in keys:
        raise AntennaError(f"{path}, line 2: more values than the {len(keys) - 1} headings")
    known = (*ANGLE_KEYS, *GAIN_KEYS, *PHASE_KEYS)
    both = {"gain_theta_dbi", "gain_phi_dbi"} <= set(keys)
    if (
        not set(ANGLE_KEYS) <= set(keys)
        or not set(keys) <= set(known)
        or both == ("gain_dbi" in keys)
    ):
        raise AntennaError(
            f"{path}: columns {', '.join(keys) or 'none'}: expected theta_deg, phi_deg and either "
            "gain_dbi, or gain_theta_dbi and gain_phi_dbi with phase_theta_deg, phase_phi_deg"
        )
    return {key: _numbers(path, key, [row[key] for row in rows]) for key in keys}


def _numbers(path: Path, key: str, texts: list[str]) -> Floats:
    """Numbers of a column; -inf dBi, a null, is taken as -400."""
    numbers = np.empty(len(texts))
    for line, text in enumerate(texts, 2):
        try:
            numbers[line - 2] = max(float(text), -400.0)
        except (TypeError, ValueError):
            raise AntennaError(
                f"{path}, line {line}: {key} = {text!r}: expected a number"
            ) from None
    return numbers


def _grid_order(columns: dict[str, Floats], theta: Floats, phi: Floats, path: Path) -> Ints:
    """Line of each pair of angles, phi running fastest."""
    pairs = zip(columns["theta_deg"], columns["phi_deg"], strict=True)
    line_of = {pair: line for line, pair in enumerate(pairs)}
    for pair in product(theta, phi):
        if pair not in line_of:
            raise AntennaError(
                f"{path}: no line for theta_deg = {pair[0]:g}, phi_deg = {pair[1]:g}: expected "
                f"every pair of the {len(theta)} and {len(phi)} angles once"
            )
    return np.array([line_of[pair] for pair in product(theta, phi)])
