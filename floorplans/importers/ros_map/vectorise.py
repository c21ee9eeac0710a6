"""Solid pixels -> straight walls along the building's directions.

    lines: the skeleton of the solid, split where a straight line no longer follows it
    directions: those of most lines; a line takes the nearest one if that moves it by less than
        the tolerance
    corners: the least-squares fit to all lines

The position and thickness of a wall are those of all pixels nearest to its line.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt
from scipy.sparse import coo_array
from scipy.sparse.linalg import lsqr
from scipy.spatial import KDTree
from shapely.geometry import LineString

from floorplans.importers.draft import RawWall
from floorplans.importers.ros_map.thinning import polylines, pruned, thinned

Floats = NDArray[np.float64]
Mask = NDArray[np.bool_]

_CORNERS = ((0.0, 2.0), (1.0, 2.0), (0.0, 2.0))
"""Passes that merge corners no farther apart than these multiples of the wall's width, joined by a
line along a direction of the building, and by an oblique line."""
_OBLIQUE_DEG = 15.0
_FEW_PIXELS = 12
_FITTED_DEG = 30.0  # largest angle between a line's ends and its pixels
_WINDOW_DEG = 6.0  # half the width of a direction's peak
_LEAST_FRACTION = 0.1  # of the length of all lines: the least of a direction of the building
_SIDE_DEG = 1.0  # directions this near to a side of the picture are parallel to it
_RIGHT_DEG = 3.0  # directions this near to a right angle are perpendicular
_ALONG, _STAY = 30.0, 0.02  # weights of the direction of a line, and of the place of a corner


@dataclass(frozen=True)
class _Net:
    """Straight lines between corners.

    Attributes
    ----------
    corners : (n, 2) float64
        (x, y) [pixels].
    lines : (m, 2) int64
        Corners each line runs between.
    pixels : tuple of (k, 2) float64, m of them
        Centres (x, y) of the solid pixels nearest to each line [pixels].
    width : (m,) float64
        Of the solid at each line [pixels].
    """

    corners: Floats
    lines: NDArray[np.int64]
    pixels: tuple[Floats, ...]
    width: Floats

    @property
    def steps(self) -> Floats:
        """From the first to the second corner of each line, (m, 2) [pixels]."""
        return self.corners[self.lines[:, 1]] - self.corners[self.lines[:, 0]]


def walls_of_picture(solid: Mask, tolerance_px: float) -> list[RawWall]:
    """Return the walls of a picture.

    Parameters
    ----------
    solid : (n_y, n_x) bool
        The first row is the bottom one.
    tolerance_px : float
        Largest distance of a wall from the middle of its pixels [pixels].

    Returns
    -------
    list of RawWall
        In pixels, the lower left corner of the picture at (0, 0).
    """
    net = _net(solid, tolerance_px)
    if not len(net.lines):
        return []
    corners = _extended_to_pixel_ends(net, _fitted(net, _snapped(net, tolerance_px)))
    return [
        RawWall((a[0], a[1]), (b[0], b[1]), _thickness(corners[line], pixels, width))
        for line, (a, b), pixels, width in zip(
            net.lines, (corners[net.lines] + 0.5).tolist(), net.pixels, net.width, strict=True
        )
    ]


def _thickness(ends: Floats, pixels: Floats, width: float) -> float:
    """Mean number of pixels across a line, over its middle half if it is long enough."""
    step = ends[1] - ends[0]
    length = float(np.hypot(*step))
    if length < 3 * width:
        return max(width, 1.0)
    s = (pixels - ends[0]) @ step / length**2
    return max(float(np.sum((s > 0.25) & (s < 0.75))) / (0.5 * length), 1.0)


def _net(solid: Mask, tolerance_px: float) -> _Net:
    """Lines in the middle of the solid, straight to within the tolerance."""
    thickness = 2.0 * np.asarray(distance_transform_edt(np.pad(solid, 1)))[1:-1, 1:-1] - 1.0
    lines = polylines(thinned(solid))
    for _ in range(2):
        lines = pruned(lines, thickness)
    pieces = [piece for line in lines for piece in _pieces(line, tolerance_px)]
    pieces = [piece for piece in pieces if len(piece) > 1]
    ends = np.array([point for piece in pieces for point in (piece[0], piece[-1])]).reshape(-1, 2)
    corners, number = np.unique(ends, axis=0, return_inverse=True)
    pixels = tuple(_nearest_pixels(solid, pieces))
    wide = [float(thickness[tuple(piece.astype(int).T[::-1])].max()) for piece in pieces]
    net = _Net(corners, number.reshape(-1, 2), pixels, np.array(wide))
    for fraction, oblique_fraction in _CORNERS:
        net = _contracted(net, fraction, oblique_fraction)
    return net


def _contracted(net: _Net, fraction: float, oblique_fraction: float) -> _Net:
    """Merge corners joined by lines shorter than a fraction of their width.

    Thinning cuts corners, and bends the line of a thick wall towards a wall that ends on it: the
    result is oblique lines little longer than the wall is thick.
    """
    if not len(net.lines):
        return net
    spread = np.where(_is_oblique(net), oblique_fraction, fraction) * net.width
    place = {i: [i] for i in range(len(net.corners))}
    lengths = np.hypot(*net.steps.T)
    for k in np.argsort(lengths, kind="stable").tolist():
        first, second = (place[i] for i in net.lines[k].tolist())
        together = net.corners[first + second]
        if first is not second and np.ptp(together, axis=0).max() <= spread[k]:
            first += second
            place |= dict.fromkeys(second, first)
    groups = list({id(group): group for group in place.values()}.values())
    number = np.empty(len(net.corners), dtype=np.int64)
    for k, group in enumerate(groups):
        number[group] = k
    lines = number[net.lines]
    kept = np.flatnonzero(lines[:, 0] != lines[:, 1])
    corners = np.array([net.corners[group].mean(axis=0) for group in groups]).reshape(-1, 2)
    pixels = tuple(net.pixels[k] for k in kept.tolist())
    return _Net(corners, lines[kept], pixels, net.width[kept])


def _is_oblique(net: _Net) -> Mask:
    """Which lines have none of the building's directions."""
    lengths = np.hypot(*net.steps.T)
    angles = np.arctan2(net.steps[:, 1], net.steps[:, 0])
    off = np.abs(_turn(_main_directions(angles, lengths)[None, :] - angles[:, None]))
    return np.array(off.min(axis=1, initial=np.pi) > np.radians(_OBLIQUE_DEG))


def _pieces(line: LineString, tolerance_px: float) -> list[Floats]:
    """Split a chain of pixels where it leaves the straight line between the splits."""
    points = shapely.get_coordinates(line)
    kept = shapely.get_coordinates(line.simplify(tolerance_px))
    cuts = [0]
    for point in kept[1:]:
        after = cuts[-1] + 1
        cuts.append(after + int(np.argmax((points[after:] == point).all(axis=1))))
    return [points[low : high + 1] for low, high in pairwise(cuts)]


def _nearest_pixels(solid: Mask, pieces: list[Floats]) -> list[Floats]:
    """Assign the solid pixels to the nearest pieces."""
    if not pieces:
        return []
    owner = np.repeat(np.arange(len(pieces)), [len(piece) for piece in pieces])
    pixels = np.argwhere(solid)[:, ::-1].astype(np.float64)
    nearest = owner[KDTree(np.concatenate(pieces)).query(pixels)[1]]
    order = np.argsort(nearest, kind="stable")
    bounds = np.searchsorted(nearest[order], np.arange(len(pieces) + 1))
    return [pixels[order[low:high]] for low, high in pairwise(bounds.tolist())]


def _snapped(net: _Net, tolerance_px: float) -> Floats:
    """Direction of each line [rad]: one of the building's, if within the tolerance at its ends."""
    lengths = np.hypot(*net.steps.T)
    angles = np.array(
        [_direction(step, pixels) for step, pixels in zip(net.steps, net.pixels, strict=True)]
    )
    off = _turn(_main_directions(angles, lengths)[None, :] - angles[:, None])
    least = off[np.arange(len(angles)), np.abs(off).argmin(axis=1)]
    moves = np.abs(np.sin(least)) * lengths / 2
    return np.where(moves <= tolerance_px, angles + least, angles)


def _direction(step: Floats, pixels: Floats) -> float:
    """Direction of a line [rad]: that of its pixels, if there are enough."""
    chord = float(np.arctan2(step[1], step[0]))
    if len(pixels) < _FEW_PIXELS:
        return chord
    off = pixels - pixels.mean(axis=0)
    (x_x, x_y), (_, y_y) = off.T @ off
    longest = 0.5 * float(np.arctan2(2 * x_y, x_x - y_y))
    turn = float(_turn(np.array(longest - chord)))
    return chord + turn if abs(turn) < np.radians(_FITTED_DEG) else chord


def _main_directions(angles: Floats, lengths: Floats) -> Floats:
    """Directions [rad] with much of the length of all lines, in descending order."""
    main: list[float] = []
    left = lengths.copy()
    window = np.radians(_WINDOW_DEG)
    while left.sum() > 0 and len(main) < 8:
        off = _turn(angles[None, :] - angles[:, None])
        lengths_near = (np.abs(off) <= window) @ left
        best = int(lengths_near.argmax())
        if main and lengths_near[best] < _LEAST_FRACTION * lengths.sum():
            break
        inside = np.abs(off[best]) <= window
        angle = angles[best] + float(np.average(off[best][inside], weights=left[inside] + 1e-12))
        main.append(_at_right_angle(angle, main))
        left[inside] = 0.0
    return np.array(main)


def _at_right_angle(angle: float, main: list[float]) -> float:
    """Align a direction with a side of the picture, or at right angles to the main direction."""
    nearly = [(0.0, _SIDE_DEG), (np.pi / 2, _SIDE_DEG)]
    nearly += [(main[0] + np.pi / 2, _RIGHT_DEG)] if main else []
    for wanted, within_deg in nearly:
        off = float(_turn(np.array(wanted - angle)))
        if abs(off) <= np.radians(within_deg):
            return angle + off
    return angle


def _turn(angle: Floats) -> Floats:
    """Reduce an angle between lines to [-pi / 2, pi / 2) [rad]."""
    return (angle + np.pi / 2) % np.pi - np.pi / 2


def _fitted(net: _Net, directions: Floats) -> Floats:
    """Corners (n, 2) for which the lines have their directions and run through their pixels.

    The unknowns are the coordinates of all corners. Each line gives two equations, weighted by the
    root of its length: its ends have the same coordinate across it, and their midpoint has that of
    the mean of its pixels.
    """
    n, m = len(net.corners), len(net.lines)
    first, second = net.lines.T
    across = np.column_stack([-np.sin(directions), np.cos(directions)])
    weight = np.sqrt(np.maximum(np.hypot(*net.steps.T), 1.0))[:, None]
    middle = np.array(
        [
            _middle(net.corners[line], pixels, width)
            for pixels, line, width in zip(net.pixels, net.lines, net.width, strict=True)
        ]
    )
    rows = np.arange(m)[:, None]
    x_y = np.arange(2)[None, :]
    blocks = [
        (rows, 2 * first[:, None] + x_y, _ALONG * weight * across),
        (rows, 2 * second[:, None] + x_y, -_ALONG * weight * across),
        (rows + m, 2 * first[:, None] + x_y, 0.5 * weight * across),
        (rows + m, 2 * second[:, None] + x_y, 0.5 * weight * across),
        (2 * m + np.arange(2 * n), np.arange(2 * n), np.full(2 * n, _STAY)),
    ]
    row, column, value = (
        np.concatenate([np.broadcast_to(block[k], block[2].shape).ravel() for block in blocks])
        for k in range(3)
    )
    wanted = np.sum(across * middle, axis=1) * weight[:, 0]
    right = np.concatenate([np.zeros(m), wanted, _STAY * net.corners.ravel()])
    matrix = coo_array((value, (row, column)), shape=(2 * m + 2 * n, 2 * n)).tocsr()
    return lsqr(matrix, right, atol=1e-12, btol=1e-12, x0=net.corners.ravel())[0].reshape(-1, 2)


def _middle(ends: Floats, pixels: Floats, width: float) -> Floats:
    """Mean of a line's pixels, without those in its corners, which are also other walls'."""
    if not len(pixels):
        return ends.mean(axis=0)
    step = ends[1] - ends[0]
    length = float(np.hypot(*step))
    s = (pixels - ends[0]) @ step / max(length, 1.0)
    inner = pixels[(s > width) & (s < length - width)]
    return inner.mean(axis=0) if len(inner) >= _FEW_PIXELS else pixels.mean(axis=0)


def _extended_to_pixel_ends(net: _Net, corners: Floats) -> Floats:
    """Move free ends of lines to the ends of their pixels, which thinning has cut off."""
    moved = corners.copy()
    degree = np.bincount(net.lines.ravel(), minlength=len(corners))
    for line, pixels in zip(net.lines.tolist(), net.pixels, strict=True):
        for end, other in (line, line[::-1]):
            step = corners[end] - corners[other]
            length = float(np.hypot(*step))
            if degree[end] == 1 and length > 0 and len(pixels):
                reach = float(((pixels - corners[other]) @ step).max()) / length + 0.5
                moved[end] = corners[other] + step / length * max(reach, length)
    return moved
