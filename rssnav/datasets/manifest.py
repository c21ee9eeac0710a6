"""The manifest: a row for each map, in Parquet; and what the maps took, beside it."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

from atomicfiles import atomic_write
from raytrace.extras import needs_extra
from rssnav.datasets.errors import DatasetError
from rssnav.datasets.work import Summary

ROWS_A_GROUP = 20_000

_TEXT, _INT, _FLOAT = "string", "int64", "float64"
COLUMNS = {
    "map": _TEXT, "plan": _TEXT, "split": _TEXT, "building": _TEXT, "kind": _TEXT, "seed": _INT,
    "file": _TEXT, "preset": _TEXT, "height_m": _FLOAT, "antenna": _TEXT, "frequency_hz": _FLOAT,
    "transmitter": _TEXT, "transmitter_x": _FLOAT, "transmitter_y": _FLOAT,
    "transmitter_z": _FLOAT, "power_dbm": _FLOAT, "index_preset": _INT, "index_height": _INT,
    "index_antenna": _INT, "index_frequency": _INT, "index_transmitter": _INT, "n_y": _INT,
    "n_x": _INT, "cells_inside": _INT, "rss_dbm_min": _FLOAT, "rss_dbm_max": _FLOAT,
    "sha256": _TEXT, "file_sha256": _TEXT, "plan_sha256": _TEXT, "key": _TEXT,
    "tracer_version": _INT, "rssnav_version": _TEXT,
}  # fmt: skip
"""Columns and their types."""


def require_arrow() -> None:
    """Import what Parquet files need; raise ImportError that names the extra."""
    with needs_extra("dataset"):
        import pyarrow.parquet as _  # noqa: F401


def write_manifest(summaries: Iterable[Summary], path: Path) -> str:
    """Write the manifest; return a hash of all maps.

    It is the hash of the names and hashes of all maps in their order, so it depends on their values
    and not on how Parquet stores them.
    """
    found = hashlib.sha256()

    def rows() -> Iterator[dict[str, Any]]:
        for summary in summaries:
            for row in summary.rows:
                found.update(f"{row['map']} {row['sha256']}\n".encode())
                yield {**row, "file_sha256": summary.sha256}

    _write_rows(rows(), COLUMNS, path)
    return found.hexdigest()


def write_times(summaries: Iterable[Summary], path: Path) -> None:
    """Write the wall time of each map whose time is known."""
    rows = (
        {"map": row["map"], "wall_time_s": seconds}
        for summary in summaries
        for row, seconds in zip(summary.rows, summary.seconds, strict=False)
    )
    _write_rows(rows, {"map": _TEXT, "wall_time_s": _FLOAT}, path)


def _write_rows(rows: Iterable[dict[str, Any]], columns: dict[str, str], path: Path) -> None:
    """Write rows in groups, so that few of them are in memory."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    types = {_TEXT: pa.string(), _INT: pa.int64(), _FLOAT: pa.float64()}
    schema = pa.schema([(name, types[kind]) for name, kind in columns.items()])
    with (
        atomic_write(path) as temporary,
        pq.ParquetWriter(str(temporary), schema, compression="zstd") as writer,
    ):
        group: list[dict[str, Any]] = []
        for row in rows:
            group.append(row)
            if len(group) == ROWS_A_GROUP:
                writer.write_table(pa.Table.from_pylist(group, schema))
                group = []
        writer.write_table(pa.Table.from_pylist(group, schema))


def read_manifest(path: Path, columns: list[str] | None = None) -> Any:
    """Return the manifest as a `pyarrow.Table`, or some of its columns.

    Raises
    ------
    DatasetError
        Where it is missing, or none.
    ImportError
        Without pyarrow; names the extra.
    """
    with needs_extra("dataset"):
        import pyarrow as pa
        import pyarrow.parquet as pq

    if not path.is_file():
        raise DatasetError("missing: the data set is not complete; make it again to go on", path)
    try:
        with pq.ParquetFile(str(path)) as file:
            found = file.read()
    except (pa.ArrowException, OSError, ValueError) as error:
        raise DatasetError(
            f"damaged ({error}); make the data set again to replace it", path
        ) from error
    if missing := [name for name in COLUMNS if name not in found.column_names]:
        raise DatasetError(f"has no column {missing[0]!r}: expected a manifest", path)
    return found if columns is None else found.select(columns)
