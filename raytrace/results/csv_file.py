"""Tables as CSV files."""

import csv
import io
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from numpy.typing import NDArray

from atomicfiles import atomic_write


def write_csv(path: Path, columns: Mapping[str, NDArray[Any] | list[str]]) -> None:
    """Write columns of equal length under their names, whole or not at all."""
    text = io.StringIO(newline="")
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    lists = (values if isinstance(values, list) else values.tolist() for values in columns.values())
    writer.writerows(zip(*lists, strict=True))
    with atomic_write(path) as temporary:
        temporary.write_text(text.getvalue(), encoding="utf-8", newline="\n")
