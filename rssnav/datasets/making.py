"""A spec in, a folder with a data set out; a run that was interrupted goes on where it was."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from atomicfiles import atomic_write
from rssnav.datasets.card import Contents, write_card
from rssnav.datasets.cost import DatasetCost, check_disk, estimated
from rssnav.datasets.engines.job import Engine, Job
from rssnav.datasets.folder import (
    CARD,
    FAILURES,
    JOURNAL,
    MANIFEST,
    TIMES,
    check_new,
    claim,
    locked,
)
from rssnav.datasets.journal import Journal
from rssnav.datasets.manifest import require_arrow, write_manifest, write_times
from rssnav.datasets.plans import PlanSource
from rssnav.datasets.spec import DatasetSpec
from rssnav.datasets.work import Summary, found_plan
from rssnav.progress import Progress

Notice = Callable[[str], None]


@dataclass(frozen=True)
class MadeDataset:
    """What a run has come to.

    Attributes
    ----------
    n_plans, n_maps
        Of the whole data set.
    n_traced
        Plans that this run has traced.
    n_failed
        Plans that could not be traced.
    """

    n_plans: int
    n_maps: int
    n_traced: int
    n_failed: int


@dataclass
class _Counts:
    """Progress of the maps of a run."""

    total: int
    done: int = 0


def estimate_dataset(spec: DatasetSpec, folder: Path) -> DatasetCost:
    """Estimate what is left to be made of a data set in a folder, which may not exist yet."""
    check_new(folder)
    journal = Journal(folder / JOURNAL)
    missing = [source for source in spec.plans if not _is_finished(source, spec, journal, folder)]
    return estimated(missing, spec.configuration) if missing else DatasetCost(0, 0, 0.0, 0.0, 0)


def make_dataset(
    spec: DatasetSpec,
    folder: Path,
    engine: Engine,
    *,
    notice: Notice,
    progress: Progress,
    retry: bool = False,
    force: bool = False,
) -> MadeDataset:
    """Make a data set, or what is missing of it.

    Parameters
    ----------
    spec, folder
        What is made, and where.
    engine
        Traces the plans.
    notice
        Called with sentences for the user.
    progress
        Called with the number of maps that are done, and of all maps of this run.
    retry
        Try plans again that could not be traced.
    force
        Replace what another spec has made in the folder.

    Raises
    ------
    DatasetError
        Where the folder is of something else or in use, the disk too small, or the engine gone.
    ImportError
        Without pyarrow; names the extra.
    """
    require_arrow()
    plans = spec.plans
    check_new(folder)
    with locked(folder):
        claim(folder, spec, force)
        journal = Journal(folder / JOURNAL)
        missing = _missing(spec, journal, folder, retry)
        if missing:
            _trace(missing, spec, folder, engine, journal, notice, progress)
        if missing or not (folder / CARD).is_file() or not (folder / MANIFEST).is_file():
            _remove_others(spec, folder)
            _describe(spec, folder, journal)
        else:
            notice(f"{folder} is up to date")
        entries = [journal.entries[source.name] for source in plans]
        n_maps = sum(len(journal[s.name].rows) for s in plans)
    n_failed = sum(entry.is_failed for entry in entries)
    return MadeDataset(len(plans), n_maps, len(missing), n_failed)


def _missing(spec: DatasetSpec, journal: Journal, folder: Path, retry: bool) -> list[PlanSource]:
    """Return the plans that are not finished; enter those whose files only the folder has."""
    missing: list[PlanSource] = []
    configuration_key = spec.configuration.key
    for source in spec.plans:
        if _is_finished(source, spec, journal, folder, retry):
            continue
        found = found_plan(source, source.key(configuration_key), folder)
        if found is None:
            missing.append(source)
        else:
            journal.append(found)
    return missing


def _is_finished(
    source: PlanSource, spec: DatasetSpec, journal: Journal, folder: Path, retry: bool = False
) -> bool:
    entry = journal.entries.get(source.name)
    if entry is None or entry.key != source.key(spec.configuration.key):
        return False
    if entry.is_failed:
        return entry.is_final and not retry
    path = folder / source.file
    return (
        path.is_file()
        and path.stat().st_size == entry.n_bytes
        and path.with_suffix(".toml").is_file()
    )


def _trace(
    missing: list[PlanSource],
    spec: DatasetSpec,
    folder: Path,
    engine: Engine,
    journal: Journal,
    notice: Notice,
    progress: Progress,
) -> None:
    """Trace the missing plans."""
    cost = estimated(missing, spec.configuration)
    check_disk(cost, folder)
    notice(cost.sentence(engine.n))
    (folder / CARD).unlink(missing_ok=True)
    counts = _Counts(max(cost.n_maps, 1))

    def traced(n: int) -> None:
        counts.done += n
        counts.total = max(counts.total, counts.done)
        if n:
            progress(counts.done, counts.total)

    def finished(summary: Summary) -> None:
        journal.append(summary)
        if summary.failure:
            notice(f"plan {summary.name!r} could not be traced: {summary.failure}")

    engine.run(Job(missing, spec.configuration, folder, finished, traced))


def _describe(spec: DatasetSpec, folder: Path, journal: Journal) -> None:
    """Write manifest, times, failures and, last, the card."""

    def traced() -> Iterator[tuple[PlanSource, Summary]]:
        for source in spec.plans:
            if not journal.entries[source.name].is_failed:
                yield source, journal[source.name]

    plans, maps = Counter[str](), Counter[str]()
    for source, summary in traced():
        plans[source.split] += 1
        maps[source.split] += len(summary.rows)
    sha256 = write_manifest((summary for _, summary in traced()), folder / MANIFEST)
    write_times((summary for _, summary in traced()), folder / TIMES)
    failures = {
        source.name: journal[source.name].failure
        for source in spec.plans
        if journal.entries[source.name].is_failed
    }
    if failures:
        with atomic_write(folder / FAILURES) as temporary:
            temporary.write_text(json.dumps(failures, indent=2) + "\n", encoding="utf-8")
    else:
        (folder / FAILURES).unlink(missing_ok=True)
    write_card(spec, Contents(plans, maps, len(failures), sha256), folder / CARD)


def _remove_others(spec: DatasetSpec, folder: Path) -> None:
    """Remove files of plans that the spec does not have, or has in another split."""
    wanted = {source.file for source in spec.plans}
    for split in sorted({source.split for source in spec.plans} | {"train", "validation", "test"}):
        for path in (folder / split).glob("*/*.h5"):
            if path.relative_to(folder).as_posix() not in wanted:
                path.unlink()
                path.with_suffix(".toml").unlink(missing_ok=True)
