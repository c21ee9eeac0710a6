"""Where a plan lies in the drawing that it was imported from."""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, hypot, radians, sin

import numpy as np
from numpy.typing import NDArray

from floorplans.values import Range, check_number

OFFSET = Range(-1e8, 1e8, "m")
ANGLE = Range(-360.0, 360.0, "degrees")

FAR_M = 10_000.0
"""Beyond this, single precision is coarser than a millimetre [m]."""


@dataclass(frozen=True)
class PlanFrame:
    """Position and rotation of a plan's axes in the coordinates of a drawing.

    Attributes
    ----------
    x_m, y_m : float
        Of the plan's point (0, 0) in the drawing [m].
    rotation_deg : float
        From the drawing's x axis to the plan's, counter-clockwise.
    """

    x_m: float = 0.0
    y_m: float = 0.0
    rotation_deg: float = 0.0

    def to_drawing(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Convert (x, y) of the plan to those of the drawing, both (n, 2) [m]."""
        return points @ rotation(self.rotation_deg).T + (self.x_m, self.y_m)

    def to_plan(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Convert (x, y) of the drawing to those of the plan, both (n, 2) [m]."""
        return (points - (self.x_m, self.y_m)) @ rotation(self.rotation_deg)

    def matrix(self, *, single_precision: bool = False) -> NDArray[np.float64]:
        """Homogeneous matrix (4, 4) from the plan, z up, to the drawing.

        Parameters
        ----------
        single_precision : bool
            Leave the position out where it is farther away than `FAR_M`.
        """
        matrix = np.eye(4)
        matrix[:2, :2] = rotation(self.rotation_deg)
        if not (single_precision and hypot(self.x_m, self.y_m) > FAR_M):
            matrix[:2, 3] = self.x_m, self.y_m
        return matrix


def rotation(angle_deg: float) -> NDArray[np.float64]:
    """Matrix (2, 2) that turns columns (x, y) by an angle, counter-clockwise."""
    c, s = cos(radians(angle_deg)), sin(radians(angle_deg))
    return np.array([[c, -s], [s, c]])


def check_frame(frame: PlanFrame) -> None:
    """Raise `PlanError` for a number out of range."""
    check_number(frame.x_m, OFFSET, ("frame", "x_m"))
    check_number(frame.y_m, OFFSET, ("frame", "y_m"))
    check_number(frame.rotation_deg, ANGLE, ("frame", "rotation_deg"))
