"""Result files of earlier versions of the format, written by the programs of their time."""

from __future__ import annotations

import gzip
from pathlib import Path

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

DATA = Path(__file__).parent / "data"
AGENTS = {
    "tolerance": RssAgent(ToleranceStates(0.5), -22.0, Fluctuation(0.1, 0.3)),
    "intervals": RssAgent(IntervalStates((-60.0, -40.0))),
    "location": LocationAgent(1.8),
}


@pytest.mark.parametrize("name", AGENTS)
def test_a_file_of_version_1_holds_the_training_of_today(room_world, name, tmp_path):
    packed = (DATA / f"training_version_1_{name}.h5.gz").read_bytes()
    (tmp_path / "old.h5").write_bytes(gzip.decompress(packed))
    old = TrainingResult.load(tmp_path / "old.h5")
    # The last bit of the room's RSS depends on the processor that takes the logarithms.
    np.testing.assert_allclose(old.world.rss_dbm, room_world.rss_dbm, rtol=1e-14)
    new = train(
        old.world,
        AGENTS[name],
        runs=2,
        episodes=5,
        seed=3,
        snapshot_episodes=(2, 5),
        learning=QLearning(max_steps=300),
        keep_q=name == "tolerance",
    )
    new.check_same_training(old.world, old.agent, old.learning, old.schedule)
    for field in ("steps", "cell_of_state", "visit_counts", "trajectories", "n_discrete_states"):
        assert np.array_equal(getattr(old, field), getattr(new, field)), field
    assert (old.q is None) == (new.q is None)
    assert old.q is None or np.array_equal(old.q, new.q)
    old.save(tmp_path / "again.h5")
    assert TrainingResult.load(tmp_path / "again.h5").agent == AGENTS[name]
