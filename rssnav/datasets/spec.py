"""The spec of a data set: a TOML file that determines every bit of it."""

from __future__ import annotations

import hashlib
import tomllib
from dataclasses import dataclass
from functools import cached_property
from importlib import resources
from pathlib import Path
from typing import Any

from floorplans import MATERIAL_EDITIONS
from floorplans.generators import KINDS, LARGEST_M2, LEAST_M2, SHAPES
from floorplans.transmitters import ANTENNAS, MAX_TRANSMITTERS
from raytrace import TraceConfig
from raytrace.radio.itu import DEFAULT_EDITION
from raytrace.results.layers import LAYERS
from rssnav.datasets.configuration import Configuration, NamedAntenna
from rssnav.datasets.errors import DatasetError
from rssnav.datasets.plans import FilePlans, GeneratedPlans, PlanSource
from rssnav.datasets.split import SPLITS, Fractions, divided
from rssnav.datasets.table import Table
from rssnav.presets import PRESETS, with_limits

MAX_SPEC_BYTES = 1_000_000
MAX_PLANS = 10_000_000
MAX_PATHS_A_CELL = 100
KEYS = (
    "name", "description", "license", "plans", "split", "transmitters", "receivers", "presets",
    "keep", "material_edition",
)  # fmt: skip
_LIMITS = {
    "reflections": "max_reflections",
    "diffractions": "max_diffractions",
    "transmissions": "max_transmissions",
    "min_power_dbm": "min_power_dbm",
    "dynamic_range_db": "dynamic_range_db",
    "max_paths": "max_paths",
}
UNLIMITED = "none"


@dataclass(frozen=True)
class DatasetSpec:
    """What a data set is made of.

    Attributes
    ----------
    path
        The file it was read from.
    text
        Its content.
    name, description, license
        For the data card.
    entries
        Where the plans come from.
    fractions
        How the buildings are divided; None where each entry names its split.
    configuration
        What is traced in each plan.
    """

    path: Path
    text: str
    name: str
    description: str
    license: str
    entries: tuple[GeneratedPlans | FilePlans, ...]
    fractions: Fractions | None
    configuration: Configuration

    @property
    def sha256(self) -> str:
        """Hash of its content."""
        return hashlib.sha256(self.text.encode()).hexdigest()

    @cached_property
    def plans(self) -> list[PlanSource]:
        """All plans, each with its split.

        Raises
        ------
        DatasetError
            Where splits overlap, or a folder holds no plans.
        PlanError
            Where a file of a folder is no plan.
        """
        sources = [source for entry in self.entries for source in entry.sources()]
        return divided(sources, self.fractions, self.path)


def builtin_specs() -> tuple[str, ...]:
    """Names of the specs that come with the package, sorted."""
    files = (resources.files("rssnav.datasets") / "specs").iterdir()
    return tuple(sorted(f.name.removesuffix(".toml") for f in files if f.name.endswith(".toml")))


def load_spec(spec: str | Path) -> DatasetSpec:
    """Read a spec.

    Parameters
    ----------
    spec
        A built-in name (`builtin_specs`), or the path of a TOML file.

    Raises
    ------
    DatasetError
        Where it is wrong; the message names the file, the key and what is expected.
    OSError
        Where it cannot be read.
    """
    if spec in builtin_specs():
        file = resources.files("rssnav.datasets") / "specs" / f"{spec}.toml"
        return read_spec(file.read_text("utf-8"), Path(f"{spec}.toml"))
    path = Path(spec)
    with path.open("rb") as file:
        content = file.read(MAX_SPEC_BYTES + 1)
    if len(content) > MAX_SPEC_BYTES:
        raise DatasetError(f"larger than {MAX_SPEC_BYTES} bytes", path)
    try:
        return read_spec(content.decode("utf-8-sig"), path)
    except UnicodeDecodeError as error:
        raise DatasetError("not UTF-8", path) from error


def read_spec(text: str, path: Path) -> DatasetSpec:
    """Read the text of a spec; see `load_spec`."""
    try:
        values = tomllib.loads(text)
    except (ValueError, RecursionError) as error:  # integers of thousands of digits, too
        raise DatasetError(f"not TOML: {error}", path) from error
    top = Table(path, "", values).only(*KEYS)
    transmitters = top.table("transmitters").only(
        "count", "which", "power_dbm", "frequencies_ghz", "antennas"
    )
    count = transmitters.integer("count", 1, MAX_TRANSMITTERS, 3)
    entries = tuple(_entry(table, count) for table in top.tables("plans"))
    fractions = _fractions(top, entries)
    return DatasetSpec(
        path,
        text,
        top.text("name", most=100),
        top.text("description", ""),
        top.text("license", "CC-BY-4.0", 100),
        entries,
        fractions,
        _configuration(top, transmitters),
    )


def _entry(table: Table, count: int) -> GeneratedPlans | FilePlans:
    split = table.text("split", "")
    if split and split not in SPLITS:
        raise table.error("split", f"one of {', '.join(SPLITS)}")
    if "folder" in table.values:
        table.only("folder", "split")
        return FilePlans(table.path.parent / table.text("folder"), split)
    table.only("kind", "seeds", "area_m2", "furniture", "shape", "split")
    if table.text("kind") not in KINDS:
        raise table.error("kind", f"one of {', '.join(KINDS)}, or a key folder instead")
    if table.text("shape", SHAPES[0]) not in SHAPES:
        raise table.error("shape", f"one of {', '.join(SHAPES)}")
    return GeneratedPlans(
        table.text("kind"),
        _seeds(table),
        _area(table),
        table.flag("furniture", True),
        table.text("shape", SHAPES[0]),
        count,
        split,
    )


def _seeds(table: Table) -> range | tuple[int, ...]:
    """Read a number of seeds from 0 on, a range of them, or a list."""
    value: Any = table.values.get("seeds")
    if isinstance(value, dict):
        of = Table(table.path, f"{table.name}.seeds", value).only("first", "count")
        first = of.integer("first", 0, 2**62, 0)
        return range(first, first + of.integer("count", 1, MAX_PLANS))
    if isinstance(value, list):
        are_seeds = value and all(type(v) is int and 0 <= v < 2**63 for v in value)
        if are_seeds and len(set(value)) == len(value):
            return tuple(value)
        raise table.error("seeds", "a list of different integers from 0 to 2^63 - 1")
    return range(table.integer("seeds", 1, MAX_PLANS))


def _area(table: Table) -> float | tuple[float, float] | None:
    value = table.values.get("area_m2")
    if isinstance(value, list):
        found = table.numbers("area_m2", LEAST_M2, LARGEST_M2, ())
        if len(found) != 2 or found[0] > found[1]:
            raise table.error("area_m2", "a number, or [least, largest]")
        return found[0], found[1]
    return table.number("area_m2", LEAST_M2, LARGEST_M2, None)


def _fractions(top: Table, entries: tuple[GeneratedPlans | FilePlans, ...]) -> Fractions | None:
    """Read how buildings are divided: by fractions, or by each entry."""
    named = [bool(entry.split) for entry in entries]
    table = top.table("split").only(*SPLITS, "seed")
    if all(named):
        if table.values:
            raise DatasetError(
                "a table [split], but each of [[plans]] names its split: expected one of both",
                top.path,
            )
        return None
    if any(named):
        raise DatasetError(
            f"plans[{named.index(False)}] names no split, but others do: expected all or none",
            top.path,
        )
    defaults = {} if table.values else {"train": 0.8, "validation": 0.1, "test": 0.1}
    weights = {name: table.number(name, 0.0, 1e9, defaults.get(name, 0.0)) for name in SPLITS}
    if not sum(weights.values()) > 0.0:
        raise DatasetError("[split]: expected a positive fraction of some split", top.path)
    return Fractions(weights, table.integer("seed", 0, 2**63 - 1, 0))


def _configuration(top: Table, transmitters: Table) -> Configuration:
    receivers = top.table("receivers").only("antenna", "heights_m", "cell_size_m")
    keep = top.table("keep").only("layers", "strongest_paths")
    edition = top.text("material_edition", DEFAULT_EDITION)
    if edition not in MATERIAL_EDITIONS:
        raise top.error("material_edition", f"one of {', '.join(MATERIAL_EDITIONS)}")
    ghz = transmitters.numbers("frequencies_ghz", 0.001, 1000.0, (2.4,))
    antennas = transmitters.texts("antennas", ("unpolarised",))
    return Configuration(
        transmitters.texts("which", ()) if "which" in transmitters.values else (),
        transmitters.number("power_dbm", -200.0, 200.0, 20.0),
        tuple(round(1e9 * frequency, 3) for frequency in ghz),
        tuple(_antenna(transmitters, "antennas", name) for name in antennas),
        _antenna(receivers, "antenna", receivers.text("antenna", "unpolarised")),
        receivers.numbers("heights_m", 0.01, 1000.0, (1.5,)),
        receivers.number("cell_size_m", 0.05, 100.0, 0.5),
        _presets(top),
        keep.texts("layers", ("rss_dbm", "path_count"), tuple(LAYERS)),
        keep.integer("strongest_paths", 0, MAX_PATHS_A_CELL, 0),
        edition,
    )


def _antenna(table: Table, key: str, name: str) -> NamedAntenna:
    if name in ANTENNAS:
        return NamedAntenna(name)
    path = table.path.parent / name
    if path.suffix.lower() != ".csv" or not path.is_file():
        raise table.error(key, f"{', '.join(ANTENNAS)}, or the path of a .csv file with a pattern")
    found = NamedAntenna(path.name, path.resolve(), hashlib.sha256(path.read_bytes()).hexdigest())
    found.antenna()
    return found


def _presets(top: Table) -> dict[str, TraceConfig]:
    """Read the limits: tables by name; a built-in one needs no keys."""
    tables = top.table("presets")
    names = list(tables.values) or ["building"]
    return {name: _preset(tables.table(name), name) for name in names}


def _preset(table: Table, name: str) -> TraceConfig:
    table.only("base", *_LIMITS)
    base = table.text("base", name if name in PRESETS else "building")
    if base not in PRESETS:
        raise table.error("base", f"one of {', '.join(PRESETS)}")
    given = {field: table.values[key] for key, field in _LIMITS.items() if key in table.values}
    if given.get("max_transmissions") == UNLIMITED:
        given["max_transmissions"] = None
    for field, value in given.items():
        if value is not None and (isinstance(value, bool) or not isinstance(value, int | float)):
            key = next(key for key, of in _LIMITS.items() if of == field)
            raise table.error(key, "a number" + (f" or {UNLIMITED!r}" * (key == "transmissions")))
    try:
        return with_limits(PRESETS[base].config, given)
    except ValueError as error:
        raise DatasetError(f"[{table.name}]: {error}", table.path) from error
