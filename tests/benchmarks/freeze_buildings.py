"""Write the fingerprints of the benchmark's buildings, for a new version of the benchmark.

    python tests/benchmarks/freeze_buildings.py

takes 20 s. Raise `BENCHMARK_VERSION` in rssnav/benchmark/protocol.py with it.
"""

from __future__ import annotations

from pathlib import Path
from textwrap import fill

from rssnav.benchmark import frozen
from rssnav.benchmark.buildings import unchecked
from rssnav.benchmark.frozen import TEXT

DIGITS = 8
BEGIN = 'TEXT: dict[Split | Literal["paper"], str] = {\n'


def main() -> None:
    page = Path(frozen.__file__)
    before, _, after = page.read_text().partition(BEGIN)
    _, _, after = after.partition("}\n")
    parts: list[str] = []
    for site, known in TEXT.items():
        found = [building.fingerprint[:DIGITS] for building in unchecked(site, len(known.split()))]
        lines = fill(" ".join(found), 98, initial_indent=" " * 8, subsequent_indent=" " * 8)
        parts.append(f'    "{site}": """\n{lines}\n    """,\n')
    page.write_text(before + BEGIN + "".join(parts) + "}\n" + after)


if __name__ == "__main__":
    main()
