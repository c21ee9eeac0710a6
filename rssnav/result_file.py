"""TrainingResult <-> HDF5.

One dataset per array of the result and of its world; the parameters are attributes of the groups
``agent``, ``learning`` and ``schedule``, so a file is readable without this project. It is written
to a temporary file and then renamed: a killed run leaves the old file or none.

Version 2 stores agents of any class and the table ``cell_of_state``; files of version 1 are read.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Protocol

import h5py
import numpy as np
from numpy.typing import NDArray

from atomicfiles import atomic_write
from raytrace.results.hdf5 import hdf5_bytes
from rssnav.agent_description import AgentDescription, describe, restore
from rssnav.agents import Agent, LocationAgent, RssAgent
from rssnav.discrete_states import (
    ExactStates,
    Fluctuation,
    IntervalStates,
    StateRule,
    ToleranceStates,
)
from rssnav.learning_parameters import QLearning
from rssnav.schedule import Schedule
from rssnav.world import GridWorld

FORMAT = "rssnav-training"
VERSION = 2
_VERSIONS = (1, VERSION)

# units and long name of each array
_RESULT_ARRAYS = {
    "run_ids": ("1", "number of the realisation"),
    "steps": ("1", "steps of each episode, -1 after the last"),
    "diagonal_steps": ("1", "diagonal steps of each episode, -1 after the last"),
    "truncated": ("1", "whether each episode was truncated at max_steps"),
    "episodes_flown": ("1", "episodes of the run"),
    "cell_of_state": ("1", "cell of each state of the decision process"),
    "visit_counts": ("1", "visits of each cell up to each snapshot episode, all runs"),
    "converged_episode": ("1", "episodes flown at convergence, -1 without"),
    "converged_steps": ("1", "steps flown at convergence, -1 without"),
    "converged_cpu_s": ("s", "CPU time up to convergence"),
    "cpu_s": ("s", "CPU time of the run"),
    "trajectories": ("1", "cells of the final greedy flight, -1 after the last"),
    "reached": ("1", "whether the final flight reaches the transmitter"),
    "path_steps": ("1", "steps of the final flight"),
    "path_length_m": ("m", "length of the final flight"),
    "n_discrete_states": ("1", "discrete states that the agent distinguished"),
}
_DATASET_NAMES = {"n_discrete_states": "n_labels"}  # where it differs from the attribute
_WORLD_ARRAYS = {
    "next_state": ("1", "state after each action, -1 where it is impossible"),
    "rss_dbm": ("dBm", "power-sum RSS"),
    "position": ("m", "cell centre (x, y)"),
    "cell": ("1", "indices (i_y, i_x) in the radio map"),
    "distance_m": ("m", "horizontal distance to the transmitter"),
    "step_length_m": ("m", "length of each action's step"),
}
_Q_ARRAY = {"q": ("1", "final Q of each state and action, -inf where it is impossible")}
_WORLD_SCALARS = ("start_state", "speed", "shape", "source", "plan_name", "plan_sha256")


class ResultContents(Protocol):
    """What a file stores of a `TrainingResult`, besides its arrays of the same names."""

    @property
    def world(self) -> GridWorld:
        """World of the training."""
        ...

    @property
    def agent(self) -> Agent:
        """Agent that was trained."""
        ...

    @property
    def learning(self) -> QLearning:
        """Learning parameters."""
        ...

    @property
    def schedule(self) -> Schedule:
        """Length and seed."""
        ...

    @property
    def q(self) -> NDArray[np.float64] | None:
        """Final Q, or None."""
        ...


class ResultFileError(ValueError):
    """A file is not a training result of this format and version, or it is damaged."""


def write_result_file(result: ResultContents, path: Path) -> None:
    """Write a result to an HDF5 file, replacing it only once it is complete.

    Raises
    ------
    TypeError
        When the agent is not a dataclass, or a field of it cannot be stored.
    """
    agent = describe(result.agent)
    content = hdf5_bytes(lambda file: _write(result, agent, file))
    with atomic_write(path) as temporary:
        temporary.write_bytes(content)


def _write(result: ResultContents, agent: AgentDescription, file: h5py.File) -> None:
    file.attrs["format"], file.attrs["version"] = FORMAT, VERSION
    file.attrs["agent"] = agent.name
    _write_agent(file.create_group("agent"), agent)
    for name in ("learning", "schedule"):
        parameters = dataclasses.asdict(getattr(result, name))
        file.create_group(name).attrs.update(parameters)
    world = file.create_group("world")
    _write_arrays(world, result.world, _WORLD_ARRAYS)
    for name in _WORLD_SCALARS:
        world.attrs[name] = getattr(result.world, name)
    _write_arrays(file, result, _RESULT_ARRAYS)
    if result.q is not None:
        _write_arrays(file, result, _Q_ARRAY)


def read_result_file(path: Path, agents: Sequence[type] = ()) -> dict[str, Any]:
    """Read the fields of a :class:`~rssnav.TrainingResult` by name; see its ``load``."""
    if not path.is_file():
        raise FileNotFoundError(f"{path}: no such training result")
    try:
        with h5py.File(path, "r") as file:
            _check_format(path, file)
            return _read(file, agents)
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
    if version not in _VERSIONS:
        raise ResultFileError(
            f"{path}: version {version} of the format, this program reads "
            f"{' and '.join(map(str, _VERSIONS))}; train again"
        )


def _write_arrays(group: h5py.Group, owner: object, names: dict[str, tuple[str, str]]) -> None:
    for name, (units, long_name) in names.items():
        array: NDArray[Any] = getattr(owner, name)
        compression = "gzip" if array.size else None  # an empty dataset cannot be chunked
        stored = _DATASET_NAMES.get(name, name)
        dataset = group.create_dataset(stored, data=array, compression=compression)
        dataset.attrs["units"], dataset.attrs["long_name"] = units, long_name


def _write_agent(group: h5py.Group, agent: AgentDescription) -> None:
    """Write the class as an attribute, scalars as attributes, tuples and arrays as datasets."""
    group.attrs["class"] = agent.class_path
    for name, value in agent.parameters.items():
        if isinstance(value, AgentDescription):
            _write_agent(group.create_group(name), value)
        elif isinstance(value, tuple | np.ndarray):
            dataset = group.create_dataset(name, data=value)
            dataset.attrs["type"] = "tuple" if isinstance(value, tuple) else "array"
        else:
            group.attrs[name] = h5py.Empty("f8") if value is None else value


def _read_agent(group: h5py.Group, name: str = "") -> AgentDescription:
    values = _attributes(group)
    class_path = str(values.pop("class"))
    for key, item in group.items():
        values[key] = _read_agent(item) if isinstance(item, h5py.Group) else _read_sequence(item)
    parameters = {k: None if isinstance(v, h5py.Empty) else v for k, v in values.items()}
    return AgentDescription(class_path, name, parameters)


def _read_sequence(dataset: h5py.Dataset) -> NDArray[Any] | tuple[Any, ...]:
    text = h5py.check_string_dtype(dataset.dtype) is not None
    values: NDArray[Any] = np.asarray(dataset.asstr()[()] if text else dataset[()])
    return tuple(values.tolist()) if dataset.attrs["type"] == "tuple" else values


def _read(file: h5py.File, agents: Sequence[type]) -> dict[str, Any]:
    world = _read_world(_group(file, "world"))
    arrays: dict[str, Any] = {
        name: _array(file, _DATASET_NAMES.get(name, name))
        for name in _RESULT_ARRAYS
        if name != "cell_of_state"
    }
    if file.attrs["version"] == 1:
        agent = _agent_of_version_1(_attributes(_group(file, "agent")))
        arrays["cell_of_state"] = np.arange(world.n_states, dtype=np.int32)
    else:
        agent = restore(_read_agent(_group(file, "agent"), str(file.attrs["agent"])), agents)
        arrays["cell_of_state"] = _array(file, "cell_of_state")
    return {
        "world": world,
        "agent": agent,
        "learning": QLearning(**_attributes(_group(file, "learning"))),
        "schedule": _read_schedule(_attributes(_group(file, "schedule"))),
        "q": _array(file, "q") if "q" in file else None,
        **arrays,
    }


def _agent_of_version_1(values: dict[str, Any]) -> Agent:
    """Agent of a file of version 1, which stored its parameters in one flat table."""
    if values["kind"] == "location":
        return LocationAgent(values["terminal_distance_m"])
    if values["kind"] != "rss":
        raise ValueError(f"kind: {values['kind']!r} must be 'rss' or 'location'")
    states: StateRule = ExactStates()
    if values["states"] == "tolerance":
        states = ToleranceStates(values["threshold_db"])
    elif values["states"] == "intervals":
        states = IntervalStates(tuple(float(edge) for edge in values["edges_dbm"]))
    fluctuation = Fluctuation(values["sigma_db"], values["correlation"])
    return RssAgent(states, values["terminal_dbm"], fluctuation)


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
        raise TypeError(f"{name} is not a dataset")
    return dataset[()]


def _group(file: h5py.File, name: str) -> h5py.Group:
    group = file[name]
    if not isinstance(group, h5py.Group):
        raise TypeError(f"{name} is not a group")
    return group


def _attributes(group: h5py.Group) -> dict[str, Any]:
    """Attributes as plain Python values; arrays stay arrays."""
    return {
        str(key): value.item() if isinstance(value, np.generic) else value
        for key, value in group.attrs.items()
    }
