"""The material tables of Recommendation ITU-R P.2040, edition by edition, as data.

Table 3 of the Recommendation: ``eps_r = a f^b`` and ``sigma = c f^d`` [S/m], f in GHz, each row
within its range of frequencies. docs/materials.md says against what the numbers were checked.
"""

from collections.abc import Mapping
from typing import NamedTuple


class Row(NamedTuple):
    """One row of the table: a range of frequencies [GHz] and the four constants of the law."""

    low_ghz: float
    high_ghz: float
    a: float
    b: float
    c: float
    d: float


Table = Mapping[str, tuple[Row, ...]]
"""Rows of each material, in the Recommendation's order; where ranges overlap the first counts."""

_GROUND: Table = {
    "very_dry_ground": (Row(1, 10, 3.0, 0.0, 0.00015, 2.52),),
    "medium_dry_ground": (Row(1, 10, 15.0, -0.1, 0.035, 1.63),),
    "wet_ground": (Row(1, 10, 30.0, -0.4, 0.15, 1.30),),
}
_VACUUM = Row(0.001, 100, 1.0, 0.0, 0.0, 0.0)
_WOOD = Row(0.001, 100, 1.99, 0.0, 0.0047, 1.0718)
_CHIPBOARD = Row(1, 100, 2.58, 0.0, 0.0217, 0.78)
_FLOORBOARD = Row(50, 100, 3.66, 0.0, 0.0044, 1.3515)
_METAL = Row(1, 100, 1.0, 0.0, 1e7, 0.0)

_P2040_1: Table = {
    "vacuum": (_VACUUM,),
    "concrete": (Row(1, 100, 5.31, 0.0, 0.0326, 0.8095),),
    "brick": (Row(1, 10, 3.75, 0.0, 0.038, 0.0),),
    "plasterboard": (Row(1, 100, 2.94, 0.0, 0.0116, 0.7076),),
    "wood": (_WOOD,),
    "glass": (Row(0.1, 100, 6.27, 0.0, 0.0043, 1.1925),),
    "ceiling_board": (Row(1, 100, 1.50, 0.0, 0.0005, 1.1634),),
    "chipboard": (_CHIPBOARD,),
    "floorboard": (_FLOORBOARD,),
    "metal": (_METAL,),
    **_GROUND,
}

_P2040_3: Table = {
    "vacuum": (_VACUUM,),
    "concrete": (Row(1, 100, 5.24, 0.0, 0.0462, 0.7822),),
    "brick": (Row(1, 40, 3.91, 0.0, 0.0238, 0.16),),
    "plasterboard": (Row(1, 100, 2.73, 0.0, 0.0085, 0.9395),),
    "wood": (_WOOD,),
    "glass": (
        Row(0.1, 100, 6.31, 0.0, 0.0036, 1.3394),
        Row(220, 450, 5.79, 0.0, 0.0004, 1.658),
    ),
    "ceiling_board": (
        Row(1, 100, 1.48, 0.0, 0.0011, 1.0750),
        Row(220, 450, 1.52, 0.0, 0.0029, 1.029),
    ),
    "chipboard": (_CHIPBOARD,),
    "plywood": (Row(1, 40, 2.71, 0.0, 0.33, 0.0),),
    "marble": (Row(1, 60, 7.074, 0.0, 0.0055, 0.9262),),
    "floorboard": (_FLOORBOARD,),
    "metal": (_METAL,),
    **_GROUND,
}

_ADDED_IN_4: Table = {
    "concrete": (Row(110, 330, 5.17, 0.0, 0.0145, 1.09),),
    "brick": (Row(110, 330, 4.15, 0.0, 0.0006, 1.5712),),
    "plasterboard": (
        Row(110, 330, 2.56, 0.0, 0.0001, 1.7799),
        Row(100, 400, 2.65, 0.0, 0.0002, 1.598),
    ),
    "wood": (
        Row(110, 330, 1.82, 0.0, 0.0040, 1.0761),
        Row(100, 400, 2.1183, 0.0, 0.0055, 1.1113),
    ),
    "glass": (Row(100, 400, 6.5767, 0.0, 0.0012, 1.4697),),
    "clear_acrylic": (Row(110, 330, 2.58, 0.0, 0.0001, 1.6524),),
    "ceiling_board": (Row(100, 400, 1.2567, 0.0, 0.00013, 1.454),),
    "chipboard": (Row(100, 200, 2.16, 0.0, 0.0023, 1.359),),
    "plywood": (
        Row(110, 330, 1.94, 0.0, 0.0067, 0.9982),
        Row(100, 400, 2.17, 0.0, 0.0063, 1.045),
    ),
    "marble": (
        Row(110, 330, 7.94, 0.0, 0.0001, 1.7330),
        Row(100, 400, 8.62, 0.0, 0.0027, 1.15),
    ),
    "floorboard": (
        Row(220, 300, 5.27, 0.0, 2.22e-17, 7.3413),
        Row(300, 400, 5.27, 0.0, 0.0003, 2.0298),
        Row(400, 450, 5.27, 0.0, 49.8726, 0.0),
        Row(100, 400, 3.1575, 0.0, 0.001675, 1.32775),
    ),
    "vinyl_tile": (Row(1, 40, 3.62, 0.0, 0.0051, 0.8422),),
    "carpet_tile": (Row(1, 40, 2.08, 0.0, 0.0009, 0.8200),),
    "asphalt_concrete": (Row(1, 40, 4.83, 0.0, 0.0108, 1.3969),),
}

_P2040_4: Table = {
    name: _P2040_3.get(name, ()) + _ADDED_IN_4.get(name, ())
    for name in dict.fromkeys((*_P2040_3, *_ADDED_IN_4))
}

TABLES: Mapping[str, Table] = {
    "P.2040-1": _P2040_1,
    "P.2040-2": _P2040_3,
    "P.2040-3": _P2040_3,
    "P.2040-4": _P2040_4,
}
"""Table 3 of each edition: 07/2015, 09/2021, 08/2023 and 09/2025."""

DEFAULT_EDITION = "P.2040-4"
