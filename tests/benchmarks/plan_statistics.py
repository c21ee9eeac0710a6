"""Statistics of generated plans: ``python tests/benchmarks/plan_statistics.py`` prints a table.

A hundred plans of each kind; the rectangles of a room, and all corridors, count as one room.
"""

from __future__ import annotations

from collections import Counter

import numpy as np

import floorplans
from floorplans.generators import KINDS, Kind
from floorplans.generators.building import _merged
from floorplans.generators.generate import AREA_M2, LAYOUTS

PLANS = 100


def room_areas(kind: Kind, seed: int) -> list[float]:
    """Areas of the rooms of a plan [m^2]."""
    rng = np.random.Generator(np.random.PCG64([KINDS.index(kind), seed]))
    low, high = AREA_M2[kind]
    rooms = LAYOUTS[kind](rng, float(rng.integers(low, high + 1)), "rectangle")
    left, found = set(range(len(rooms))), list[float]()
    while left:
        together = _merged(rooms, min(left))
        left -= set(together)
        found.append(sum(rooms[k].area_m2 for k in together))
    return found


def row(kind: Kind) -> str:
    """Return the row of a kind."""
    areas, doors, lengths = list[float](), list[float](), list[float]()
    materials = Counter[str]()
    for seed in range(PLANS):
        plan, of_plan = floorplans.generate(kind, seed), room_areas(kind, seed)
        areas += of_plan
        openings = [o for wall in plan.walls for o in wall.openings]
        doors.append(sum(o.kind == "door" for o in openings) / len(of_plan))
        for wall in plan.walls:
            if wall.kind == "wall":
                lengths.append(wall.length_m)
                materials[wall.material] += wall.length_m
    quartiles = ", ".join(f"{q:.1f}" for q in np.percentile(areas, [25, 50, 75]))
    shares = [
        f"{name} {length / materials.total():.0%}" for name, length in materials.most_common()
    ]
    return (
        f"| `{kind}` | {len(areas) / PLANS:.1f} | {quartiles} | {np.mean(doors):.2f} | "
        f"{np.median(lengths):.1f} | {', '.join(shares)} |"
    )


def main() -> None:
    """Print the table."""
    print("| kind | rooms | room area [m²], quartiles | doors per room | median wall [m] | walls |")
    print("|---|---|---|---|---|---|")
    for kind in KINDS:
        print(row(kind))


if __name__ == "__main__":
    main()
