"""TrainingResult <-> HDF5.

One dataset per array of the result and of its world; the parameters are attributes of the groups
``agent``, ``learning`` and ``schedule``, so a file is readable without this project. It is written
to a temporary file and then renamed: a killed run leaves the old file or none.

Version 2 stores agents of any class and the table ``cell_of_state``; files of version 1 are read.
Nothing that a file says is believed before it is checked, and no class that it names is imported.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple, Protocol, TypeVar

import h5py
import numpy as np
from numpy.typing import NDArray

from atomicfiles import atomic_write
from raytrace.results.checked_hdf5 import (
    LARGEST,
    Checked,
    Hdf5ContentError,
    Shape,
    open_checked,
)
from raytrace.results.hdf5 import hdf5_bytes, write_array
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
from rssnav.result_checks import check_result, check_world
from rssnav.schedule import Schedule
from rssnav.world import GridWorld

FORMAT = "rssnav-training"
VERSION = 2
_VERSIONS = (1, VERSION)

_MAX_GROUPS = 50  # of an agent

ParametersT = TypeVar("ParametersT")


class _Array(NamedTuple):
    """What is stored of an array, and what a file may hold."""

    units: str
    long_name: str
    dtype: type[np.generic]
    shape: Shape
    low: float = -1
    high: float = np.inf


_RUN = ("R",)
_EPISODES = ("R", "E")
_RESULT_ARRAYS = {
    "run_ids": _Array("1", "number of the realisation", np.int64, _RUN, 0),
    "steps": _Array("1", "steps of each episode, -1 after the last", np.int32, _EPISODES),
    "diagonal_steps": _Array(
        "1", "diagonal steps of each episode, -1 after the last", np.int32, _EPISODES
    ),
    "truncated": _Array(
        "1", "whether each episode was truncated at max_steps", np.bool_, _EPISODES
    ),
    "episodes_flown": _Array("1", "episodes of the run", np.int64, _RUN, 1),
    "cell_of_state": _Array("1", "cell of each state of the decision process", np.int32, ("S",), 0),
    "visit_counts": _Array(
        "1", "visits of each cell up to each snapshot episode, all runs", np.int64, ("K", "C"), 0
    ),
    "converged_episode": _Array("1", "episodes flown at convergence, -1 without", np.int64, _RUN),
    "converged_steps": _Array("1", "steps flown at convergence, -1 without", np.int64, _RUN),
    "converged_cpu_s": _Array("s", "CPU time up to convergence", np.float64, _RUN, 0, LARGEST),
    "cpu_s": _Array("s", "CPU time of the run", np.float64, _RUN, 0, LARGEST),
    "trajectories": _Array(
        "1", "cells of the final greedy flight, -1 after the last", np.int32, ("R", "T")
    ),
    "reached": _Array("1", "whether the final flight reaches the transmitter", np.bool_, _RUN),
    "path_steps": _Array("1", "steps of the final flight", np.int64, _RUN, 0),
    "path_length_m": _Array("m", "length of the final flight", np.float64, _RUN, 0, LARGEST),
    "n_discrete_states": _Array(
        "1", "discrete states that the agent distinguished", np.int64, _RUN, 0
    ),
}
_DATASET_NAMES = {"n_discrete_states": "n_labels"}  # where it differs from the attribute
_WORLD_ARRAYS = {
    "next_state": _Array(
        "1", "state after each action, -1 where it is impossible", np.int32, ("C", 8)
    ),
    "rss_dbm": _Array("dBm", "power-sum RSS", np.float64, ("C",), -np.inf, LARGEST),
    "position": _Array("m", "cell centre (x, y)", np.float64, ("C", 2), -LARGEST, LARGEST),
    "cell": _Array("1", "indices (i_y, i_x) in the radio map", np.int32, ("C", 2), 0),
    "distance_m": _Array(
        "m", "horizontal distance to the transmitter", np.float64, ("C",), 0, LARGEST
    ),
    "step_length_m": _Array("m", "length of each action's step", np.float64, (8,), 0, LARGEST),
}
_Q_ARRAY = {
    "q": _Array(
        "1",
        "final Q of each state and action, -inf where it is impossible",
        np.float64,
        ("R", "S", 8),
        -np.inf,
        LARGEST,
    )
}
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


def _write_arrays(group: h5py.Group, owner: object, arrays: Mapping[str, _Array]) -> None:
    for name, info in arrays.items():
        array: NDArray[Any] = getattr(owner, name)
        write_array(group, _DATASET_NAMES.get(name, name), array, info.units, info.long_name)


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


def read_result_file(path: Path, agents: Sequence[type] = ()) -> dict[str, Any]:
    """Read the fields of a :class:`~rssnav.TrainingResult` by name; see its ``load``."""
    if not path.is_file():
        raise FileNotFoundError(f"{path}: no such training result")
    try:
        with open_checked(path) as file:
            problem = _format_problem(file)
            if problem is None:
                return _read(file, agents)
    except Hdf5ContentError as error:
        raise ResultFileError(
            f"{path}: not a readable training result ({error}); train again to replace it"
        ) from error
    raise ResultFileError(f"{path}: {problem}")


def _format_problem(file: Checked) -> str | None:
    found = file.attribute("format") if "format" in file.attribute_names else None
    if not isinstance(found, str) or found != FORMAT:
        return (
            f"format is {found!r}, a training result has {FORMAT!r}; is this another kind of file?"
        )
    version = file.attribute("version")
    if not isinstance(version, int) or version not in _VERSIONS:
        return (
            f"version {version!r} of the format, this program reads "
            f"{' and '.join(map(str, _VERSIONS))}; train again"
        )
    return None


def _read(file: Checked, agents: Sequence[type]) -> dict[str, Any]:
    world = _read_world(file.within("world"))
    schedule = _read_parameters(file.within("schedule"), Schedule)
    if file.integer("version") == 1:
        agent = _agent_of_version_1(file.within("agent"))
        arrays = _read_arrays(file, _RESULT_ARRAYS, without=["cell_of_state"])
        arrays["cell_of_state"] = np.arange(world.n_states, dtype=np.int32)
        file.sizes["S"] = world.n_states
    else:
        description = _read_agent(file.within("agent"), file.text("agent"), [])
        agent = restore(description, agents)
        arrays = _read_arrays(file, _RESULT_ARRAYS)
    check_result(arrays, world, schedule)
    return {
        "world": world,
        "agent": agent,
        "learning": _read_parameters(file.within("learning"), QLearning),
        "schedule": schedule,
        "q": _read_arrays(file, _Q_ARRAY)["q"] if "q" in file else None,
        **arrays,
    }


def _read_arrays(
    group: Checked, arrays: Mapping[str, _Array], without: Sequence[str] = ()
) -> dict[str, Any]:
    return {
        name: group.array(
            _DATASET_NAMES.get(name, name), info.dtype, info.shape, low=info.low, high=info.high
        )
        for name, info in arrays.items()
        if name not in without
    }


def _read_parameters(group: Checked, kind: type[ParametersT]) -> ParametersT:
    """Read a dataclass of parameters from attributes; those missing have their defaults."""
    readers = {
        "int": group.integer,
        "float": group.number,
        "bool": group.boolean,
        "tuple[int, ...]": group.integers,
    }
    found = group.attribute_names
    fields = {field.name: field for field in dataclasses.fields(kind)}  # pyright: ignore[reportArgumentType]
    if unknown := set(found) - set(fields):
        raise Hdf5ContentError(f"{group.group.name}: unknown attributes {sorted(unknown)}")
    return kind(
        **{
            name: readers.get(str(field.type), group.text)(name)
            for name, field in fields.items()
            if name in found or field.default is dataclasses.MISSING
        }
    )


def _read_world(group: Checked) -> GridWorld:
    n_y, n_x = group.integers("shape", 2, low=1)
    x, y, z = group.numbers("source", 3)
    world = GridWorld(
        **_read_arrays(group, _WORLD_ARRAYS),
        start_state=group.integer("start_state"),
        speed=group.integer("speed", low=1),
        shape=(n_y, n_x),
        source=(x, y, z),
        plan_name=group.text("plan_name"),
        plan_sha256=group.text("plan_sha256"),
    )
    check_world(world)
    return world


def _read_agent(group: Checked, name: str, read: list[str]) -> AgentDescription:
    """Read an agent, or a dataclass that is a field of one.

    Parameters
    ----------
    group
        Where it is.
    name
        The agent's name; empty for a field.
    read
        Class paths read so far, whose number is limited: a group can hold itself.
    """
    read.append(group.text("class"))
    if len(read) > _MAX_GROUPS:
        raise Hdf5ContentError(f"group 'agent': more than {_MAX_GROUPS} groups within it")
    path = read[-1]
    values = {key: group.attribute(key) for key in group.attribute_names if key != "class"}
    for key in group.names:
        if group.is_group(key):
            values[key] = _read_agent(group.within(key), "", read)
        else:
            values[key] = _read_sequence(group, key)
    return AgentDescription(path, name, values)


def _read_sequence(group: Checked, name: str) -> NDArray[Any] | tuple[Any, ...]:
    if group.holds_texts(name):
        return group.texts(name)
    values = group.values(name)
    is_tuple = group.attributes_of(name).text("type") == "tuple"
    return tuple(values.tolist()) if is_tuple and values.ndim == 1 else values


def _agent_of_version_1(group: Checked) -> Agent:
    """Agent of a file of version 1, which stored its parameters in one flat table."""
    kind = group.text("kind")
    if kind == "location":
        return LocationAgent(group.number("terminal_distance_m"))
    if kind != "rss":
        raise Hdf5ContentError(f"attribute 'agent/kind': {kind!r}, expected 'rss' or 'location'")
    states: StateRule = ExactStates()
    if group.text("states") == "tolerance":
        states = ToleranceStates(group.number("threshold_db"))
    elif group.text("states") == "intervals":
        states = IntervalStates(group.numbers("edges_dbm"))
    fluctuation = Fluctuation(group.number("sigma_db"), group.number("correlation"))
    return RssAgent(states, group.number("terminal_dbm"), fluctuation)
