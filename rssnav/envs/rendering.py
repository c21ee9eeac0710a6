"""Pictures of a flight: radio map, walls, trail, UAV and source."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from atomicfiles import atomic_write
from rssnav.missions import Mission

Picture = NDArray[np.uint8]

_CELL_PX = 8
_WALL, _TRAIL, _UAV, _SOURCE = (25, 25, 30), (255, 255, 255), (60, 220, 90), (255, 60, 200)
_COLD, _HOT = np.array([30.0, 20.0, 90.0]), np.array([255.0, 225.0, 90.0])
_DIMMED = 0.45


def picture(mission: Mission, mode: int, trail: Sequence[int]) -> Picture:
    """Draw a flight, north up; cells that were not visited are dimmed, walls dark.

    Parameters
    ----------
    mission : Mission
        Gives map and steps.
    mode : int
        Mode that is drawn.
    trail : sequence of int
        Cells flown through, the latest last.

    Returns
    -------
    (8 n_y, 8 n_x, 3) uint8
    """
    layout, rss_dbm = mission.layout, mission.rss_dbm[mode]
    heard = rss_dbm[np.isfinite(rss_dbm)]
    low, high = float(heard.min(initial=0.0)), float(heard.max(initial=0.0))
    share = np.clip((rss_dbm - low) / max(high - low, 1e-9), 0.0, 1.0)
    colour = _COLD + share[:, None] * (_HOT - _COLD)
    visited = np.zeros(rss_dbm.size, dtype=np.bool_)
    visited[list(trail)] = True
    colour[~visited] *= _DIMMED
    grid = np.full((*layout.shape, 3), _WALL, dtype=np.uint8)
    grid[layout.cell[:, 0], layout.cell[:, 1]] = colour
    image = np.kron(grid, np.ones((_CELL_PX, _CELL_PX, 1), dtype=np.uint8))
    _draw_walls(image, mission, mode)
    middle = layout.cell * _CELL_PX + _CELL_PX // 2
    for cell in trail[:-1]:
        _dot(image, middle[cell], 1, _TRAIL)
    nearest = layout.nearest(*mission.source[mode])
    _dot(image, middle[nearest], 3, _SOURCE)
    _dot(image, middle[trail[-1]], 2, _UAV)
    return np.ascontiguousarray(image[::-1])


def _draw_walls(image: Picture, mission: Mission, mode: int) -> None:
    """Draw a line between neighbours that a straight step does not connect."""
    layout = mission.layouts[mission.layout_of_mode[mode]]
    if layout.speed != 1:
        return
    for action, rows, columns in ((0, slice(None), -1), (2, -1, slice(None))):
        for i_y, i_x in layout.cell[layout.next_state[:, action] < 0]:
            block = image[
                i_y * _CELL_PX : (i_y + 1) * _CELL_PX, i_x * _CELL_PX : (i_x + 1) * _CELL_PX
            ]
            block[rows, columns] = _WALL


def _dot(
    image: Picture, middle: NDArray[np.int64], radius: int, colour: tuple[int, int, int]
) -> None:
    y, x = middle
    image[max(y - radius, 0) : y + radius, max(x - radius, 0) : x + radius] = colour


def as_text(mission: Mission, mode: int, trail: Sequence[int]) -> str:
    """Draw a flight in characters, north up: ``#`` wall, ``.`` cell, ``o`` trail, ``@`` UAV."""
    layout = mission.layout
    grid = np.full(layout.shape, "#")
    grid[layout.cell[:, 0], layout.cell[:, 1]] = "."
    for cell in trail:
        grid[tuple(layout.cell[cell])] = "o"
    grid[tuple(layout.cell[layout.nearest(*mission.source[mode])])] = "X"
    grid[tuple(layout.cell[trail[-1]])] = "@"
    reading = mission.rss_dbm[mode, trail[-1]]
    lines = "\n".join("".join(row) for row in grid[::-1])
    return f"{lines}\nstep {len(trail) - 1}, {reading:.1f} dBm\n"


def save_gif(frames: Sequence[Picture], path: str | Path, frames_per_s: int = 8) -> None:
    """Write pictures of `NavigationEnv.render` as a GIF, whole or not at all.

    Parameters
    ----------
    frames : sequence of (height, width, 3) uint8
        At least one.
    path : str or Path
        File to be written.
    frames_per_s : int
        Speed.
    """
    if not frames:
        raise ValueError("frames: none; expected at least one picture of render()")
    images = [Image.fromarray(frame) for frame in frames]
    with atomic_write(path) as temporary:
        images[0].save(
            temporary,
            format="GIF",
            save_all=True,
            append_images=images[1:],
            duration=round(1000 / frames_per_s),
            loop=0,
        )
