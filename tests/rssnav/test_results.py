import dataclasses

import h5py
import numpy as np
import pytest

from rssnav import (
    Fluctuation,
    IntervalStates,
    LocationAgent,
    QLearning,
    RssAgent,
    ToleranceStates,
    TrainingResult,
    train,
)
from rssnav.result_file import ResultFileError


def assert_same(one, other):
    for field in dataclasses.fields(one):
        a, b = getattr(one, field.name), getattr(other, field.name)
        if isinstance(a, np.ndarray):
            assert a.dtype == b.dtype, field.name
            assert np.array_equal(a, b), field.name
        elif field.name == "world":
            assert_same(a, b)
        else:
            assert a == b, field.name


@pytest.fixture
def result(room_world):
    return train(room_world, RssAgent(), runs=2, episodes=5, snapshot_episodes=(2, 5))


@pytest.mark.parametrize(
    "agent",
    [
        RssAgent(),
        RssAgent(ToleranceStates(0.5), -22.0, Fluctuation(0.1, 0.3)),
        RssAgent(IntervalStates((-60.0, -40.0))),
        LocationAgent(1.8),
    ],
    ids=["exact", "tolerance", "intervals", "location"],
)
@pytest.mark.parametrize("keep_q", [False, True])
def test_what_is_saved_is_what_is_loaded(room_world, agent, keep_q, tmp_path):
    learning = QLearning(initial_q=50.0, tie_break="random", max_steps=300)
    result = train(room_world, agent, runs=3, episodes=4, learning=learning, keep_q=keep_q)
    result.save(tmp_path / "deep" / "result.h5")
    assert_same(TrainingResult.load(tmp_path / "deep" / "result.h5"), result)


def test_a_loaded_result_can_be_resumed(room_world, tmp_path):
    part = train(room_world, RssAgent(), runs=3, episodes=5, only_runs=[1])
    part.save(tmp_path / "part.h5")
    loaded = TrainingResult.load(tmp_path / "part.h5")
    resumed = train(room_world, RssAgent(), runs=3, episodes=5, resume=loaded)
    assert np.array_equal(resumed.steps, train(room_world, RssAgent(), runs=3, episodes=5).steps)


def test_a_file_is_readable_without_this_project(result, tmp_path):
    result.save(tmp_path / "result.h5")
    with h5py.File(tmp_path / "result.h5") as file:
        assert file.attrs["format"] == "rssnav-training"
        assert file["learning"].attrs["gamma"] == 0.98
        assert file.attrs["agent"] == "rss"
        assert file["agent"].attrs["terminal_dbm"] == -21.0
        assert file["agent/states"].attrs["class"] == "rssnav:ExactStates"
        assert file["steps"].shape == (2, 5)
        assert file["steps"].attrs["long_name"]
        assert file["path_length_m"].attrs["units"] == "m"


def test_saving_leaves_nothing_else_behind(result, tmp_path):
    result.save(tmp_path / "result.h5")
    result.save(tmp_path / "result.h5")
    assert [path.name for path in tmp_path.iterdir()] == ["result.h5"]


def test_a_failed_save_leaves_the_old_file(result, tmp_path):
    path = tmp_path / "result.h5"
    result.save(path)
    before = path.read_bytes()
    with pytest.raises(TypeError):
        dataclasses.replace(result, run_ids=np.array([object()])).save(path)
    assert path.read_bytes() == before
    assert [p.name for p in tmp_path.iterdir()] == ["result.h5"]


def test_a_missing_file_is_named(tmp_path):
    with pytest.raises(FileNotFoundError, match=r"none\.h5: no such training result"):
        TrainingResult.load(tmp_path / "none.h5")


@pytest.mark.parametrize("keep", [0.0, 0.1, 0.5, 0.9])
def test_a_truncated_file_is_refused(result, tmp_path, keep):
    path = tmp_path / "result.h5"
    result.save(path)
    content = path.read_bytes()
    path.write_bytes(content[: int(keep * len(content))])
    with pytest.raises(ResultFileError, match=r"result\.h5: not a readable training result"):
        TrainingResult.load(path)


def test_a_foreign_file_is_refused(tmp_path):
    with h5py.File(tmp_path / "other.h5", "w") as file:
        file.attrs["format"] = "something else"
    with pytest.raises(ResultFileError, match="format is 'something else'"):
        TrainingResult.load(tmp_path / "other.h5")


def test_another_version_is_refused(result, tmp_path):
    path = tmp_path / "result.h5"
    result.save(path)
    with h5py.File(path, "a") as file:
        file.attrs["version"] = 99
    with pytest.raises(ResultFileError, match="version 99"):
        TrainingResult.load(path)


def test_a_file_without_an_array_is_refused(result, tmp_path):
    path = tmp_path / "result.h5"
    result.save(path)
    with h5py.File(path, "a") as file:
        del file["steps"]
    with pytest.raises(ResultFileError, match="not a readable training result"):
        TrainingResult.load(path)
