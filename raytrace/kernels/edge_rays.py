"""Rays that leave a horizontal edge, in the plan view.

In the frame of the edge (x along it, h away from it into the cell) a ray is a point (u, m): it
leaves at x = u with x = u + m h. The rays that pass between two corners form a convex polygon
there, which is clipped exactly (docs/theory.md, section 6).
"""

import math

import numpy as np

from raytrace.arrays import Floats
from raytrace.kernels.beams import Window
from raytrace.kernels.compiling import jit
from raytrace.kernels.lanes import Number
from raytrace.kernels.plan_view import PlanView

STEEPEST = 1e5
"""Largest |m| of a ray that leaves a horizontal edge."""

SLIVER_M = 1e-10
"""Narrowest interval of an edge that is traced [m]."""


@jit(inline=True)
def nearest_zero(interval: tuple[float, float]) -> float:
    """Least magnitude within an interval."""
    low, high = interval
    return 0.0 if low * high <= 0.0 else min(abs(low), abs(high))


@jit()
def edge_frame(view: PlanView, e: int) -> Floats:
    """Frame (8,) of an edge of the plan view, h into its cell."""
    x1, y1, x2, y2 = view.ends[e, 0], view.ends[e, 1], view.ends[e, 2], view.ends[e, 3]
    length = math.hypot(x2 - x1, y2 - y1)
    tx, ty = (x2 - x1) / length, (y2 - y1) / length
    frame = np.empty(8)
    frame[0], frame[1], frame[2] = tx, ty, -(tx * x1 + ty * y1)
    frame[3], frame[4], frame[5] = -ty, tx, ty * x1 - tx * y1
    frame[6] = frame[7] = 1.0
    return frame


@jit(inline=True)
def in_frame(frame: Floats, x: Number, y: Number) -> tuple[Number, Number]:
    """(x, h) of a point."""
    return (
        frame[0] * x + frame[1] * y + frame[2],
        frame[3] * x + frame[4] * y + frame[5],
    )


@jit(inline=True)
def from_frame(frame: Floats, u: Number) -> tuple[Number, Number]:
    """Point (x, y) of the plan view that is u along the edge; the frame is orthonormal."""
    return (
        frame[0] * (u - frame[2]) - frame[3] * frame[5],
        frame[1] * (u - frame[2]) - frame[4] * frame[5],
    )


@jit(inner=True)
def copy_rays(rays: Floats, start: int, n: int, out: Floats, to: int) -> None:
    """out[to:to + n] = rays[start:start + n], much faster to compile."""
    for k in range(n):
        out[to + k, 0], out[to + k, 1] = rays[start + k, 0], rays[start + k, 1]


@jit(inner=True)
def clipped(rays: Floats, n: int, x: float, h: float, sign: float, out: Floats) -> int:
    """Keep the rays with sign (x - u - m h) >= 0; write them to `out`, return how many corners."""
    kept = 0
    for i in range(n):
        j = i + 1 if i + 1 < n else 0
        here = sign * (x - rays[i, 0] - rays[i, 1] * h)
        there = sign * (x - rays[j, 0] - rays[j, 1] * h)
        if here >= 0.0:
            out[kept, 0], out[kept, 1] = rays[i, 0], rays[i, 1]
            kept += 1
        if (here > 0.0 and there < 0.0) or (here < 0.0 and there > 0.0):
            t = here / (here - there)
            out[kept, 0] = rays[i, 0] + t * (rays[j, 0] - rays[i, 0])
            out[kept, 1] = rays[i, 1] + t * (rays[j, 1] - rays[i, 1])
            kept += 1
    return kept


@jit(inline=True)
def is_sliver(rays: Floats, n: int) -> bool:
    """Whether a polygon of rays is too thin to be traced."""
    if n < 3:
        return True
    low = high = rays[0, 0]
    area = 0.0
    for i in range(n):
        j = i + 1 if i + 1 < n else 0
        area += rays[i, 0] * rays[j, 1] - rays[j, 0] * rays[i, 1]
        low, high = min(low, rays[i, 0]), max(high, rays[i, 0])
    return abs(area) < 1e-13 or high - low < SLIVER_M


@jit(inner=True)
def between(frame: Floats, ends: Window, n: int, work: Floats, out: Floats) -> int:
    """Clip the n rays in `out` to those between two corners; return how many are left.

    By rounding, a polygon of almost no width could meet an edge from behind: its mean ray must not.
    """
    x1, h1 = in_frame(frame, ends[0], ends[1])
    x2, h2 = in_frame(frame, ends[2], ends[3])
    if h1 <= 1e-9 and h2 <= 1e-9:
        return 0
    if h1 > 1e-9:
        copy_rays(out, 0, n, work, 0)
        n = clipped(work, n, x1, h1, frame[6], out)
    if h2 > 1e-9 and n >= 3:
        copy_rays(out, 0, n, work, 0)
        n = clipped(work, n, x2, h2, -frame[6], out)
    if is_sliver(out, n):
        return 0
    slope = 0.0
    for k in range(n):
        slope += out[k, 1] / n
    faces = frame[6] * (slope * (h2 - h1) - (x2 - x1)) > 0.0
    return n if faces else 0


@jit(inner=True)
def mirror_frame(frame: Floats, line: Floats) -> None:
    """Change a frame to that of the beam mirrored at a line."""
    nx, ny, d = line[0], line[1], line[2]
    for k in (0, 3):
        along = 2.0 * (frame[k] * nx + frame[k + 1] * ny)
        frame[k] -= along * nx
        frame[k + 1] -= along * ny
        frame[k + 2] += along * d
    frame[6] = -frame[6]


@jit(inner=True)
def write_box(rays: Floats, length: float) -> None:
    """All rays that leave an edge of that length."""
    rays[0, 0], rays[1, 0], rays[2, 0], rays[3, 0] = 0.0, length, length, 0.0
    rays[0, 1] = rays[1, 1] = -STEEPEST
    rays[2, 1] = rays[3, 1] = STEEPEST
