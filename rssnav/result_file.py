"""TrainingResult <-> HDF5.

One dataset an array of the result and of its world, the parameters as attributes of the groups
``agent``, ``learning`` and ``schedule``, so that a file is readable without this project. It is
written beside its place and then renamed: a killed run leaves the old file or none.
"""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from atomicfiles import atomic_write
from raytrace.results.hdf5 import hdf5_bytes
from rssnav.agents import Agent, LocationAgent, QLearning, RssAgent
from rssnav.results import Schedule, TrainingResult
from rssnav.states import ExactStates, Fluctuation, IntervalStates, StateRule, ToleranceStates
from rssnav.world import GridWorld

FORMAT = "rssnav-training"
VERSION = 1

# units and long name of each array
_RESULT_ARRAYS = {
    "run_ids": ("1", "number of the realisation"),
    "steps": ("1", "steps of each episode, -1 after the last"),
    "diagonal_steps": ("1", "diagonal steps of each episode, -1 after the last"),
    "truncated": ("1", "whether each episode was cut at max_steps"),
    "episodes_flown": ("1", "episodes of the run"),
    "visit_counts": ("1", "visits of each state up to each snapshot episode, all runs"),
    "converged_episode": ("1", "episodes flown at convergence, -1 without"),
    "converged_steps": ("1", "steps flown at convergence, -1 without"),
    "converged_cpu_s": ("s", "CPU time up to convergence"),
    "cpu_s": ("s", "CPU time of the run"),
    "trajectories": ("1", "states of the final greedy flight, -1 after the last"),
    "reached": ("1", "whether the final flight reaches the source"),
    "path_steps": ("1", "steps of the final flight"),
    "path_length_m": ("m", "length of the final flight"),
    "n_labels": ("1", "states the agent told apart"),
}
_WORLD_ARRAYS = {
    "next_state": ("1", "state after each action, -1 where it is impossible"),
    "rss_dbm": ("dBm", "power-sum RSS"),
    "position": ("m", "cell centre (x, y)"),
    "cell": ("1", "indices (i_y, i_x) in the radio map"),
    "distance_m": ("m", "horizontal distance to the source"),
    "step_length_m": ("m", "length of each action's step"),
}
_Q_ARRAY = {"q": ("1", "final Q of each cell and action, -inf where it is impossible")}
_WORLD_SCALARS = ("start_state", "speed", "shape", "source", "plan_name", "plan_sha256")


class ResultFileError(ValueError):
    """A file is no training result of this format and version, or is damaged."""


def save_result(result: TrainingResult, path: str | Path) -> None:
    """Write a result to an HDF5 file, replacing it only once it is complete."""
    content = hdf5_bytes(lambda file: _write(result, file))
    with atomic_write(path) as temporary:
        temporary.write_bytes(content)


def _write(result: TrainingResult, file: h5py.File) -> None:
    file.attrs["format"], file.attrs["version"] = FORMAT, VERSION
    _write_parameters(file, result)
    world = file.create_group("world")
    _write_arrays(world, result.world, _WORLD_ARRAYS)
    for name in _WORLD_SCALARS:
        world.attrs[name] = getattr(result.world, name)
    _write_arrays(file, result, _RESULT_ARRAYS)
    if result.q is not None:
        _write_arrays(file, result, _Q_ARRAY)


def load_result(path: str | Path) -> TrainingResult:
    """Read a result.

    Raises
    ------
    FileNotFoundError
        When there is no such file.
    ResultFileError
        When the file is damaged, of another format, or of another version.
    """
    path = Path(path)
    if not path.is_file():
        raise FileNotFoundError(f"{path}: no such training result")
    try:
        with h5py.File(path, "r") as file:
            _check_format(path, file)
            return _read(file)
    except ResultFileError:
        raise
    except (OSError, KeyError, TypeError, ValueError) as error:
        raise ResultFileError(
            f"{path}: not a readable training result ({error}); train again to replace it"
        ) from error


def _check_format(path: Path, file: h5py.File) -> None:
    found = file.attrs.get("format")
    if found != FORMAT:
        raise ResultFileError(
            f"{path}: format is {found!r}, a training result has {FORMAT!r}; is this another "
            "kind of file?"
        )
    version = _attributes(file)["version"]
    if version != VERSION:
        raise ResultFileError(
            f"{path}: version {version} of the format, this program reads {VERSION}; train again"
        )


def _write_arrays(group: h5py.Group, owner: object, names: dict[str, tuple[str, str]]) -> None:
    for name, (units, long_name) in names.items():
        array: NDArray[Any] = getattr(owner, name)
        compression = "gzip" if array.size else None  # an empty dataset cannot be chunked
        dataset = group.create_dataset(name, data=array, compression=compression)
        dataset.attrs["units"], dataset.attrs["long_name"] = units, long_name


def _write_parameters(file: h5py.File, result: TrainingResult) -> None:
    for name, values in (
        ("agent", agent_parameters(result.agent)),
        ("learning", dataclasses.asdict(result.learning)),
        ("schedule", dataclasses.asdict(result.schedule)),
    ):
        group = file.create_group(name)
        for key, value in values.items():
            group.attrs[key] = value


def _read(file: h5py.File) -> TrainingResult:
    arrays: dict[str, Any] = {name: _array(file, name) for name in _RESULT_ARRAYS}
    return TrainingResult(
        world=_read_world(_group(file, "world")),
        agent=agent_from_parameters(_attributes(_group(file, "agent"))),
        learning=QLearning(**_attributes(_group(file, "learning"))),
        schedule=_read_schedule(_attributes(_group(file, "schedule"))),
        q=_array(file, "q") if "q" in file else None,
        **arrays,
    )


def _read_world(group: h5py.Group) -> GridWorld:
    values: dict[str, Any] = {name: _array(group, name) for name in _WORLD_ARRAYS}
    scalars = _attributes(group)
    scalars["shape"] = tuple(int(n) for n in scalars["shape"])
    scalars["source"] = tuple(float(x) for x in scalars["source"])
    return GridWorld(**values, **scalars)


def _read_schedule(values: dict[str, Any]) -> Schedule:
    values["snapshot_episodes"] = tuple(int(k) for k in values["snapshot_episodes"])
    return Schedule(**values)


def _array(group: h5py.Group, name: str) -> NDArray[Any]:
    dataset = group[name]
    if not isinstance(dataset, h5py.Dataset):
        raise TypeError(f"{name} is no dataset")
    return dataset[()]


def _group(file: h5py.File, name: str) -> h5py.Group:
    group = file[name]
    if not isinstance(group, h5py.Group):
        raise TypeError(f"{name} is no group")
    return group


def _attributes(group: h5py.Group) -> dict[str, Any]:
    """Attributes as plain Python values; arrays stay arrays."""
    return {
        str(key): value.item() if isinstance(value, np.generic) else value
        for key, value in group.attrs.items()
    }


def agent_parameters(agent: Agent) -> dict[str, Any]:
    """An agent as a flat table of parameters."""
    if isinstance(agent, LocationAgent):
        return {"kind": agent.name, "terminal_distance_m": agent.terminal_distance_m}
    if not isinstance(agent, RssAgent):
        raise ResultFileError(
            f"agent {agent.name!r}: only the trainings of RssAgent and LocationAgent can be kept "
            "in a file; keep the arrays of yours, such as steps and trajectories, with numpy.savez"
        )
    return {
        "kind": agent.name,
        "terminal_dbm": agent.terminal_dbm,
        **_state_parameters(agent.states),
        **dataclasses.asdict(agent.fluctuation),
    }


def _state_parameters(states: StateRule) -> dict[str, Any]:
    if isinstance(states, ToleranceStates):
        return {"states": "tolerance", "threshold_db": states.threshold_db}
    if isinstance(states, IntervalStates):
        return {"states": "intervals", "edges_dbm": np.array(states.edges_dbm)}
    return {"states": "exact"}


def agent_from_parameters(values: dict[str, Any]) -> Agent:
    """Agent that :func:`agent_parameters` came from."""
    if values["kind"] == "location":
        return LocationAgent(values["terminal_distance_m"])
    if values["kind"] != "rss":
        raise ValueError(f"kind: {values['kind']!r} is no known agent; 'rss' and 'location' are")
    states: StateRule = ExactStates()
    if values["states"] == "tolerance":
        states = ToleranceStates(values["threshold_db"])
    elif values["states"] == "intervals":
        states = IntervalStates(tuple(float(edge) for edge in values["edges_dbm"]))
    fluctuation = Fluctuation(values["sigma_db"], values["correlation"])
    return RssAgent(states, values["terminal_dbm"], fluctuation)
