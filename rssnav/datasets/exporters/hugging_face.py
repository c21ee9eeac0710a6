"""Parquet files of samples, as catalogues such as Hugging Face list them.

``data/SPLIT-NNNNN.parquet`` has a row for each map: the columns of the manifest, the cell centres,
``inside`` and the layers as lists, row by row of the grid. The data card names the files.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from raytrace.extras import needs_extra
from rssnav.datasets.exporters.pieces import PlanPiece, index_of, new_folder, plan_pieces
from rssnav.datasets.folder import CARD
from rssnav.datasets.split import SPLITS
from rssnav.progress import Progress

PLANS_A_FILE = 50


def export_hugging_face(folder: Path, out: Path, n_plans: int, progress: Progress) -> None:
    """Write a data set as Parquet files of samples; parameters as of `export_challenge`."""
    with needs_extra("dataset"):
        import pyarrow as pa
        import pyarrow.parquet as pq

    with new_folder(out) as new:
        (new / "data").mkdir()
        waiting: dict[str, list[PlanPiece]] = {split: [] for split in SPLITS}
        n_files: dict[str, int] = dict.fromkeys(SPLITS, 0)

        def write(split: str) -> None:
            rows = [row for piece in waiting[split] for row in samples(piece)]
            path = new / "data" / f"{split}-{n_files[split]:05d}.parquet"
            pq.write_table(pa.Table.from_pylist(rows), path, compression="zstd")
            n_files[split] += 1
            waiting[split].clear()

        for piece in plan_pieces(folder):
            split = piece.about.split
            waiting[split].append(piece)
            if len(waiting[split]) == PLANS_A_FILE:
                write(split)
            progress(piece.number + 1, n_plans)
        for split in SPLITS:
            if waiting[split]:
                write(split)
        card = (folder / CARD).read_text("utf-8")
        _, header, body = card.split("---\n", 2)
        (new / CARD).write_text(f"---\n{header}{_configs(n_files)}---\n{body}", "utf-8")


def samples(piece: PlanPiece) -> list[dict[str, Any]]:
    """Return a row for each map of a plan."""
    maps = piece.maps
    found: list[dict[str, Any]] = []
    for row in piece.rows:
        index = index_of(row)
        layers = {name: values[index].ravel() for name, values in maps.layers.items()}
        inside = maps.inside[index.height].ravel()
        found.append({**row, "x": maps.x, "y": maps.y, "inside": inside, **layers})
    return found


def _configs(n_files: dict[str, int]) -> str:
    """Return the lines of the card's header that name the files of each split."""
    lines = ["configs:", "- config_name: default", "  data_files:"]
    for split, count in n_files.items():
        if count:
            lines += [f"  - split: {split}", f"    path: data/{split}-*.parquet"]
    return "\n".join(lines) + "\n"
