"""The formats a plan can be exported to, and the writing of their files."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path

from atomicfiles import atomic_write_all
from floorplans.errors import PlanError, unknown_name
from floorplans.plan import FloorPlan


@dataclass(frozen=True)
class ExportOptions:
    """Options of an export.

    Attributes
    ----------
    resolution_m : float
        Side of a pixel of an occupancy grid [m].
    slice_height_m : float or None
        Height above the floor of the section that an occupancy grid shows [m]; None is 1 m, or half
        the storey's height if that is less.
    frequency_hz : float
        At which a plan's own dielectrics are evaluated for programs that want constants [Hz].
    """

    resolution_m: float = 0.05
    slice_height_m: float | None = None
    frequency_hz: float = 2.4e9


Files = Mapping[str, bytes]
"""Path relative to the folder of the exported file -> content."""

Renderer = Callable[[FloorPlan, Path, ExportOptions], Files]
"""Takes the plan, the path of the main file, and the options."""


@dataclass(frozen=True)
class Format:
    """A file format that a plan can be written in.

    Attributes
    ----------
    name : str
        One word, as `export` takes it.
    suffixes : tuple of str
        In lower case, with the dot.
    module, function : str
        The renderer; its module is imported on first use.
    """

    name: str
    suffixes: tuple[str, ...]
    module: str
    function: str

    def renderer(self) -> Renderer:
        """Load the renderer."""
        return getattr(import_module(f"floorplans.exporters.{self.module}"), self.function)


FORMATS = (
    Format("geojson", (".geojson", ".json"), "geojson", "render_geojson"),
    Format("dxf", (".dxf",), "dxf", "render_dxf"),
    Format("ros", (".yaml", ".pgm"), "ros_map", "render_ros_map"),
    Format("glb", (".glb",), "mesh", "render_glb"),
    Format("ply", (".ply",), "mesh", "render_ply"),
    Format("stl", (".stl",), "mesh", "render_stl"),
    Format("obj", (".obj",), "mesh", "render_obj"),
    Format("sionna", (".xml",), "sionna", "render_sionna"),
)
"""All formats a plan can be written in."""


def export(
    plan: FloorPlan,
    path: str | Path,
    format: str | None = None,
    options: ExportOptions | None = None,
) -> tuple[Path, ...]:
    """Write a plan in another program's format.

    Parameters
    ----------
    plan : FloorPlan
    path : str or Path
        Its suffix selects the format unless `format` does.
    format : str, optional
        Name of one of `FORMATS`.
    options : ExportOptions, optional

    Returns
    -------
    tuple of Path
        All files written, the main one first.

    Raises
    ------
    PlanError
        When the format is unknown, or cannot hold this plan with these options.
    """
    path = Path(path)
    files = render(plan, path, format, options or ExportOptions())
    return _write_all({path.parent / name: content for name, content in files.items()})


def render(plan: FloorPlan, path: Path, format: str | None, options: ExportOptions) -> Files:
    """Return the files that `export` would write, without writing them; see `export`."""
    return format_of(path, format).renderer()(plan, path, options)


def format_of(path: Path, name: str | None = None) -> Format:
    """Find a format by its name, or by the suffix of a path; raise `PlanError` if there is none."""
    for kind in FORMATS:
        if kind.name == name or (name is None and path.suffix.lower() in kind.suffixes):
            return kind
    if name is not None:
        raise PlanError(unknown_name("format", name, tuple(kind.name for kind in FORMATS)))
    known = ", ".join(suffix for kind in FORMATS for suffix in kind.suffixes)
    raise PlanError(f"no format has the suffix {path.suffix!r}; known: {known}", origin=str(path))


def _write_all(files: Mapping[Path, bytes]) -> tuple[Path, ...]:
    """Write all files or none of them."""
    try:
        atomic_write_all(files)
    except OSError as error:
        raise PlanError(
            f"the file cannot be written: {error.strerror}", origin=str(next(iter(files)))
        ) from error
    return tuple(files)
