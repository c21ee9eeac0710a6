"""What is finished: a line for each plan, appended as it is done, so that a run can resume.

The journal only saves time: a plan that it does not know is looked for in the folder.
"""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

from rssnav.datasets.work import Summary


@dataclass(frozen=True)
class Entry:
    """Where the line of a plan is, and what must agree for it to hold.

    Attributes
    ----------
    offset
        Of the line in the file [bytes].
    key, n_bytes, is_failed, is_final
        As of `Summary`.
    """

    offset: int
    key: str
    n_bytes: int
    is_failed: bool
    is_final: bool


class Journal:
    """The finished plans of a folder, by name; later lines replace earlier ones.

    Attributes
    ----------
    path
        The file.
    entries
        By the name of the plan.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.entries: dict[str, Entry] = {}
        if path.exists():
            self._read()

    def _read(self) -> None:
        """Index the lines; one that is not whole was being written when its writer was killed."""
        offset = 0
        with self.path.open("rb") as file:
            for line in file:
                summary = Summary.from_json(line.decode("utf-8", "replace"))
                if summary is not None:
                    self._enter(summary, offset)
                offset += len(line)

    def _enter(self, summary: Summary, offset: int) -> None:
        self.entries[summary.name] = Entry(
            offset, summary.key, summary.n_bytes, bool(summary.failure), summary.is_final
        )

    def append(self, summary: Summary) -> None:
        """Add a plan, after a line that was not ended if there is one."""
        line = f"{summary.to_json()}\n".encode()
        self.path.parent.mkdir(parents=True, exist_ok=True)
        with self.path.open("ab+") as file:
            end = file.seek(0, os.SEEK_END)
            if end:
                file.seek(end - 1)
                if file.read(1) != b"\n":
                    line = b"\n" + line
            file.write(line)
        self._enter(summary, end + line.startswith(b"\n"))

    def __getitem__(self, name: str) -> Summary:
        """Return the summary of a plan."""
        with self.path.open("rb") as file:
            file.seek(self.entries[name].offset)
            summary = Summary.from_json(file.readline().decode("utf-8", "replace"))
        assert summary is not None, "a line that was whole"
        return summary
