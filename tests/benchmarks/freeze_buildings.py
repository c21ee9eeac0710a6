"""Write the fingerprints of the benchmark's buildings, for a new version of the benchmark.

    python tests/benchmarks/freeze_buildings.py

takes five minutes. Raise `BENCHMARK_VERSION` in rssnav/benchmark/protocol.py with it.
"""

from __future__ import annotations

from pathlib import Path
from textwrap import fill

from rssnav.benchmark import buildings, frozen
from rssnav.benchmark.buildings import Building, unchecked
from rssnav.benchmark.frozen import DOOR_TEXT, TEXT

DIGITS = 8


class Anything(dict):
    """Fingerprints that any building has."""

    def __missing__(self, site: str) -> Anything:
        return self

    def __getitem__(self, key: object) -> str | Anything:
        return self if isinstance(key, str) else ""


def table(name: str, kind: str, found: dict[str, list[Building]]) -> str:
    """Source of a table of fingerprints."""
    parts: list[str] = []
    for site, known in found.items():
        text = " ".join(building.fingerprint[:DIGITS] for building in known)
        lines = fill(text, 98, initial_indent=" " * 8, subsequent_indent=" " * 8)
        parts.append(f'    "{site}": """\n{lines}\n    """,\n')
    return f"{name}: dict[{kind}, str] = {{\n{''.join(parts)}}}\n"


def replaced(page: str, new: str) -> str:
    """Page with another table of the same name and kind."""
    begin = new.partition("\n")[0] + "\n"
    before, _, after = page.partition(begin)
    return before + new + after.partition("}\n")[2]


def main() -> None:
    buildings.DOOR_FINGERPRINTS = Anything()
    page = Path(frozen.__file__)
    drawn = {site: list(unchecked(site, len(known.split()))) for site, known in TEXT.items()}
    doors = {site: [building.with_doors for building in drawn[site]] for site in DOOR_TEXT}
    text = replaced(page.read_text(), table("TEXT", 'Split | Literal["paper"]', drawn))
    page.write_text(replaced(text, table("DOOR_TEXT", "Split", doors)))


if __name__ == "__main__":
    main()
