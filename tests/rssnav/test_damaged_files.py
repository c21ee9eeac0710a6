"""A map or result whose parts are replaced is refused by name, or what is read is sound."""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np
import pytest
from damaged_hdf5 import changed, damaged

from raytrace import (
    Antenna,
    Grid,
    Isotropic,
    MapFileError,
    PatternTable,
    RadioMap,
    TraceConfig,
    Transmitter,
)
from raytrace.results.map_file import is_radio_map
from rssnav import (
    Fluctuation,
    IntervalStates,
    QLearning,
    ResultFileError,
    RssAgent,
    TrainingResult,
    train,
)

ANGLES = np.linspace(0.0, 180.0, 5), np.linspace(0.0, 360.0, 9)


def some_map(antenna: Antenna) -> RadioMap:
    grid = Grid.over((0.0, 0.0, 4.0, 3.0), 0.5, 2.0)
    rss_dbm = -40.0 - np.arange(float(np.prod(grid.shape))).reshape(grid.shape)
    return RadioMap(
        rss_dbm,
        rss_dbm - 1.0,
        np.ones(grid.shape, dtype=np.int64),
        grid,
        Transmitter((1.0, 1.0, 1.5), antenna=antenna),
        TraceConfig(max_paths=1000),
        provenance={"tracer_version": 1, "wall_time_s": 1.5},
        mean_delay_s=np.ones(grid.shape),
    )


def use_map(radio_map: RadioMap) -> None:
    assert radio_map.rss_dbm.shape == radio_map.grid.shape
    assert all(layer.dtype in (np.float64, np.int64) for layer in radio_map.layers.values())
    radio_map.to_xarray()
    radio_map.transmitter.antenna.amplitudes(np.zeros(2), np.ones(2))


def use_result(result: TrainingResult) -> None:
    assert result.visits.shape[1:] == result.world.shape
    assert result.episode_length_m.shape == result.steps.shape
    for index in range(result.run_ids.size):
        result.trajectory_m(index)


def check(path: Path, load, error, use) -> int:
    """Load each damaged file; return how many are refused."""
    messages = {}
    for what, damage in damaged(path.read_bytes()):
        path.write_bytes(damage)
        try:
            found = load(path)
        except error as problem:
            messages[what] = str(problem)
        else:
            use(found)
    unnamed = {
        what: message
        for what, message in messages.items()
        if what[0].split("/")[-1] not in message
        and "has shape" not in message  # of another one, which must be of the same size
    }
    assert not unnamed
    return len(messages)


def test_a_map_without_a_plan_comes_back(tmp_path) -> None:
    some_map(Isotropic()).save(tmp_path / "map.h5")
    assert RadioMap.load(tmp_path / "map.h5").plan_text == ""


def test_what_is_wrong_in_a_map_is_named(tmp_path) -> None:
    path = tmp_path / "map.h5"
    some_map(PatternTable.of_gain(*ANGLES, np.zeros((5, 9)))).save(path)
    assert check(path, RadioMap.load, MapFileError, use_map) > 250


def test_what_is_wrong_in_a_result_is_named(room_world, tmp_path) -> None:
    path = tmp_path / "result.h5"
    train(
        room_world,
        RssAgent(IntervalStates((-60.0, -40.0)), fluctuation=Fluctuation(0.1)),
        runs=2,
        episodes=3,
        snapshot_episodes=(2,),
        learning=QLearning(max_steps=50),
        keep_q=True,
    ).save(path)
    assert check(path, TrainingResult.load, ResultFileError, use_result) > 400


def test_an_agent_that_holds_itself_is_refused(room_world, tmp_path) -> None:
    path = tmp_path / "result.h5"
    train(room_world, RssAgent(), runs=1, episodes=2).save(path)

    def loop(file: h5py.File) -> None:
        file["agent/states/again"] = file["agent"]

    path.write_bytes(changed(path.read_bytes(), loop))
    with pytest.raises(ResultFileError, match="more than 50 groups"):
        TrainingResult.load(path)


@pytest.mark.parametrize(
    "change",
    [
        lambda file: file["x"].write_direct(np.array([5.0] * file["x"].size)),
        lambda file: file.attrs.modify("cell_size_m", 0.7),
        lambda file: file["rss_dbm"].__setitem__((0, 0), -np.inf),
    ],
)
def test_parts_of_a_map_that_do_not_fit_together_are_refused(tmp_path, change) -> None:
    path = tmp_path / "map.h5"
    some_map(Isotropic()).save(path)
    path.write_bytes(changed(path.read_bytes(), change))
    with pytest.raises(MapFileError, match=r"steps of cell_size_m|without a path"):
        RadioMap.load(path)
    assert is_radio_map(path)


def test_what_is_no_file_is_refused(tmp_path) -> None:
    with pytest.raises(MapFileError, match="not a file"):
        RadioMap.load(tmp_path)
    assert not is_radio_map(tmp_path)
    assert not is_radio_map(Path("/dev/zero"))
