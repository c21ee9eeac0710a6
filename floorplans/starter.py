"""A starter plan of any size: commented TOML text to edit by hand."""

import json
from importlib import resources
from math import floor
from string import Template

MIN_SIDE_M = 5.0
MAX_SIDE_M = 1000.0


def starter_plan(name: str, width_m: float, depth_m: float, height_m: float = 3.0) -> str:
    """Write a plan of three rooms with comments that explain each key.

    Parameters
    ----------
    name : str
        One line of text.
    width_m, depth_m : float
        Extent along x and y [m], `MIN_SIDE_M` to `MAX_SIDE_M`.
    height_m : float
        From floor to ceiling [m], at least 2.5.

    Returns
    -------
    str
        TOML that `floorplans.loads` reads.

    Raises
    ------
    ValueError
        For a size out of range.
    """
    for key, side in (("width", width_m), ("depth", depth_m)):
        if not MIN_SIDE_M <= side <= MAX_SIDE_M:
            raise ValueError(f"a {key} of {side:g} m: expected {MIN_SIDE_M:g} to {MAX_SIDE_M:g} m")
    if not 2.5 <= height_m <= 50.0:
        raise ValueError(f"a height of {height_m:g} m: expected 2.5 to 50 m")
    partition = floor(0.4 * width_m + 0.5)
    numbers = {
        "height": height_m,
        "source_x": width_m - 1.2,
        "source_y": depth_m - 1.1,
        "source_z": 1.2,
        "width": width_m,
        "depth": depth_m,
        "entrance": partition / 2 - 0.5,
        "window": width_m + depth_m + 1.0,
        "partition": partition,
        "middle": floor(0.5 * depth_m + 0.5),
        "counter": floor(0.75 * depth_m + 0.5),
        "counter_end": partition - 1,
    }
    texts = {key: f"{number:.10g}" for key, number in numbers.items()}
    template = Template((resources.files("floorplans") / "starter.toml").read_text("utf-8"))
    return template.substitute(texts, name=json.dumps(name, ensure_ascii=False))
