"""Write the leaderboard of docs/benchmark.md from results of ``rssnav benchmark``.

    python tests/benchmarks/leaderboard.py results/benchmark/results.json ...

Results of one extent are merged before: ``rssnav benchmark --with FILE``. Those of several follow
one another.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path

from performance_page import PAGE, machine, write_part

from rssnav.benchmark.page import as_markdown, words
from rssnav.benchmark.protocol import Extent
from rssnav.benchmark.submissions import read_scores


def tables(path: Path) -> str:
    """Tables of a file, and how much was flown."""
    written = json.loads(path.read_text())["extent"]
    extent = Extent(**{**written, "plans": tuple(written["plans"])})
    return f"Flown in: {words(extent)}\n\n{as_markdown(read_scores(path, extent))}"


def leaderboard(paths: list[Path]) -> str:
    """Part of the page."""
    parts = "\n".join(map(tables, paths))
    return f"## Leaderboard\n\n{parts}\nMeasured on: {machine()}."


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("results", type=Path, nargs="+")
    write_part("policies", leaderboard(parser.parse_args().results), PAGE.with_name("benchmark.md"))
