"""What a file shows, in the draft's coordinates, to compare with the plan made from it."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

Affine = tuple[tuple[float, float, float], tuple[float, float, float]]
"""Rows (a, b, c) and (d, e, f) of x' = a x + b y + c, y' = d x + e y + f."""


@dataclass(frozen=True)
class DrawnLayer:
    """Lines of one layer, class or type of the file.

    Attributes
    ----------
    name : str
    became : str
        As in `floorplans.importers.draft.LayerUse`.
    is_used : bool
        False for what was left out.
    geometry : shapely geometry
        [m].
    """

    name: str
    became: str
    is_used: bool
    geometry: BaseGeometry


@dataclass(frozen=True)
class DrawnPicture:
    """A picture, and where its pixels are.

    Attributes
    ----------
    png : bytes
        The picture as a PNG file.
    size : (int, int)
        Columns and rows.
    to_m : Affine
        From (columns from the left, rows from the top) to (x, y) [m].
    """

    png: bytes
    size: tuple[int, int]
    to_m: Affine


@dataclass(frozen=True)
class Original:
    """Everything that is drawn in a file."""

    layers: tuple[DrawnLayer, ...] = ()
    picture: DrawnPicture | None = None

    def transformed(self, by: Affine) -> Original:
        """Apply an affine transformation of the draft's coordinates [m]."""
        matrix = np.array(by)

        def moved(points: np.ndarray) -> np.ndarray:
            return points @ matrix[:, :2].T + matrix[:, 2]

        layers = tuple(
            replace(layer, geometry=shapely.transform(layer.geometry, moved))
            for layer in self.layers
        )
        picture = self.picture
        if picture is not None:
            a, b = (matrix @ np.vstack([picture.to_m, (0.0, 0.0, 1.0)])).tolist()
            picture = replace(picture, to_m=((a[0], a[1], a[2]), (b[0], b[1], b[2])))
        return Original(layers, picture)

    def moved(self, d_x: float, d_y: float) -> Original:
        """Translate by (d_x, d_y) [m]."""
        return self.transformed(((1.0, 0.0, d_x), (0.0, 1.0, d_y)))
