"""Write the leaderboard of docs/benchmark.md from a results.json of ``rssnav benchmark``.

    python tests/benchmarks/leaderboard.py results/benchmark/results.json

Results of others are merged before: ``rssnav benchmark --with FILE``.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path

from performance_page import PAGE, machine, write_part

from rssnav.benchmark.page import as_markdown, words
from rssnav.benchmark.protocol import Extent
from rssnav.benchmark.submissions import read_scores


def leaderboard(path: Path) -> str:
    """Part of the page."""
    written = json.loads(path.read_text())["extent"]
    extent = Extent(**{**written, "plans": tuple(written["plans"])})
    return (
        f"## Leaderboard\n\n{words(extent)}\n\n{as_markdown(read_scores(path, extent))}\n"
        f"Measured on: {machine()}."
    )


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("results", type=Path)
    write_part("policies", leaderboard(parser.parse_args().results), PAGE.with_name("benchmark.md"))
