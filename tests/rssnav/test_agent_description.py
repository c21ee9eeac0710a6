"""Agents of any class in result files."""

from __future__ import annotations

import sys
from dataclasses import dataclass, field

import numpy as np
import pytest

from rssnav import (
    AgentDescription,
    Fluctuation,
    LocationAgent,
    RssAgent,
    ToleranceStates,
    TrainingResult,
    train,
)
from rssnav.agent_description import describe, flat_parameters, restore, same_agent
from rssnav.result_file import ResultFileError


@dataclass(frozen=True)
class Battery:
    capacity_j: float = 50.0
    cells: int = 3


@dataclass(frozen=True, eq=False)
class Gadget:
    """Everything that a field may be, around the location agent's process."""

    name: str = "gadget"
    kind: str = "a field may be called so"
    eager: bool = True
    limit: float | None = None
    tries: int = 4
    levels: tuple[float, ...] = (0.5, 1.0)
    words: tuple[str, ...] = ("north", "süd")
    nothing: tuple[float, ...] = ()
    weights: np.ndarray = field(default_factory=lambda: np.arange(6.0).reshape(2, 3))
    battery: Battery = field(default_factory=Battery)

    def decision_process(self, world, learning):
        return LocationAgent().decision_process(world, learning)


def saved(world, agent, path):
    result = train(world, agent, runs=2, episodes=3)
    result.save(path)
    return result


def test_an_agent_comes_back_from_a_file_as_it_was(room_world, tmp_path):
    agent = Gadget(weights=np.array([[1.5, -2.0]]), battery=Battery(7.0))
    saved(room_world, agent, tmp_path / "result.h5")
    loaded = TrainingResult.load(tmp_path / "result.h5", agents=[Gadget, Battery]).agent
    assert isinstance(loaded, Gadget)
    assert same_agent(loaded, agent)
    assert loaded.weights.dtype == agent.weights.dtype
    assert (loaded.limit, loaded.eager, loaded.words) == (None, True, ("north", "süd"))
    assert (loaded.nothing, loaded.battery) == ((), Battery(7.0))


def test_an_agent_not_given_is_described_and_the_arrays_are_read(room_world, tmp_path):
    result = saved(room_world, Gadget(), tmp_path / "result.h5")
    loaded = TrainingResult.load(tmp_path / "result.h5")
    assert isinstance(loaded.agent, AgentDescription)
    assert loaded.agent.name == "gadget"
    assert loaded.agent.class_path == f"{Gadget.__module__}:Gadget"
    assert loaded.agent.parameters["tries"] == 4
    assert loaded.agent.parameters["battery"].parameters == {"capacity_j": 50.0, "cells": 3}
    assert np.array_equal(loaded.steps, result.steps)
    assert np.array_equal(loaded.trajectories, result.trajectories)
    with pytest.raises(ValueError, match=r"only its description was loaded.*agents=\[\.\.\.\]"):
        train(room_world, loaded.agent, runs=1, episodes=1)


def test_a_described_agent_is_saved_again_as_it_is(room_world, tmp_path):
    saved(room_world, Gadget(tries=9), tmp_path / "first.h5")
    TrainingResult.load(tmp_path / "first.h5").save(tmp_path / "second.h5")
    agent = TrainingResult.load(tmp_path / "second.h5", agents=[Gadget, Battery]).agent
    assert same_agent(agent, Gadget(tries=9))


def test_loading_imports_no_module(room_world, tmp_path, monkeypatch):
    module = tmp_path / "strange_agents.py"
    module.write_text("raise SystemExit('imported')\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.setattr(Gadget, "__module__", "strange_agents")
    saved(room_world, Gadget(), tmp_path / "result.h5")
    monkeypatch.undo()
    monkeypatch.syspath_prepend(str(tmp_path))
    agent = TrainingResult.load(tmp_path / "result.h5").agent
    assert agent.class_path == "strange_agents:Gadget"
    assert "strange_agents" not in sys.modules


def test_a_missing_class_of_a_field_is_named(room_world, tmp_path):
    saved(room_world, Gadget(), tmp_path / "result.h5")
    with pytest.raises(ResultFileError, match=r"field of class .*:Battery, which was not given"):
        TrainingResult.load(tmp_path / "result.h5", agents=[Gadget])


def test_a_class_that_has_changed_is_named():
    description = describe(Battery())
    changed = AgentDescription(description.class_path, "", {"volts": 3.0})
    with pytest.raises(ValueError, match=r"Battery does not accept the parameters .*\(volts\)"):
        restore(changed, [Battery])


def test_what_cannot_be_stored_is_named_and_leaves_no_file(room_world, tmp_path):
    with pytest.raises(TypeError, match=r"Gadget\.levels: \[1\.0\] cannot be stored; use"):
        saved(room_world, Gadget(levels=[1.0]), tmp_path / "result.h5")

    class Plain:
        name = "plain"
        decision_process = Gadget.decision_process

    with pytest.raises(TypeError, match=r"Plain: only a dataclass"):
        saved(room_world, Plain(), tmp_path / "result.h5")
    assert not list(tmp_path.iterdir())


def test_agents_are_compared_by_class_and_parameters():
    assert same_agent(RssAgent(), RssAgent(terminal_dbm=-21))
    assert not same_agent(RssAgent(), LocationAgent())
    assert not same_agent(RssAgent(ToleranceStates(1.0)), RssAgent(ToleranceStates(2.0)))
    assert same_agent(Gadget(), Gadget())
    assert not same_agent(Gadget(), Gadget(weights=np.zeros(2)))
    assert not same_agent(Gadget(), Gadget(levels=np.zeros(2)))


def test_parameters_in_one_table():
    agent = RssAgent(ToleranceStates(1.0), -30.0, Fluctuation(2.0))
    assert flat_parameters(describe(agent)) == {
        "states": "ToleranceStates",
        "states.threshold_db": 1.0,
        "terminal_dbm": -30.0,
        "sensitivity_dbm": -150.0,
        "fluctuation": "Fluctuation",
        "fluctuation.sigma_db": 2.0,
        "fluctuation.correlation": 0.0,
    }
