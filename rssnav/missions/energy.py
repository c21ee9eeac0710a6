"""Energy of a multirotor: power over speed, hover, and turns.

Power in straight flight is the model of Zeng, Xu and Zhang (IEEE Trans. Wireless Commun. 18(4),
2019, doi:10.1109/TWC.2019.2902559, eq. 12): blade profile, induced and parasite power,

    P(V) = P_0 (1 + 3 V^2 / U_tip^2)
         + P_i (sqrt(1 + V^4 / (4 v_0^4)) - V^2 / (2 v_0^2))^(1/2)
         + 1/2 d_0 rho s A V^3,

    P_0 = delta/8 rho s A Omega^3 R^3,   P_i = (1 + k) W^(3/2) / sqrt(2 rho A),
    v_0 = sqrt(W / (2 rho A)).

The defaults of Zeng et al. are of a craft of 20 N (2 kg) with a rotor disc of 0.5 m^2. Those here
are of an indoor craft of 0.6 kg: its disc area is scaled with the weight, so that v_0 and the power
by weight stay.

A turn costs energy by one of two models:

- by angle: a constant per degree, measured by Modares, Ghanei, Mastronarde and Dantu (ICRA 2017,
  "UB-ANC Planner", doi:10.1109/ICRA.2017.7989732) as 17.3 J per degree beside 116.4 J per metre for
  a quadcopter;
- by braking: the craft stops and accelerates again, a multirotor recovering nothing: of its kinetic
  energy 1/2 m V^2 the part along the old direction is lost and must be built up along the new one,
  m V^2 (1 - cos(angle)) / 2 divided by the efficiency of the drive.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from rssnav.arguments import is_finite, require

_GRAVITY = 9.81


def turn_deg(heading: NDArray[np.integer], action: NDArray[np.integer]) -> NDArray[np.float64]:
    """Angle between two of the eight directions [degrees], 0 to 180."""
    difference = np.abs(heading - action)
    return 45.0 * np.minimum(difference, 8 - difference)


@dataclass(frozen=True)
class MultirotorEnergy:
    """Energy of a multirotor that flies one step a second.

    Parameters
    ----------
    mass_kg : float
        Mass [kg].
    disc_area_m2 : float
        Total area of the rotor discs [m^2].
    tip_speed_m_s : float
        Speed of the blade tips [m/s].
    drag_ratio, solidity, profile_drag, induced_factor : float
        d_0, s, delta and k of the model.
    air_density : float
        [kg/m^3].
    turns : {"angle", "braking", "free"}
        Model of a turn.
    turn_j_per_deg : float
        Energy per degree for "angle" [J]. The default is the measured one, scaled with the mass
        from the 3 kg of that craft.
    efficiency : float
        Of the drive, for "braking".

    Raises
    ------
    ValueError
        For a number that is not positive, or another way to turn.
    """

    mass_kg: float = 0.6
    disc_area_m2: float = 0.15
    tip_speed_m_s: float = 120.0
    drag_ratio: float = 0.6
    solidity: float = 0.05
    profile_drag: float = 0.012
    induced_factor: float = 0.1
    air_density: float = 1.225
    turns: Literal["angle", "braking", "free"] = "angle"
    turn_j_per_deg: float = 17.3 * 0.6 / 3.0
    efficiency: float = 0.5

    def __post_init__(self) -> None:
        for name in ("mass_kg", "disc_area_m2", "tip_speed_m_s", "air_density", "efficiency"):
            value = getattr(self, name)
            require(value > 0.0 and is_finite(value), name, value, "a positive number")
        least = self.turn_j_per_deg >= 0.0 and is_finite(self.turn_j_per_deg)
        require(least, "turn_j_per_deg", self.turn_j_per_deg, "a number of at least 0 J")
        kinds = ("angle", "braking", "free")
        require(self.turns in kinds, "turns", self.turns, " or ".join(map(repr, kinds)))

    def power_w(self, speed_m_s: NDArray[np.float64] | float) -> NDArray[np.float64]:
        """Power [W] in straight flight at constant speeds [m/s], of any shape."""
        v2 = np.square(np.asarray(speed_m_s, dtype=np.float64))
        weight_n = self.mass_kg * _GRAVITY
        disc = self.air_density * self.disc_area_m2
        blade_w = self.profile_drag / 8.0 * self.solidity * disc * self.tip_speed_m_s**3
        induced_w = (1.0 + self.induced_factor) * weight_n**1.5 / math.sqrt(2.0 * disc)
        hover2 = weight_n / (2.0 * disc)  # v_0^2
        profile = blade_w * (1.0 + 3.0 * v2 / self.tip_speed_m_s**2)
        ratio = v2 / (2.0 * hover2)
        # sqrt(1 + r^2) - r without the cancellation at high speed
        induced = induced_w / np.sqrt(np.sqrt(1.0 + ratio**2) + ratio)
        parasite = 0.5 * self.drag_ratio * self.solidity * disc * v2**1.5
        return profile + induced + parasite

    @property
    def hover_j(self) -> float:
        """Energy of a second of hovering [J]."""
        return float(self.power_w(0.0))

    def turn_j(self, angle_deg: NDArray[np.float64], speed_m_s: float) -> NDArray[np.float64]:
        """Energy [J] of turns by ``angle_deg`` [degrees], of any shape, at ``speed_m_s`` [m/s]."""
        if self.turns == "angle":
            return self.turn_j_per_deg * angle_deg
        if self.turns == "braking":
            lost = 0.5 * (1.0 - np.cos(np.radians(angle_deg)))
            return self.mass_kg * speed_m_s**2 * lost / self.efficiency
        return np.zeros_like(angle_deg)

    def step_j(self, step_length_m: NDArray[np.float64]) -> NDArray[np.float64]:
        """Energy of each action (8) after each heading (8, the last row without one), (9, 8) [J].

        Parameters
        ----------
        step_length_m : (8,) float64
            Length of each action's step [m], flown in one second.
        """
        straight = self.power_w(step_length_m)
        heading, action = np.arange(8)[:, None], np.arange(8)[None]
        turns = self.turn_j(turn_deg(heading, action), float(step_length_m.min()))
        return np.vstack((straight + turns, straight))
