"""Libraries that learn in the environments or keep their data, where they are installed."""

from __future__ import annotations

import numpy as np
import pytest

gymnasium = pytest.importorskip("gymnasium")

from raytrace import HalfWaveDipole, TraceConfig  # noqa: E402
from rssnav.envs import options as env_options  # noqa: E402
from rssnav.envs.options import EnvOptions  # noqa: E402
from rssnav.mission_training import train_mission  # noqa: E402
from rssnav.missions import Observation, fly  # noqa: E402
from rssnav.presets import Preset  # noqa: E402

QUICK = Preset(TraceConfig(1, 0, 1), HalfWaveDipole())
OPTIONS = {"plan": "flat", "goal_dbm": -30.0, "max_steps": 60}

pytestmark = pytest.mark.filterwarnings(
    "ignore::DeprecationWarning", "ignore::FutureWarning", "ignore::UserWarning"
)  # of the libraries


@pytest.fixture(autouse=True)
def _quick_maps(monkeypatch):
    monkeypatch.setattr(env_options, "PRESETS", {"paper": QUICK, "building": QUICK})


@pytest.fixture
def vec_env():
    pytest.importorskip("stable_baselines3")
    import torch

    torch.set_num_threads(1)
    from rssnav.envs.stable_baselines import NavigationVecEnv

    def made(n, **options):
        return NavigationVecEnv(n, **OPTIONS | options)

    return made


@pytest.mark.parametrize("options", [{}, {"observation": "dict"}, {"sigma_db": 2.0}], ids=str)
def test_the_compiled_environments_are_those_of_stable_baselines(vec_env, options):
    from stable_baselines3.common.vec_env import DummyVecEnv

    def single():
        return gymnasium.make("rssnav/Building-v0", **OPTIONS | options)

    many, singles = vec_env(4, **options), DummyVecEnv([single] * 4)
    assert many.observation_space == singles.observation_space
    many.seed(7)
    singles.seed(7)
    draw, ends = np.random.default_rng(0), 0
    same(many.reset(), singles.reset())
    for _ in range(200):
        np.testing.assert_array_equal(
            many.env_method("action_masks", indices=[1, 3]),
            singles.env_method("action_masks", indices=[1, 3]),
        )
        actions = draw.integers(0, 8, 4)
        seen, reward, ended, infos = many.step(actions)
        expected, right, over, wanted = singles.step(actions)
        same(seen, expected)
        np.testing.assert_array_equal(reward, right)
        np.testing.assert_array_equal(ended, over)
        for i in np.flatnonzero(over):
            same(infos[i]["terminal_observation"], wanted[i]["terminal_observation"])
            assert infos[i]["TimeLimit.truncated"] == wanted[i]["TimeLimit.truncated"]
        ends += np.count_nonzero(over)
    assert ends > 4


def same(one, other):
    for name in one if isinstance(one, dict) else ():
        np.testing.assert_array_equal(one[name], other[name])
    if not isinstance(one, dict):
        np.testing.assert_array_equal(one, other)


def test_maskable_ppo_learns_and_takes_possible_actions_only(vec_env):
    contrib = pytest.importorskip("sb3_contrib")
    from stable_baselines3.common.vec_env import VecMonitor, VecNormalize

    env = VecNormalize(VecMonitor(vec_env(16, reward="none", per_second=-1.0, goal_reward=0.0)))
    agent = contrib.MaskablePPO("MlpPolicy", env, n_steps=64, batch_size=256, seed=0, device="cpu")
    agent.learn(40_000)
    returns = [episode["r"] for episode in agent.ep_info_buffer]
    assert len(returns) == 100
    walk = random_returns(vec_env(16, reward="none", per_second=-1.0, goal_reward=0.0))
    assert np.mean(returns) > np.mean(walk) + 5.0
    seen = env.reset()
    for _ in range(20):
        masks = np.stack(env.env_method("action_masks"))
        actions, _ = agent.predict(seen, action_masks=masks)
        assert masks[np.arange(16), actions].all()
        seen, *_ = env.step(actions)


def random_returns(env):
    """Sums of rewards of episodes in which every possible action is equally likely."""
    draw, total, found = np.random.default_rng(0), np.zeros(env.num_envs), []
    env.seed(0)
    env.reset()
    while len(found) < 100:
        masks = env.action_masks()
        actions = np.argmax(masks * draw.random(masks.shape), axis=1)
        _, reward, ended, _ = env.step(actions)
        total += reward
        found += total[ended].tolist()
        total[ended] = 0.0
    return found


def test_dqn_runs_in_one_environment(vec_env):
    from stable_baselines3 import DQN

    env = gymnasium.make("rssnav/Building-v0", observation="history", **OPTIONS)
    agent = DQN("MlpPolicy", env, learning_starts=100, buffer_size=2000, seed=0, device="cpu")
    before = [p.detach().clone() for p in agent.q_net.parameters()]
    agent.learn(600)
    after = list(agent.q_net.parameters())
    assert any(not np.array_equal(a, b.detach()) for a, b in zip(before, after, strict=True))
    action, _ = agent.predict(env.reset(seed=0)[0])
    assert env.action_space.contains(int(action))


def test_what_the_environments_of_stable_baselines_lack_is_named(vec_env):
    env = vec_env(2)
    assert env.has_attr("action_masks")
    assert not env.has_attr("wings")
    assert env.env_is_wrapped(gymnasium.Wrapper) == [False, False]
    with pytest.raises(AttributeError, match="render: the environments have action_masks"):
        env.env_method("render")
    with pytest.raises(NotImplementedError, match="speed: give options"):
        env.set_attr("speed", 2)


def test_a_minari_data_set_of_a_trained_agent_is_loaded_with_its_environment(tmp_path, monkeypatch):
    minari = pytest.importorskip("minari")
    monkeypatch.setenv("MINARI_DATASETS_PATH", str(tmp_path))
    options = OPTIONS | {"observation": "cell"}
    chosen = EnvOptions.of(**options)
    mission, task, sight = chosen.mission(), chosen.task(), Observation(None, cell=True)
    table = train_mission(mission, task, sight, steps=50_000)
    env = minari.DataCollector(gymnasium.make("rssnav/Building-v0", **options))
    returns = []
    for episode in range(3):
        cell, info = env.reset(seed=episode)
        ended, total = False, 0.0
        while not ended:
            action = int(np.argmax(np.where(info["action_mask"], table.q[cell], -np.inf)))
            cell, reward, terminated, truncated, info = env.step(action)
            ended, total = terminated or truncated, total + reward
        returns.append(total)
    env.create_dataset(dataset_id="rssnav/flat/q-learning-v0", algorithm_name="Q-learning")
    data = minari.load_dataset("rssnav/flat/q-learning-v0")
    assert [episode.rewards.sum() for episode in data.iterate_episodes()] == returns
    flights = fly(mission, task, sight, table, episodes=1)
    assert returns == pytest.approx([float(flights.reward[0])] * 3)
    again = data.recover_environment()
    for episode in data.iterate_episodes():
        seen = [again.reset()[0]]
        for action in episode.actions:
            seen.append(again.step(action)[0])
        np.testing.assert_array_equal(seen, episode.observations)
