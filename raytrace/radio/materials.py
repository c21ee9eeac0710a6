"""Building materials, and how a wall of them reflects and transmits a plane wave.

A material is a `Dielectric` with a permittivity over frequency, a `Layered` stack of dielectrics,
or one of two ideals: `PERFECT_CONDUCTOR` and `ABSORBER`. The built-in dielectrics are those of
Recommendation ITU-R P.2040, in the edition asked for (`raytrace.radio.itu`, docs/materials.md).
"""

from dataclasses import dataclass, replace
from difflib import get_close_matches
from math import inf
from typing import NamedTuple

import numpy as np

from raytrace.arrays import Complexes, Floats
from raytrace.constants import TWO_PI, VACUUM_PERMITTIVITY
from raytrace.errors import SceneError
from raytrace.radio.itu import DEFAULT_EDITION, TABLES, Row
from raytrace.radio.slabs import SlabCoefficients, slab_coefficients, stack_coefficients

_LOSS_TOLERANCE_DB = 1e-6
_HALVINGS = 48
"""Halvings of the interval that holds a conductivity."""


@dataclass(frozen=True)
class Dielectric:
    """A homogeneous material: permittivity and conductivity over frequency.

    Attributes
    ----------
    name
        Its name in a floor plan.
    rows
        ``eps_r = a f^b`` and ``sigma = c f^d`` [S/m], f in GHz, each for a range of frequencies;
        where ranges overlap the first counts.
    origin
        Source of the rows, for messages.
    """

    name: str
    rows: tuple[Row, ...]
    origin: str = ""

    @classmethod
    def of_law(
        cls, name: str, a: float, b: float = 0.0, c: float = 0.0, d: float = 0.0
    ) -> "Dielectric":
        """Make a material that follows one law at all frequencies f [GHz].

        Parameters
        ----------
        name
            Its name.
        a, b
            Relative permittivity a f^b.
        c, d
            Conductivity c f^d [S/m].
        """
        return cls(name, (Row(0.0, inf, a, b, c, d),))

    @classmethod
    def of_loss(
        cls,
        name: str,
        permittivity: float,
        loss_db: float,
        frequency_hz: float,
        thickness_m: float,
    ) -> "Dielectric":
        """Make the material of a slab whose transmission loss was measured.

        The conductivity, the same at all frequencies, is the one for which a wave that crosses the
        slab at normal incidence loses `loss_db` at `frequency_hz`, reflection at both faces
        included. Reflection follows from it and from the permittivity, as for any dielectric.

        Parameters
        ----------
        name
            Its name.
        permittivity
            Relative permittivity [1].
        loss_db
            Loss in transmission [dB].
        frequency_hz
            At which it was measured [Hz].
        thickness_m
            Of the slab [m].

        Raises
        ------
        SceneError
            Where a slab without any conductivity loses more, by reflection alone.
        """

        def of(conductivity: float) -> Dielectric:
            return cls.of_law(name, permittivity, c=conductivity)

        def excess_db(conductivity: float) -> float:
            slab = of(conductivity).coefficients(thickness_m, frequency_hz, np.ones(1))
            return -20.0 * float(np.log10(max(abs(slab.t_te[0]), 1e-300))) - loss_db

        if excess_db(0.0) > _LOSS_TOLERANCE_DB:
            least = excess_db(0.0) + loss_db
            raise SceneError(
                f"{name} of thickness {thickness_m:g} m: loss_db = {loss_db:g}, but reflection "
                f"alone loses {least:.2f} dB at {frequency_hz * 1e-9:g} GHz; expected more, or a "
                "lower relative permittivity"
            )
        least, most = 0.0, 1e-3
        while excess_db(most) < 0.0:
            most *= 2.0
        for _ in range(_HALVINGS):
            middle = 0.5 * (least + most)
            least, most = (middle, most) if excess_db(middle) < 0.0 else (least, middle)
        return of(most)

    def complex_permittivity(self, frequency_hz: float) -> complex:
        """Relative permittivity eps_r - j sigma / (omega eps_0), for e^(+j omega t).

        Raises
        ------
        SceneError
            With the ranges in which the material is known, for a frequency in none of them.
        """
        f_ghz = frequency_hz * 1e-9
        for row in self.rows:
            if row.low_ghz <= f_ghz <= row.high_ghz:
                sigma = row.c * f_ghz**row.d
                loss = sigma / (TWO_PI * frequency_hz * VACUUM_PERMITTIVITY)
                return complex(row.a * f_ghz**row.b, -loss)
        ranges = ", ".join(f"{row.low_ghz:g} to {row.high_ghz:g} GHz" for row in self.rows)
        source = f" in {self.origin}" if self.origin else ""
        raise SceneError(
            f"{self.name} at {f_ghz:g} GHz: defined only for {ranges}{source}; "
            "choose one of these frequencies, a different edition, or a material of your own"
        )

    def coefficients(
        self, thickness_m: float, frequency_hz: float, cos_incidence: Floats
    ) -> SlabCoefficients:
        """Reflection and transmission of a slab of it in air.

        Parameters
        ----------
        thickness_m
            Of the slab [m].
        frequency_hz
            Frequency [Hz].
        cos_incidence
            Cosine of the angle between wave and normal; any shape.

        Returns
        -------
        SlabCoefficients
            Arrays of the shape of the angles.

        Raises
        ------
        SceneError
            For a frequency at which the material is not known.
        """
        permittivity = self.complex_permittivity(frequency_hz)
        return slab_coefficients(permittivity, thickness_m, frequency_hz, cos_incidence)


class Layer(NamedTuple):
    """One layer of a stack: its material and its thickness [m]."""

    material: Dielectric
    thickness_m: float


@dataclass(frozen=True)
class Layered:
    """A stack of layers, the first one met first, such as plasterboard, air, plasterboard.

    Attributes
    ----------
    name
        Its name in a floor plan.
    layers
        At least one.
    from_both_sides
        Whether the slab reflects as the mean of its two sides, as a wall does: see `coefficients`.
    """

    name: str
    layers: tuple[Layer, ...]
    from_both_sides: bool = False

    @property
    def thickness_m(self) -> float:
        """Of all layers [m]."""
        return sum(layer.thickness_m for layer in self.layers)

    @property
    def is_symmetric(self) -> bool:
        """Whether the layers are the same from both sides."""
        return self.layers == self.layers[::-1]

    def coefficients(
        self, thickness_m: float, frequency_hz: float, cos_incidence: Floats
    ) -> SlabCoefficients:
        """Reflection and transmission in air; the thickness is that of the layers.

        Transmission is the same from both sides, by reciprocity. Reflection from both sides has
        their mean power and the phase of their mean field. For the parameters see
        `Dielectric.coefficients`.
        """
        stack = [(m.complex_permittivity(frequency_hz), d) for m, d in self.layers]
        front = stack_coefficients(stack, frequency_hz, cos_incidence)
        if not self.from_both_sides or self.is_symmetric:
            return front
        back = stack_coefficients(stack[::-1], frequency_hz, cos_incidence)
        return front._replace(
            r_te=_mean_reflection(front.r_te, back.r_te),
            r_tm=_mean_reflection(front.r_tm, back.r_tm),
        )


def _mean_reflection(front: Complexes, back: Complexes) -> Complexes:
    """Reflection with the mean power of two, and the phase of their sum."""
    power = (np.abs(front) ** 2 + np.abs(back) ** 2) / 2
    return np.sqrt(power) * np.exp(1j * np.angle(front + back))


@dataclass(frozen=True)
class Ideal:
    """A surface with one reflection coefficient at every angle, and no transmission.

    Attributes
    ----------
    name
        Its name in a floor plan.
    reflection
        R_tm, and the negative of R_te: 1 of a perfect conductor, 0 of an absorber.
    """

    name: str
    reflection: float

    def coefficients(
        self, thickness_m: float, frequency_hz: float, cos_incidence: Floats
    ) -> SlabCoefficients:
        """Reflection and transmission, whatever the thickness and the frequency."""
        reflected = np.full(np.shape(cos_incidence), self.reflection, dtype=np.complex128)
        nothing = np.zeros_like(reflected)
        return SlabCoefficients(-reflected, reflected, nothing, nothing)


Material = Dielectric | Layered | Ideal

PERFECT_CONDUCTOR = Ideal("perfect_conductor", 1.0)
ABSORBER = Ideal("absorber", 0.0)
VACUUM = Dielectric.of_law("vacuum", 1.0)
AIR = Dielectric.of_law("air", 1.0)
ANY_EDITION: dict[str, Material] = {m.name: m for m in (VACUUM, AIR, PERFECT_CONDUCTOR, ABSORBER)}
"""Materials outside the Recommendation: vacuum and air at all frequencies, and the ideals."""


def dielectrics_of(edition: str = DEFAULT_EDITION) -> dict[str, Dielectric]:
    """Materials of an edition of ITU-R P.2040 by name, vacuum and air among them.

    Raises
    ------
    SceneError
        For an unknown edition; the message lists the known ones.
    """
    if edition not in TABLES:
        raise SceneError(
            f"no edition {edition!r} of the material table; available: {', '.join(TABLES)}"
        )
    rows = TABLES[edition]
    of_table = {name: Dielectric(name, rows[name], f"ITU-R {edition}") for name in rows}
    return {**of_table, "vacuum": VACUUM, "air": AIR}


MATERIALS: dict[str, Dielectric] = dielectrics_of()
"""The built-in dielectrics of the default edition."""

MATERIAL_NAMES: tuple[str, ...] = tuple(dict.fromkeys((*MATERIALS, *ANY_EDITION)))
"""All built-in names; earlier editions lack some of them."""


def find_material(name: str, edition: str = DEFAULT_EDITION) -> Material:
    """Return the built-in material of a name.

    Parameters
    ----------
    name
        One of `MATERIAL_NAMES`.
    edition
        Of ITU-R P.2040.

    Raises
    ------
    SceneError
        With the nearest known name, where the edition has none.
    """
    known: dict[str, Material] = {**dielectrics_of(edition), **ANY_EDITION}
    if name in known:
        return known[name]
    if name in MATERIAL_NAMES:
        raise SceneError(f"ITU-R {edition} has no {name!r}; available: {', '.join(known)}")
    near = get_close_matches(name, known, n=1)
    hint = f"did you mean {near[0]!r}? " if near else ""
    raise SceneError(f"unknown material {name!r}: {hint}known: {', '.join(known)}")


class Slab(NamedTuple):
    """What a wall, floor or ceiling is made of: a material and its thickness [m]."""

    material: Material
    thickness_m: float

    @classmethod
    def of(
        cls, material: Material | str, thickness_m: float, edition: str = DEFAULT_EDITION
    ) -> "Slab":
        """Make a slab.

        Parameters
        ----------
        material
            A name means the built-in material.
        thickness_m
            From 0 to 10 [m]; of layers their sum.
        edition
            Of ITU-R P.2040, for a material given by name.

        Raises
        ------
        SceneError
            For an unknown name, and a thickness out of range or not that of the layers.
        """
        if isinstance(material, str):
            material = find_material(material, edition)
        if not 0.0 < thickness_m < 10.0:
            raise SceneError(f"{material.name} of thickness {thickness_m} m: expected 0 to 10 m")
        if isinstance(material, Layered) and abs(material.thickness_m - thickness_m) > 1e-6:
            raise SceneError(
                f"{material.name} of thickness {thickness_m:g} m: its layers are "
                f"{material.thickness_m:g} m thick in total"
            )
        return cls(material, float(thickness_m))

    def as_wall(self) -> "Slab":
        """Return the slab as a wall has it: with one reflection for both of its sides."""
        if not isinstance(self.material, Layered) or self.material.is_symmetric:
            return self
        return self._replace(material=replace(self.material, from_both_sides=True))
