"""Searches kept in files beside the trainings, so that they are not flown again."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from atomicfiles import atomic_write
from raytrace.results.checked_hdf5 import LARGEST, Hdf5ContentError, open_checked
from raytrace.results.hdf5 import hdf5_bytes, write_array
from rssnav.discrete_states import Fluctuation
from rssnav.experiments.training_store import TrainingStore
from rssnav.searchers import Searcher, search
from rssnav.world import GridWorld

FORMAT, VERSION = "rssnav-search", 1

_ARRAYS: dict[str, tuple[str, str, type[np.generic]]] = {
    "found": ("1", "whether the flight ended at the source", np.bool_),
    "false_alarm": ("1", "whether a fluctuation of RSS ended it elsewhere", np.bool_),
    "steps": ("s", "time flown", np.int64),
    "length_m": ("m", "length flown", np.float64),
}
_WORLD_ARRAYS = (
    "next_state", "rss_dbm", "position", "cell", "distance_m", "step_length_m",
)  # fmt: skip


@dataclass(frozen=True, eq=False)
class SearchFigures:
    """What is kept of the flights of a searcher, R of them; see `rssnav.searchers.SearchResult`.

    Attributes
    ----------
    found, false_alarm : (R,) bool
        Whether a flight ended at the source, or elsewhere by a fluctuation of RSS.
    steps : (R,) int64
        Seconds flown.
    length_m : (R,) float64
        Length flown [m].
    """

    found: NDArray[np.bool_]
    false_alarm: NDArray[np.bool_]
    steps: NDArray[np.int64]
    length_m: NDArray[np.float64]


@dataclass(frozen=True)
class SearchRequest:
    """A search, by all that its flights depend on.

    Attributes
    ----------
    world : GridWorld
        Where it flies.
    searcher : RandomWalk, RssAscent or ParticleFilter
        Rule that it flies by.
    fluctuation : Fluctuation
        How its RSS readings differ from the map.
    runs, seed : int
        Number of flights, and seed of their random streams.
    """

    world: GridWorld
    searcher: Searcher
    fluctuation: Fluctuation
    runs: int
    seed: int

    def key(self) -> str:
        """Return a text that differs for every other search."""
        world = hashlib.sha256()
        for name in _WORLD_ARRAYS:
            array = np.ascontiguousarray(getattr(self.world, name))
            world.update(f"{name} {array.dtype} {array.shape} ".encode() + array.tobytes())
        parts = (
            self.searcher, self.fluctuation, self.runs, self.seed, self.world.start_state,
            self.world.speed, self.world.source, self.world.plan_sha256, world.hexdigest(),
        )  # fmt: skip
        return "; ".join(map(repr, parts))

    def fly(self, threads: int | None) -> SearchFigures:
        """Fly the search."""
        result = search(
            self.world,
            self.searcher,
            runs=self.runs,
            seed=self.seed,
            fluctuation=self.fluctuation,
            threads=threads,
        )
        return SearchFigures(result.found, result.false_alarm, result.steps, result.length_m)


def fly_or_reuse(request: SearchRequest, store: TrainingStore) -> SearchFigures:
    """Return a search: the kept one if it is the same, otherwise flown and kept.

    Parameters
    ----------
    request : SearchRequest
        The search.
    store : TrainingStore
        Its folder, number of threads, and whether what is kept is reused.

    Raises
    ------
    OSError
        Where the file cannot be written.
    """
    world, sigma_db = request.world, request.fluctuation.sigma_db
    name = f"{world.plan_name} search {world.speed}mps {request.searcher.name} {sigma_db:g}dB"
    path, key = store.folder / store.file_name(name), request.key()
    if store.resume and path.exists():
        try:
            return _kept(path, request, key)
        except Hdf5ContentError as error:
            store.notice(f"{path} cannot be used ({error}); searching again")
    figures = request.fly(store.threads)
    content = hdf5_bytes(lambda file: _write(file, figures, key))
    with atomic_write(path) as temporary:
        temporary.write_bytes(content)
    return figures


def _write(file: h5py.File, figures: SearchFigures, key: str) -> None:
    file.attrs.update({"format": FORMAT, "version": VERSION, "key": key})
    for name, (units, long_name, _) in _ARRAYS.items():
        write_array(file, name, getattr(figures, name), units, long_name)


def read_search(path: Path) -> tuple[str, SearchFigures]:
    """Read a kept search and its key; raise `Hdf5ContentError` where it is damaged."""
    with open_checked(path) as file:
        if file.text("format") != FORMAT or file.integer("version") != VERSION:
            raise Hdf5ContentError(f"expected format {FORMAT!r}, version {VERSION}")
        arrays: dict[str, Any] = {
            name: file.array(name, dtype, ("runs",), low=0, high=LARGEST)
            for name, (_, _, dtype) in _ARRAYS.items()
        }
        key = file.text("key")
    figures = SearchFigures(**arrays)
    if (figures.found & figures.false_alarm).any():
        raise Hdf5ContentError("a flight that ended both at the source and elsewhere")
    return key, figures


def _kept(path: Path, request: SearchRequest, key: str) -> SearchFigures:
    """Read a search that is known to be the one requested; otherwise raise `Hdf5ContentError`."""
    found, figures = read_search(path)
    if found != key:
        raise Hdf5ContentError("it was flown with other parameters or in another world")
    if len(figures.steps) != request.runs:
        raise Hdf5ContentError(f"{len(figures.steps)} flights: expected {request.runs}")
    return figures
