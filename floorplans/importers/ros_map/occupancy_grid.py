"""Reading of occupancy grids of ROS map_server, and of plain pictures with a scale.

A pixel of value v is occupied with the likelihood (255 - v) / 255, or v / 255 if `negate` is set:
above `occupied_thresh` it is occupied, below `free_thresh` free, and otherwise unknown. Map savers
of ROS 2 write unknown space with a value that their own default of `free_thresh` makes free; it is
unknown in a picture that has only their three values.
"""

from __future__ import annotations

import sys
import warnings
from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import isfinite
from pathlib import Path
from typing import Any, cast

import numpy as np
import yaml
from numpy.typing import NDArray
from PIL import Image

from floorplans.errors import PlanError, unknown_name

MAX_PIXELS = 16_000_000
MAX_YAML_BYTES = 65_536
MODES = ("trinary", "scale", "raw")
PICTURES = (".pgm", ".png")
YAMLS = (".yaml", ".yml")

_SAVED_VALUES = (0, 205, 254)
_SAVED_UNKNOWN = 205
"""Values that map savers write for occupied, unknown and free space."""
_UNKNOWN_IS_FREE = (
    "free_thresh = {:g} would make pixels of value {} free, with which map savers write unknown "
    "space: they are unknown"
)

Mask = NDArray[np.bool_]


@dataclass(frozen=True)
class MapMetadata:
    """Contents of a map's YAML file; the defaults are map_server's.

    Attributes
    ----------
    image : str
        Name of the picture.
    resolution_m : float
        Side of a pixel [m].
    origin : (float, float, float)
        x, y [m] and yaw [rad] of the picture's lower left corner.
    negate : bool
    occupied_thresh, free_thresh : float
    mode : {"trinary", "scale", "raw"}
    """

    image: str
    resolution_m: float
    origin: tuple[float, float, float] = (0.0, 0.0, 0.0)
    negate: bool = False
    occupied_thresh: float = 0.65
    free_thresh: float = 0.196
    mode: str = "trinary"


@dataclass(frozen=True)
class OccupancyGrid:
    """Which pixels are wall; the first row is the bottom one.

    Attributes
    ----------
    occupied, free : (n_y, n_x) bool
        Other pixels are unknown.
    metadata : MapMetadata
    notes : tuple of str
    """

    occupied: Mask
    free: Mask
    metadata: MapMetadata
    notes: tuple[str, ...] = ()


def read_grid(path: Path, scale_m: float | None) -> OccupancyGrid:
    """Read a map from its YAML file, or from a picture with a YAML file of the same name.

    Parameters
    ----------
    path : Path
    scale_m : float or None
        Side of a pixel [m]; overrides the file's resolution, and is required without a YAML
        file.

    Returns
    -------
    OccupancyGrid

    Raises
    ------
    PlanError
        When a file is missing, of another format, too large, or incomplete.
    """
    if scale_m is not None and not (isfinite(scale_m) and scale_m > 0):
        raise PlanError("expected a length above 0 [m]", ("scale",), scale_m)
    if path.suffix.lower() in YAMLS:
        metadata, notes = _read_metadata(path), ()
        picture = _picture_of(path, metadata.image)
    else:
        metadata, notes = _metadata_beside(path, scale_m)
        picture = path
    if scale_m is not None:
        metadata = replace(metadata, resolution_m=scale_m)
    pixels = _read_picture(picture)
    occupied, free = _classified(pixels, metadata)
    unknown = _saved_as_unknown(pixels, metadata) & free
    if unknown.any():
        free &= ~unknown
        notes = (*notes, _UNKNOWN_IS_FREE.format(metadata.free_thresh, _SAVED_UNKNOWN))
    if not occupied.any():
        raise PlanError("no pixel is occupied, so there is no wall", origin=str(picture))
    return OccupancyGrid(occupied[::-1], free[::-1], metadata, notes)


def _metadata_beside(picture: Path, scale_m: float | None) -> tuple[MapMetadata, tuple[str, ...]]:
    beside = [picture.with_suffix(ending) for ending in YAMLS]
    for path in beside:
        if path.is_file():
            metadata = _read_metadata(path)
            if Path(metadata.image).name == picture.name:
                return metadata, ()
            note = f"{path.name} names the picture {metadata.image}; it is read as {picture.name}"
            return metadata, (note,)
    if scale_m is None:
        raise PlanError(
            f"the size of a pixel is not known: there is no {beside[0].name} beside the picture; "
            "give it, such as 0.05 m",
            origin=str(picture),
            remedy="scale_m",
        )
    return MapMetadata(picture.name, scale_m), ()


def _is_file(path: Path) -> bool:
    """Whether a path is that of a file; one too long for the system is none."""
    try:
        return path.is_file()
    except OSError:
        return False


def _picture_of(path: Path, image: str) -> Path:
    """Path of the picture that a YAML file names, in or below the YAML file's folder."""
    folder = path.parent.resolve()
    picture = (folder / image.replace("\0", "")).resolve()
    if not picture.is_relative_to(folder) or picture.suffix.lower() not in PICTURES:
        raise PlanError(
            "expected a .pgm or .png file beside the YAML file", ("image",), image, str(path)
        )
    if not _is_file(picture):
        own = [
            path.with_suffix(ending) for ending in PICTURES if path.with_suffix(ending).is_file()
        ]
        hint = f"; {own[0].name} lies beside it: import that file" if own else "; put it there"
        raise PlanError(
            f"there is no such file{hint}, or correct image:", ("image",), image, str(path)
        )
    return picture


def _read_metadata(path: Path) -> MapMetadata:
    try:
        if path.stat().st_size > MAX_YAML_BYTES:
            raise PlanError("the file is too long to be a map's YAML file", origin=str(path))
        data: object = yaml.safe_load(path.read_text(encoding="utf-8-sig"))
    except (yaml.YAMLError, ValueError, RecursionError, OSError) as error:
        if isinstance(error, PlanError):
            raise
        reason = " ".join(str(error).split())
        raise PlanError(f"not a map's YAML file: {reason}", origin=str(path)) from error
    if not isinstance(data, dict):
        raise PlanError("expected the keys image, resolution and origin", origin=str(path))
    try:
        return _metadata(cast("Mapping[str, Any]", data))
    except PlanError as error:
        raise error.located(str(path)) from None


def _metadata(data: Mapping[str, Any]) -> MapMetadata:
    image = data.get("image")
    if not isinstance(image, str):
        raise PlanError("expected the name of the picture", ("image",))
    mode = data.get("mode", "trinary")
    if not isinstance(mode, str) or mode not in MODES:
        raise PlanError(unknown_name("mode", str(mode)[:20], MODES), ("mode",))
    resolution_m = _number(data.get("resolution"), "resolution")
    if resolution_m <= 0:
        raise PlanError("expected a length above 0 [m]", ("resolution",), resolution_m)
    occupied = _number(data.get("occupied_thresh", 0.65), "occupied_thresh")
    free = _number(data.get("free_thresh", 0.196), "free_thresh")
    if not 0 <= free <= occupied <= 1:
        raise PlanError("expected 0 <= free_thresh <= occupied_thresh <= 1", ("free_thresh",), free)
    origin = data.get("origin")
    if not isinstance(origin, list) or len(cast("list[object]", origin)) != 3:
        raise PlanError("expected [x, y, yaw] in metres and radians", ("origin",))
    x, y, yaw = (_number(number, "origin") for number in cast("list[object]", origin))
    negate = bool(_number(data.get("negate", 0), "negate"))
    return MapMetadata(image, resolution_m, (x, y, yaw), negate, occupied, free, mode)


def _number(value: object, key: str) -> float:
    if not isinstance(value, int | float) or not abs(value) <= sys.float_info.max:
        raise PlanError("expected a finite number", (key,))
    return float(value)


def _read_picture(path: Path) -> Image.Image:
    """Open a picture, reject a large one by its header, then decode it."""
    try:
        with warnings.catch_warnings(), path.open("rb") as file:
            warnings.simplefilter("error", Image.DecompressionBombWarning)
            picture = Image.open(file, formats=("PPM", "PNG"))
            if picture.width * picture.height > MAX_PIXELS:
                raise PlanError(
                    f"{picture.width} x {picture.height} pixels, at most {MAX_PIXELS} are read; "
                    "cut out the building or halve the resolution",
                    origin=str(path),
                )
            picture.load()
    except PlanError:
        raise
    except (Image.DecompressionBombError, Image.DecompressionBombWarning) as error:
        raise PlanError(f"the picture is too large: {error}", origin=str(path)) from error
    except (OSError, ValueError, SyntaxError, IndexError, OverflowError) as error:
        raise PlanError(f"not a picture that can be read: {error}", origin=str(path)) from error
    return picture


def _saved_as_unknown(picture: Image.Image, metadata: MapMetadata) -> Mask:
    """Pixels with the grey of unknown space in a picture of the three values of the map saver."""
    values = np.asarray(picture.convert("L"))
    is_saved = metadata.mode == "trinary" and not metadata.negate
    if not is_saved or not np.isin(values, _SAVED_VALUES).all():
        return np.zeros(values.shape, dtype=np.bool_)
    return values == _SAVED_UNKNOWN


def _classified(picture: Image.Image, metadata: MapMetadata) -> tuple[Mask, Mask]:
    """Return which pixels are occupied and which are free; the first row is the top one."""
    seen = np.ones((picture.height, picture.width), dtype=np.bool_)
    if "A" in picture.getbands():
        seen = np.asarray(picture.getchannel("A")) > 127
    if picture.mode.startswith("I"):
        values = np.asarray(picture, dtype=np.float64) / 65535.0
    else:
        values = np.asarray(picture.convert("L"), dtype=np.float64) / 255.0
    if metadata.mode == "raw":
        likely = values * 2.55
        seen &= likely <= 1.0
    else:
        likely = values if metadata.negate else 1.0 - values
    return seen & (likely > metadata.occupied_thresh), seen & (likely < metadata.free_thresh)
