"""Agents as plain values: what a result file stores of an agent of any class.

An agent is a dataclass whose fields are numbers, strings, booleans, None, arrays, tuples of
numbers or strings, or dataclasses of such fields. Its description names each class by its import
path and lists the fields, so it can be stored and compared. :func:`restore` builds the agent from
classes that the caller passes; it imports no module.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from rssnav.agents import Agent, LocationAgent, RssAgent
from rssnav.arguments import is_finite
from rssnav.discrete_states import (
    ExactStates,
    Fluctuation,
    IntervalStates,
    StateRule,
    ToleranceStates,
)

if TYPE_CHECKING:
    from rssnav.decision_process import DecisionProcess
    from rssnav.learning_parameters import QLearning
    from rssnav.world import GridWorld

_PUBLIC = (RssAgent, LocationAgent, ExactStates, ToleranceStates, IntervalStates, Fluctuation)
_SCALARS = (bool, int, float, str, np.generic, type(None))


@dataclass(frozen=True, eq=False)
class AgentDescription:
    """Class, name and parameters of an agent, or of a dataclass that is a field of one.

    A loaded result has it in place of an agent whose class is not given to ``load``.

    Attributes
    ----------
    class_path : str
        Import path ``module:qualname``.
    name : str
        Name of the agent; empty for a field.
    parameters : mapping of str to value
        Scalars, strings, None, tuples, arrays or AgentDescription.
    """

    class_path: str
    name: str
    parameters: Mapping[str, Any]

    def decision_process(self, world: GridWorld, learning: QLearning) -> DecisionProcess:
        """Raise ValueError: a description cannot be trained; see `Agent.decision_process`."""
        raise ValueError(
            f"agent {self.name!r}: only its description was loaded; to get the agent itself, give "
            f"its class {self.class_path}: TrainingResult.load(path, agents=[...])"
        )


def describe(agent: object) -> AgentDescription:
    """Describe an agent, or a dataclass that is a field of one.

    Raises
    ------
    TypeError
        When it is not a dataclass, or a field holds another kind of value.
    """
    if isinstance(agent, AgentDescription):
        return agent
    cls = type(agent)
    if not dataclasses.is_dataclass(agent):
        raise TypeError(
            f"agent {cls.__qualname__}: only a dataclass can be described by its fields; decorate "
            "the class with @dataclass(frozen=True)"
        )
    parameters = {
        field.name: _plain(getattr(agent, field.name), f"{cls.__qualname__}.{field.name}")
        for field in dataclasses.fields(agent)
        if field.init
    }
    return AgentDescription(class_path(cls), str(getattr(agent, "name", "")), parameters)


def class_path(cls: type) -> str:
    """Import path ``module:qualname`` of a class; ours by their public names."""
    return f"rssnav:{cls.__name__}" if cls in _PUBLIC else f"{cls.__module__}:{cls.__qualname__}"


def _plain(value: object, where: str) -> object:
    """Value of a field as a description holds it."""
    if isinstance(value, np.ndarray) and value.dtype.kind in "biufc":
        return value
    if isinstance(value, _SCALARS):
        return value.item() if isinstance(value, np.generic) else value
    if isinstance(value, tuple) and _is_plain(value):
        return value
    if dataclasses.is_dataclass(value):
        return describe(value)
    raise TypeError(
        f"{where}: {value!r} cannot be stored; use a number, string, boolean, None, numeric array, "
        "tuple of numbers or of strings, or a dataclass of these"
    )


def _is_plain(values: tuple[object, ...]) -> bool:
    return all(isinstance(v, int | float) for v in values) or all(
        isinstance(v, str) for v in values
    )


def restore(description: AgentDescription, classes: Iterable[type]) -> Agent:
    """Build the agent of a description, from our classes and those given.

    Returns
    -------
    Agent
        The description itself where the class is neither ours nor given.

    Raises
    ------
    ValueError
        When a field's class is missing, or the class does not accept the parameters.
    """
    known = {class_path(cls): cls for cls in (*_PUBLIC, *classes)}
    if description.class_path not in known:
        return description
    return _instance(description, known)


def _instance(description: AgentDescription, known: Mapping[str, type]) -> Any:
    cls = known.get(description.class_path)
    if cls is None:
        raise ValueError(
            f"the agent has a field of class {description.class_path}, which was not given: add it "
            "to TrainingResult.load(path, agents=[...])"
        )
    values = {
        name: _instance(value, known) if isinstance(value, AgentDescription) else value
        for name, value in description.parameters.items()
    }
    if cls in _PUBLIC:
        _check_types(cls, values)
    try:
        return cls(**values)
    except Exception as error:  # whatever a class of the caller's raises
        raise ValueError(
            f"agent class {description.class_path} does not accept the parameters of the file "
            f"({', '.join(values)}): {error}"
        ) from error


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and is_finite(value)


_IS_OF_TYPE: dict[str, Callable[[Any], bool]] = {
    "float": _is_number,
    "tuple[float, ...]": lambda value: isinstance(value, tuple) and all(map(_is_number, value)),
    "StateRule": lambda value: isinstance(value, StateRule),
    "Fluctuation": lambda value: isinstance(value, Fluctuation),
}
"""Whether a value is of a type, by the annotations of the fields of our classes."""


def _check_types(cls: type[Any], values: Mapping[str, Any]) -> None:
    """Refuse values of other types than a class of ours has."""
    for field in dataclasses.fields(cls):
        if field.name in values and not _IS_OF_TYPE[str(field.type)](values[field.name]):
            raise ValueError(
                f"{cls.__name__}.{field.name}: {values[field.name]!r} is not of type {field.type}"
            )


def same_agent(one: Agent, other: Agent) -> bool:
    """Whether two agents are of the same class and have the same parameters."""
    try:
        return _same(describe(one), describe(other))
    except TypeError:  # not a dataclass of plain values: its own comparison
        return bool(one == other)


def _same(one: object, other: object) -> bool:
    if isinstance(one, AgentDescription) and isinstance(other, AgentDescription):
        mine, others = one.parameters, other.parameters
        return (
            one.class_path == other.class_path
            and mine.keys() == others.keys()
            and all(_same(mine[name], others[name]) for name in mine)
        )
    if isinstance(one, np.ndarray) and isinstance(other, np.ndarray):
        return np.array_equal(one, other)
    return type(one) is not np.ndarray and type(other) is not np.ndarray and one == other


def flat_parameters(description: AgentDescription, prefix: str = "") -> dict[str, Any]:
    """Parameters as one table; those of a field's dataclass as ``field.parameter``."""
    table: dict[str, Any] = {}
    for name, value in description.parameters.items():
        if isinstance(value, AgentDescription):
            table[prefix + name] = value.class_path.rpartition(":")[2]
            table |= flat_parameters(value, f"{prefix}{name}.")
        else:
            table[prefix + name] = value
    return table
