"""Small plans and maps with the attributes that worlds are made from."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
import shapely

from rssnav import GridWorld


@dataclass(frozen=True)
class SmallPlan:
    """A rectangle from the origin, with free-standing walls solid at every height."""

    size: tuple[float, float]
    source: tuple[float, float, float]
    start: tuple[float, float]
    segments: tuple = ()
    name: str = "small"
    sha256: str = "5" * 64

    @property
    def outline(self):
        return shapely.box(0.0, 0.0, *self.size)

    def require_source(self):
        return self.source

    def require_start(self):
        return self.start

    def solid_segments(self, height_m):
        x, y = self.size
        shell = [((0, 0), (x, 0)), ((x, 0), (x, y)), ((x, y), (0, y)), ((0, y), (0, 0))]
        return np.array([*shell, *self.segments], dtype=float)


@dataclass(frozen=True)
class SmallGrid:
    x: np.ndarray
    y: np.ndarray
    height_m: float = 2.0
    cell_size_m: float = 1.0


@dataclass(frozen=True)
class SmallMap:
    rss_dbm: np.ndarray
    grid: SmallGrid
    plan_sha256: str = field(default="5" * 64)

    @property
    def rss_coherent_dbm(self):
        return self.rss_dbm - 0.25


def log_distance_map(plan):
    """RSS that falls with distance, unique in every cell, above -21 dBm within 2 m."""
    x, y = np.arange(int(plan.size[0])) + 0.5, np.arange(int(plan.size[1])) + 0.5
    distance = np.hypot(x[None, :] - plan.source[0], y[:, None] - plan.source[1])
    rss_dbm = -20.5 - 25.0 * np.log10(distance / 1.9)
    ripple = 1e-3 * np.arange(rss_dbm.size).reshape(rss_dbm.shape) / rss_dbm.size
    return SmallMap(rss_dbm + ripple, SmallGrid(x, y))


def world_of(plan, speed=1, **changes):
    return GridWorld.from_map(plan, replace(log_distance_map(plan), **changes), speed)


def room_plan():
    """8 m x 5 m with a half-wall between start and source."""
    wall = ((4.0, 0.0), (4.0, 3.0))
    return SmallPlan((8.0, 5.0), (1.0, 1.0, 1.5), (6.5, 1.5), (wall,))
