"""The data card: what a data set is, how it was made, and what its keys mean."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from importlib.metadata import version
from pathlib import Path

from atomicfiles import atomic_write
from raytrace.results.layers import LAYERS
from raytrace.trace import TRACER_VERSION
from rssnav.datasets.configuration import Configuration
from rssnav.datasets.plan_maps import AXES
from rssnav.datasets.spec import DatasetSpec
from rssnav.datasets.split import SPLITS
from rssnav.datasets.strongest import PATH_ARRAYS


@dataclass(frozen=True)
class Contents:
    """What a data set holds.

    Attributes
    ----------
    plans, maps
        Numbers of them in each split.
    n_failed
        Plans that could not be traced.
    sha256
        Hash of all maps.
    """

    plans: Mapping[str, int]
    maps: Mapping[str, int]
    n_failed: int
    sha256: str


def write_card(spec: DatasetSpec, contents: Contents, path: Path) -> None:
    """Write the card, in Markdown with the header that catalogues of data sets read."""
    total = sum(contents.maps.values())
    lines = [
        *_header(spec, total),
        f"# {spec.name}",
        "",
        spec.description or "Indoor radio maps by ray tracing.",
        "",
        f"{total} radio maps of {sum(contents.plans.values())} buildings. Licence: {spec.license}.",
        "",
        *_splits(contents),
        "",
        "## Files",
        "",
        "`manifest.parquet` has a row for each map: its plan, split and file, its indices within",
        "the file, and the hash of its values. `SPLIT/NNN/PLAN.h5` (HDF5) holds all maps of a",
        "plan, and `PLAN.toml` beside it the plan. `times.parquet` has the wall time of each map;",
        "it is not part of the data set's hash.",
        *(_failures(contents.n_failed)),
        "",
        f"Every layer has the dimensions {', '.join(AXES)}, y, x:",
        "",
        *_layers(spec.configuration),
        "",
        "Where no path arrives, powers are -inf and numbers of paths 0. `inside` is 1 where a cell",
        "is in the building.",
        "",
        "## How it was made",
        "",
        f"rssnav {version('rssnav')}, tracer {TRACER_VERSION}, materials of "
        f"{spec.configuration.edition}. `spec.toml` determines every value:",
        "",
        "```console",
        "rssnav dataset make spec.toml -o FOLDER",
        "rssnav dataset check FOLDER",
        "```",
        "",
        *_limits(spec.configuration),
        "",
        f"SHA-256 of the spec: `{spec.sha256}`",
        "",
        f"SHA-256 of the maps: `{contents.sha256}`",
        "",
    ]
    with atomic_write(path) as temporary:
        temporary.write_text("\n".join(lines), encoding="utf-8", newline="\n")


def _header(spec: DatasetSpec, total: int) -> list[str]:
    sizes = ((1_000, "n<1K"), (10_000, "1K<n<10K"), (100_000, "10K<n<100K"), (10**6, "100K<n<1M"))
    size = next((word for most, word in sizes if total < most), "1M<n<10M")
    return [
        "---",
        f"license: {spec.license.lower()}",
        f"pretty_name: {spec.name}",
        "tags: [radio-map, ray-tracing, indoor]",
        f"size_categories: [{size}]",
        "---",
        "",
    ]


def _splits(contents: Contents) -> list[str]:
    rows = [
        f"| {split} | {contents.plans.get(split, 0)} | {contents.maps.get(split, 0)} |"
        for split in SPLITS
    ]
    return ["| split | buildings | maps |", "|---|---|---|", *rows]


def _failures(n_failed: int) -> list[str]:
    if not n_failed:
        return []
    return [f"`failures.json` says why {n_failed} further plans could not be traced."]


def _layers(configuration: Configuration) -> list[str]:
    words = {name: (LAYERS[name].units, LAYERS[name].long_name) for name in configuration.layers}
    if configuration.strongest_paths:
        words |= PATH_ARRAYS
    rows = [f"| `{name}` | {units} | {text} |" for name, (units, text) in words.items()]
    return ["| key | unit | meaning |", "|---|---|---|", *rows]


def _limits(configuration: Configuration) -> list[str]:
    rows = [
        f"| `{name}` | {', '.join(f'{key} = {value}' for key, value in asdict(config).items())} |"
        for name, config in configuration.presets.items()
    ]
    return ["| preset | limits of a trace |", "|---|---|", *rows]
