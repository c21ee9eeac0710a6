"""The folder of a data set: whose it is, and that one run at a time writes into it."""

from __future__ import annotations

from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path

from atomicfiles import atomic_write, temporaries
from rssnav.datasets.errors import DatasetError
from rssnav.datasets.spec import DatasetSpec, read_spec
from rssnav.datasets.work import MARK

try:
    import fcntl
except ImportError:  # Windows: no locks, so two runs are not told apart
    fcntl = None

STATE = ".state"
CARD, MANIFEST, TIMES, FAILURES = "README.md", "manifest.parquet", "times.parquet", "failures.json"
JOURNAL = f"{STATE}/journal.jsonl"


@contextmanager
def locked(folder: Path) -> Generator[None]:
    """Keep other runs out of a folder; the lock ends with the process.

    Raises
    ------
    DatasetError
        Where another run writes into it.
    """
    state = folder / STATE
    state.mkdir(parents=True, exist_ok=True)
    with (state / "lock").open("ab") as file:
        if fcntl is not None:
            try:
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError as error:
                raise DatasetError(
                    "another run is writing into this folder: wait for its end, or give another",
                    folder,
                ) from error
            except OSError:  # a file system without locks
                pass
        yield


def check_new(folder: Path) -> None:
    """Raise DatasetError for a folder that holds something else than a data set."""
    if not folder.exists() or (folder / MARK).is_file():
        return
    ours = {folder / STATE, *temporaries(folder / MARK)}  # of a run that was killed at once
    others = [path.name for path in folder.iterdir() if path not in ours]
    if others:
        raise DatasetError(
            f"holds {others[0]!r} and is no data set: expected an empty or a new folder", folder
        )


def claim(folder: Path, spec: DatasetSpec, replace: bool) -> None:
    """Write the spec into a folder, or check that it is there already.

    Parameters
    ----------
    folder, spec
        The folder, and what is made in it.
    replace
        Whether another spec is replaced.

    Raises
    ------
    DatasetError
        Where another spec is there.
    """
    mark = folder / MARK
    if mark.is_file():
        if mark.read_text("utf-8") == spec.text:
            return
        if not replace:
            raise DatasetError(
                f"was made with another spec than {spec.path}: give another folder, or use --force "
                "to keep the plans whose maps would be the same, and replace the others",
                folder,
            )
        for name in (CARD, MANIFEST, TIMES, FAILURES):
            (folder / name).unlink(missing_ok=True)
    with atomic_write(mark) as temporary:
        temporary.write_text(spec.text, encoding="utf-8", newline="\n")


def spec_of(folder: Path) -> DatasetSpec:
    """Return the spec of a data set.

    Raises
    ------
    DatasetError
        Where the folder is none.
    """
    mark = folder / MARK
    if not mark.is_file():
        raise DatasetError(
            f"no data set: expected a folder with {MARK}, made by rssnav dataset make", folder
        )
    return read_spec(mark.read_text("utf-8"), mark)
