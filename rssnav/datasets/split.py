"""Train, validation and test: whole buildings, so that no wall of a test was seen in training."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from rssnav.datasets.errors import DatasetError
from rssnav.datasets.plans import PlanSource

SPLITS: tuple[str, ...] = ("train", "validation", "test")


@dataclass(frozen=True)
class Fractions:
    """How many of the buildings belong to each split.

    Attributes
    ----------
    weights
        Of each of `SPLITS`; at least one is positive.
    seed
        Chooses the buildings.
    """

    weights: Mapping[str, float]
    seed: int = 0

    def of(self, buildings: Sequence[str]) -> dict[str, str]:
        """Return the split of each building; it does not depend on their order.

        Buildings are sorted by a hash of their name and the seed, and cut at the fractions, so that
        each split has its number of buildings to within one.
        """
        ranked = sorted(set(buildings), key=self._rank)
        total = sum(self.weights.values())
        found: dict[str, str] = {}
        begin, reached = 0, 0.0
        for split in SPLITS:
            reached += self.weights.get(split, 0.0) / total
            end = round(reached * len(ranked))
            found |= dict.fromkeys(ranked[begin:end], split)
            begin = end
        return found

    def _rank(self, building: str) -> bytes:
        return hashlib.sha256(f"{self.seed}/{building}".encode()).digest()


def divided(
    sources: Sequence[PlanSource], fractions: Fractions | None, path: Path
) -> list[PlanSource]:
    """Give each plan its split and its number.

    Parameters
    ----------
    sources
        All plans, with their splits if `fractions` is None.
    fractions
        How they are divided otherwise.
    path
        The spec, for messages.

    Raises
    ------
    DatasetError
        Where two plans have the same name, or a building is listed twice or in two splits.
    """
    of_building = {} if fractions is None else fractions.of([s.building for s in sources])
    found: list[PlanSource] = []
    names, buildings = dict[str, PlanSource](), dict[str, PlanSource]()
    for number, source in enumerate(sources):
        split = of_building.get(source.building, source.split)
        source = replace(source, split=split, number=number)
        other = buildings.setdefault(source.building, source)
        if other is not source:
            where = f"in {split}" if other.split == split else f"in {other.split} and in {split}"
            raise DatasetError(
                f"plans {other.name!r} and {source.name!r} are the same building, listed {where}: "
                "expected each building once, in one split",
                path,
            )
        if names.setdefault(source.name, source) is not source:
            raise DatasetError(
                f"two plans have the name {source.name!r}: expected different names", path
            )
        found.append(source)
    return found
