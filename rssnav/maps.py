"""Floor plan -> radio map, kept in a file and made again only where something has changed."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import h5py
import numpy as np

import floorplans
from floorplans import FloorPlan, PlanMaterial
from raytrace import (
    Grid,
    MapFileError,
    RadioMap,
    Scene,
    SceneError,
    TraceConfig,
    Transmitter,
    compute_radio_map,
)
from raytrace.radio.materials import (
    MATERIAL_EDITION,
    Dielectric,
    Layer,
    Layered,
    Material,
    find_material,
)
from raytrace.results.map_file import FORMAT
from raytrace.trace import TRACER_VERSION
from rssnav.cost_notice import announcement

Progress = Callable[[int, int], None]
Notice = Callable[[str], None]

CELL_SIZE_M = 1.0
HEIGHT_M = 2.0
POWER_DBM = 25.0
FREQUENCY_HZ = 2.4e9

_HDF5_SIGNATURE = b"\x89HDF\r\n\x1a\n"
_MARKS = (FORMAT.encode(), b"rss_coherent_dbm")
_RESOLUTION_M = 1e-9


def edition_of(plan: FloorPlan, edition: str | None = None) -> str:
    """Edition of ITU-R P.2040: the one asked for, else the plan's, else the tracer's."""
    return edition or plan.material_edition or MATERIAL_EDITION


def scene_of(plan: FloorPlan, edition: str | None = None) -> Scene:
    """Make a plan's scene.

    Parameters
    ----------
    plan : FloorPlan
    edition : str, optional
        Of ITU-R P.2040, for the built-in materials; see `edition_of`.

    Raises
    ------
    SceneError
        Where the tracer cannot work with the plan; the message names it.
    """
    walls = plan.to_mesh()
    edition = edition_of(plan, edition)
    try:
        own = _own_materials(plan, edition)
        materials = [(own.get(name, name), thickness_m) for name, thickness_m in walls.materials]
        return Scene.from_mesh(walls.mesh, walls.face_material, materials, edition=edition)
    except SceneError as error:
        raise SceneError(f"plan {plan.name!r}: {error}") from error


def _own_materials(plan: FloorPlan, edition: str) -> dict[str, Material]:
    """A plan's own materials as the tracer knows them."""
    dielectrics = {m.name: _dielectric(m) for m in plan.materials if not m.layers}

    def layer(name: str, thickness_m: float) -> Layer:
        material = dielectrics.get(name) or find_material(name, edition)
        assert isinstance(material, Dielectric)
        return Layer(material, thickness_m)

    layered = {
        m.name: Layered(m.name, tuple(layer(*of) for of in m.layers))
        for m in plan.materials
        if m.layers
    }
    return {**dielectrics, **layered}


def _dielectric(material: PlanMaterial) -> Dielectric:
    return Dielectric.of_law(material.name, material.a, material.b, material.c, material.d)


@dataclass(frozen=True)
class MapRequest:
    """Everything that decides what a map holds.

    Attributes
    ----------
    plan
        Walls and source.
    grid
        Where the receivers are.
    transmitter
        At the plan's source.
    config
        How far the tracer goes.
    edition
        Of ITU-R P.2040, for the built-in materials.
    """

    plan: FloorPlan
    grid: Grid
    transmitter: Transmitter
    config: TraceConfig
    edition: str

    def difference(self, radio_map: RadioMap) -> str | None:
        """Say in what respect a map is not the one asked for; None where it is."""
        found, grid = radio_map.provenance, radio_map.grid
        made_with = {"material_edition": self.edition, "tracer_version": TRACER_VERSION}
        for what, same in (
            ("for another plan", radio_map.plan_sha256 == self.plan.sha256),
            ("with another trace configuration", radio_map.config == self.config),
            ("for another transmitter", radio_map.transmitter == self.transmitter),
            ("on another grid", _same_grid(grid, self.grid)),
            *(
                (f"with another {key.replace('_', ' ')}", found.get(key) == value)
                for key, value in made_with.items()
            ),
        ):
            if not same:
                return f"made {what}"
        return None

    def compute(
        self,
        threads: int | None = None,
        progress: Progress | None = None,
        notice: Notice | None = None,
    ) -> RadioMap:
        """Trace the map and mark it with its plan; say so before if it will take long."""
        scene = scene_of(self.plan, self.edition)
        made_with = scene, self.transmitter, self.grid, self.config
        try:
            if notice is not None and (words := announcement(*made_with, threads)) is not None:
                notice(words)
            radio_map = compute_radio_map(*made_with, threads=threads, progress=progress)
        except SceneError as error:
            raise SceneError(f"plan {self.plan.name!r}: {error}") from error
        return radio_map.with_plan(floorplans.dumps(self.plan), self.plan.sha256)


def make_map(
    plan: FloorPlan,
    path: str | Path | None = None,
    *,
    cell_size_m: float = CELL_SIZE_M,
    height_m: float = HEIGHT_M,
    config: TraceConfig | None = None,
    power_dbm: float = POWER_DBM,
    frequency_hz: float = FREQUENCY_HZ,
    edition: str | None = None,
    threads: int | None = None,
    progress: Progress | None = None,
    notice: Notice | None = None,
    force: bool = False,
) -> RadioMap:
    """Return a plan's radio map: the one in a file if it is current, otherwise a new one.

    Parameters
    ----------
    plan : FloorPlan
        Walls and source.
    path : str or Path, optional
        Where the map is kept (HDF5). A new one replaces it whole or not at all.
    cell_size_m : float
        Side of a cell [m].
    height_m : float
        Height of the receivers, between floor and ceiling [m].
    config : TraceConfig, optional
        How many reflections and diffractions; 6 and 1 by default.
    power_dbm : float
        Power fed to the source's antenna [dBm].
    frequency_hz : float
        Carrier frequency [Hz].
    edition : str, optional
        Of ITU-R P.2040, for the built-in materials; by default the plan's, else the newest.
    threads : int, optional
        How many to trace with; all processors by default. The map does not depend on it.
    progress : callable, optional
        Called as ``progress(done, total)`` while tracing.
    notice : callable, optional
        Called with a sentence: that the file is current, why it is made again, or that tracing
        will take longer than a minute.
    force : bool
        Make the map again, and replace whatever is at `path`.

    Raises
    ------
    ValueError
        For a number out of range.
    SceneError
        Where the tracer cannot work with the plan.
    MapFileError
        Where `path` holds a file that is no radio map, which is left alone unless forced.
    """
    if not 0.0 < height_m < plan.height_m:
        raise ValueError(
            f"height_m = {height_m:g}: plan {plan.name!r} needs a height between its floor and its "
            f"ceiling, above 0 and below {plan.height_m:g} m"
        )
    request = MapRequest(
        plan,
        Grid.over(plan.bounds, cell_size_m, height_m),
        Transmitter(plan.source, power_dbm, frequency_hz),
        config or TraceConfig(),
        edition_of(plan, edition),
    )
    if path is None:
        return request.compute(threads, progress, notice)
    path = Path(path)
    if not force and (current := _current_map(request, path, notice)) is not None:
        return current
    radio_map = request.compute(threads, progress, notice)
    radio_map.save(path)
    return radio_map


def require_map_for(plan: FloorPlan, radio_map: RadioMap, path: str | Path | None = None) -> None:
    """Refuse a map that was made for another plan.

    Parameters
    ----------
    plan, radio_map
        What must belong together.
    path
        The map's file, for the message.

    Raises
    ------
    MapFileError
        Where they do not.
    """
    if radio_map.plan_sha256 == plan.sha256:
        return
    where = f"{path}: " if path is not None else ""
    target = path if path is not None else "FILE"
    raise MapFileError(
        f"{where}the map was made for another plan: plan_sha256 = "
        f"{radio_map.plan_sha256[:12] or 'none'}, but plan {plan.name!r} has {plan.sha256[:12]}; "
        f"make it again with `rssnav map PLAN -o {target}`, or name the plan it was made for"
    )


def _current_map(request: MapRequest, path: Path, notice: Notice | None) -> RadioMap | None:
    """Return the map in a file if it is the one asked for, None if it may be made again."""
    tell = notice or _say_nothing
    if not path.exists():
        return None
    try:
        radio_map = RadioMap.load(path)
    except MapFileError as error:
        if not _is_radio_map(path):
            raise MapFileError(
                f"{path}: there is a file that is not a radio map, and it is left alone; give "
                "another place, or --force to replace it"
            ) from error
        tell(f"{path} is damaged or of another version; making it again")
        return None
    difference = request.difference(radio_map)
    if difference is None:
        tell(f"{path} is up to date")
        return radio_map
    tell(f"{path} was {difference}; making it again")
    return None


def _say_nothing(_sentence: str) -> None:
    """Drop a notice."""


def _is_radio_map(path: Path) -> bool:
    """Tell whether an unreadable file is what is left of a radio map, of any version.

    A file that HDF5 cannot open is one if it begins like HDF5 and holds the name of the format or
    of a dataset that only radio maps have. An empty file is anybody's.
    """
    if not path.is_file():
        return False
    try:
        with h5py.File(path) as file:
            return file.attrs.get("format") == FORMAT
    except (OSError, RuntimeError, KeyError):
        content = path.read_bytes()
    if not content:
        return True
    return content.startswith(_HDF5_SIGNATURE) and any(mark in content for mark in _MARKS)


def _same_grid(one: Grid, other: Grid) -> bool:
    """Tell whether two grids have the same receivers."""
    return (
        one.shape == other.shape
        and bool(np.allclose(one.x, other.x, rtol=0.0, atol=_RESOLUTION_M))
        and bool(np.allclose(one.y, other.y, rtol=0.0, atol=_RESOLUTION_M))
        and (one.height_m, one.cell_size_m) == (other.height_m, other.cell_size_m)
    )
