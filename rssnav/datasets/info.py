"""What a data set holds, in numbers."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import Any

from rssnav.datasets.folder import JOURNAL, MANIFEST, spec_of
from rssnav.datasets.journal import Journal
from rssnav.datasets.manifest import read_manifest
from rssnav.datasets.split import SPLITS


def facts(folder: Path) -> dict[str, Any]:
    """Return name, licence, numbers of plans and maps by split, size and failures.

    Of a data set that is not complete, what is finished so far.

    Raises
    ------
    DatasetError
        Where the folder is no data set.
    """
    spec = spec_of(folder)
    entries = Journal(folder / JOURNAL).entries
    is_complete = (folder / MANIFEST).is_file()
    found: dict[str, Any] = {
        "name": spec.name,
        "license": spec.license,
        "complete": is_complete,
        "plans_finished": sum(not entry.is_failed for entry in entries.values()),
        "plans_failed": sum(entry.is_failed for entry in entries.values()),
        "maps": 0,
        "bytes": sum(entry.n_bytes for entry in entries.values()),
    }
    if is_complete:
        names = ["plan", "split", "frequency_hz", "preset"]
        table = read_manifest(folder / MANIFEST, names).to_pydict()
        maps, buildings = (
            Counter(table["split"]),
            dict(zip(table["plan"], table["split"], strict=True)),
        )
        plans = Counter(buildings.values())
        found |= {
            "maps": len(table["plan"]),
            "splits": {s: {"plans": plans[s], "maps": maps[s]} for s in SPLITS},
            "frequencies_ghz": sorted({f / 1e9 for f in table["frequency_hz"]}),
            "presets": sorted(set(table["preset"])),
            "layers": list(spec.configuration.layers),
        }
    return found
