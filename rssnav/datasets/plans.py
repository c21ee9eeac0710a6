"""The plans of a data set: generated from seeds, or read from files."""

from __future__ import annotations

import hashlib
from abc import ABC, abstractmethod
from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np

import floorplans
from floorplans import FloorPlan
from floorplans.generators import GENERATOR_VERSION
from rssnav.datasets.configuration import hash_of
from rssnav.datasets.errors import DatasetError

PLANS_A_FOLDER = 1000
"""Plans whose files share a folder."""


@dataclass(frozen=True)
class PlanSource(ABC):
    """Where a plan comes from; small enough to be sent to any worker.

    Attributes
    ----------
    name
        Of its files; no other plan of the data set has it.
    building
        Plans with the same one are the same building, which belongs to a single split.
    split
        Its split; empty where it is to be chosen.
    number
        Its place in the data set.
    """

    name: str
    building: str
    split: str = ""
    number: int = 0

    @property
    def file(self) -> str:
        """Its maps, relative to the data set's folder, with the separator /."""
        return f"{self.split}/{self.number // PLANS_A_FOLDER:03d}/{self.name}.h5"

    @property
    @abstractmethod
    def described(self) -> dict[str, object]:
        """What the plan depends on."""

    @abstractmethod
    def plan(self) -> FloorPlan:
        """Return the plan."""

    def key(self, configuration_key: str) -> str:
        """Hash of all that its maps depend on."""
        return hash_of({"plan": self.described, "configuration": configuration_key})


@dataclass(frozen=True)
class GeneratedPlan(PlanSource):
    """A plan that a kind and a seed determine.

    Attributes
    ----------
    kind, seed, area_m2, furniture, shape, n_transmitters
        As for `floorplans.generate`.
    """

    kind: str = "office"
    seed: int = 0
    area_m2: float | None = None
    furniture: bool = True
    shape: str = "rectangle"
    n_transmitters: int = 3

    @property
    def described(self) -> dict[str, object]:
        """Arguments of the generator, and its version."""
        return {
            "kind": self.kind, "seed": self.seed, "area_m2": self.area_m2,
            "furniture": self.furniture, "shape": self.shape,
            "n_transmitters": self.n_transmitters, "generator": GENERATOR_VERSION,
        }  # fmt: skip

    def plan(self) -> FloorPlan:
        """Generate the plan."""
        return floorplans.generate(
            self.kind,
            self.seed,
            area_m2=self.area_m2,
            furniture=self.furniture,
            shape=self.shape,
            n_transmitters=self.n_transmitters,
        )


@dataclass(frozen=True)
class FilePlan(PlanSource):
    """A plan in a TOML file.

    Attributes
    ----------
    path
        The file.
    sha256
        Hash of its content when the data set began.
    """

    path: Path = Path()
    sha256: str = ""

    @property
    def described(self) -> dict[str, object]:
        """The hash of its content."""
        return {"sha256": self.sha256}

    def plan(self) -> FloorPlan:
        """Read the plan; refuse a file that has changed."""
        content = self.path.read_bytes()
        if hashlib.sha256(content).hexdigest() != self.sha256:
            raise DatasetError("the plan has changed since the data set was begun", self.path)
        return floorplans.load(self.path)


def building_of(plan: FloorPlan) -> str:
    """Return a hash of a plan's building: all but its name and what is placed in it."""
    bare = replace(
        plan, name="building", source=None, start=None, transmitters=(), origin=None, frame=None
    )
    return bare.sha256


@dataclass(frozen=True)
class GeneratedPlans:
    """Plans of a kind with consecutive or listed seeds.

    Attributes
    ----------
    kind, furniture, shape, n_transmitters, split
        Of each plan.
    seeds
        Their seeds.
    area_m2
        A floor area, or the range from which each is drawn; by default what is usual.
    """

    kind: str
    seeds: range | tuple[int, ...]
    area_m2: float | tuple[float, float] | None
    furniture: bool
    shape: str
    n_transmitters: int
    split: str = ""

    def sources(self) -> Iterable[PlanSource]:
        """Yield each plan."""
        for seed in self.seeds:
            yield GeneratedPlan(
                f"{self.kind}-{seed:06d}",
                f"{self.kind} {seed}",
                self.split,
                kind=self.kind,
                seed=seed,
                area_m2=self._area_m2(seed),
                furniture=self.furniture,
                shape=self.shape,
                n_transmitters=self.n_transmitters,
            )

    def _area_m2(self, seed: int) -> float | None:
        """Draw whole square metres, the same for the same seed in any list."""
        if not isinstance(self.area_m2, tuple):
            return self.area_m2
        low, high = self.area_m2
        rng = np.random.Generator(np.random.PCG64([seed, 1]))
        return float(rng.integers(round(low), round(high) + 1))


@dataclass(frozen=True)
class FilePlans:
    """The plans of a folder.

    Attributes
    ----------
    folder
        Its TOML files are read, sorted by name.
    split
        Of each plan.
    """

    folder: Path
    split: str = ""

    @cached_property
    def files(self) -> list[Path]:
        """The files; at least one."""
        found = sorted(self.folder.glob("*.toml")) if self.folder.is_dir() else []
        if not found:
            raise DatasetError("no plans: expected a folder with .toml files", self.folder)
        return found

    def sources(self) -> Iterable[PlanSource]:
        """Yield each plan; all are read once."""
        for path in self.files:
            content = path.read_bytes()
            yield FilePlan(
                path.stem,
                building_of(floorplans.load(path)),
                self.split,
                path=path.resolve(),
                sha256=hashlib.sha256(content).hexdigest(),
            )
