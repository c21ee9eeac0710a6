"""Gymnasium environments: its own checks, and one against many, bit for bit."""

from __future__ import annotations

import tomllib
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest

gymnasium = pytest.importorskip("gymnasium")

from gymnasium.utils.env_checker import check_env  # noqa: E402
from gymnasium.vector import SyncVectorEnv  # noqa: E402
from PIL import Image  # noqa: E402

from raytrace import HalfWaveDipole, TraceConfig  # noqa: E402
from rssnav.envs import IDS, NavigationEnv, NavigationVectorEnv  # noqa: E402
from rssnav.envs import options as env_options  # noqa: E402
from rssnav.envs.options import EnvOptions  # noqa: E402
from rssnav.envs.rendering import save_gif  # noqa: E402
from rssnav.missions import ReadingAbove, Within  # noqa: E402
from rssnav.missions.layout import WorldError  # noqa: E402
from rssnav.presets import Preset  # noqa: E402

QUICK = Preset(TraceConfig(1, 0, 1), HalfWaveDipole())
ROOT = Path(__file__).parents[3]


@pytest.fixture(autouse=True)
def _quick_maps(monkeypatch):
    monkeypatch.setattr(env_options, "PRESETS", {"paper": QUICK, "building": QUICK})


def made(name, **options):
    if name == "rssnav/Building-v0":
        options = {"plan": "flat", "goal_dbm": -30.0} | options
    return gymnasium.make(name, disable_env_checker=True, **options)


@pytest.mark.filterwarnings("ignore:.*WARN.*")  # a Box of dBm is neither symmetric nor normalised
@pytest.mark.parametrize("name", IDS)
def test_gymnasium_accepts_every_id(name):
    check_env(made(name, render_mode="rgb_array").unwrapped)


OPTIONS = {
    "rss": {},
    "cell": {"observation": "cell", "reward": "closeness", "per_second": -0.1},
    "history": {"observation": "history", "history": 3, "hover": True},
    "dict": {"observation": "dict", "sensitivity_dbm": -40.0},
    "noise": {"sigma_db": 2.0, "correlation": 0.3, "confirmations": 3, "hover": True},
    "test": {"sigma_db": 2.0, "confirmations": 9, "confirmation_error": 0.1},
    "places": {"goal_dbm": None, "places": 3, "jump_probability": 0.02, "observation": "history"},
    "doors": {"doors": 1, "places": 2, "toggle_probability": 0.1, "observation": "dict"},
    "battery": {"battery_kj": 4.0, "per_kj": -1.0, "reward": "none"},
}


@pytest.mark.filterwarnings("ignore:.*WARN.*")
@pytest.mark.parametrize("options", OPTIONS.values(), ids=OPTIONS)
def test_gymnasium_accepts_all_options(options):
    check_env(made("rssnav/Building-v0", **options).unwrapped, skip_render_check=True)


def same(one, other):
    if isinstance(one, dict):
        return all(same(one[name], other[name]) for name in one)
    return np.array_equal(one, other) and np.asarray(one).dtype == np.asarray(other).dtype


def modes():
    names = getattr(gymnasium.vector, "AutoresetMode", None)
    return ["NextStep"] if names is None else ["NextStep", "SameStep"]


@pytest.mark.parametrize("mode", modes())
@pytest.mark.parametrize("options", OPTIONS.values(), ids=OPTIONS)
def test_many_in_one_step_are_many_single_ones(options, mode):
    chosen = {"plan": "flat", "goal_dbm": -30.0, "max_steps": 60} | options
    how = {} if mode == "NextStep" else {"autoreset_mode": gymnasium.vector.AutoresetMode(mode)}
    singles = SyncVectorEnv([lambda: NavigationEnv(EnvOptions.of(**chosen))] * 6, **how)
    many = NavigationVectorEnv(EnvOptions.of(**chosen), 6, autoreset_mode=mode)
    assert many.single_observation_space == singles.single_observation_space
    assert many.observation_space == singles.observation_space
    draw, ends = np.random.default_rng(0), 0
    (seen, info), (expected, wanted) = many.reset(seed=5), singles.reset(seed=5)
    assert same(seen, expected)
    for _ in range(300):
        assert same(info["action_mask"], wanted["action_mask"])
        actions = draw.integers(0, singles.single_action_space.n, 6)
        *found, info = many.step(actions)
        *right, wanted = singles.step(actions)
        assert all(same(a, b) for a, b in zip(found, right, strict=True))
        over = found[2] | found[3]
        ends += np.count_nonzero(over)
        if mode == "SameStep" and over.any():
            assert same(info["_final_obs"], wanted["_final_obs"])
            for i in np.flatnonzero(over):
                assert same(info["final_obs"][i], wanted["final_obs"][i])
                mask = wanted["final_info"]["action_mask"][i]
                assert same(info["final_info"]["action_mask"][i], mask)
    assert ends > 6


def test_masks_say_what_is_possible_and_are_copies():
    env = made("rssnav/Building-v0").unwrapped
    _, info = env.reset(seed=0)
    for action in range(8):
        env.reset()
        moved = env.step(action) is not None and env.trail[-1] != env.trail[-2]
        assert moved == info["action_mask"][action]
    assert info["action_mask"].dtype == np.int8
    env.reset()
    info["action_mask"][:] = 7
    assert env.action_masks().dtype == np.bool_
    assert env.reset()[1]["action_mask"].max() == 1


def test_observations_tell_cells_apart_that_float32_does_not():
    assert made("rssnav/Building-v0").observation_space.dtype == np.float64


def test_pictures_and_films(tmp_path):
    env = made("rssnav/Building-v0", render_mode="rgb_array").unwrapped
    env.reset(seed=0)
    frames = [env.render()]
    for action in (0, 2, 4):
        env.step(action)
        frames.append(env.render())
    n_y, n_x = env.mission.layout.shape
    assert frames[0].shape == (8 * n_y, 8 * n_x, 3)
    assert any(not np.array_equal(frames[0], frame) for frame in frames)
    save_gif(frames, tmp_path / "flight.gif")
    with Image.open(tmp_path / "flight.gif") as film:
        assert film.n_frames > 1
    text = made("rssnav/Building-v0", render_mode="ansi").unwrapped
    text.reset(seed=0)
    assert text.render().count("@") == 1


def test_gymnasium_finds_the_ids_by_an_entry_point():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    module, function = project["entry-points"]["gymnasium.envs"]["__root__"].split(":")
    getattr(import_module(module), function)()
    many = gymnasium.make_vec("rssnav/Building-v0", num_envs=3, plan="flat", goal_dbm=-30.0)
    assert isinstance(many, NavigationVectorEnv)
    gymnasium.make_vec("rssnav/Office-v0", num_envs=1).spec.to_json()


def test_only_the_papers_plans_have_a_level_by_themselves():
    assert EnvOptions.of(plan="scenario1").task().goal == ReadingAbove(-21.0)
    assert EnvOptions.of(plan="flat").task().goal == Within(2.0)
    gymnasium.make("rssnav/Building-v0", plan="flat", disable_env_checker=True).reset(seed=0)


@pytest.mark.parametrize(("probability", "most"), [(0.0, 1), (0.25, 2)])
def test_doors_change_masks_during_a_flight_only_beside_them(probability, most):
    options = {"doors": 1, "toggle_probability": probability}
    env = made("rssnav/Building-v0", **options).unwrapped
    beside = set(np.flatnonzero(env.mission.sees[:, 0]).tolist())
    chooser, counts = np.random.default_rng(0), {True: set(), False: set()}
    for episode in range(20):
        _, info = env.reset(seed=episode)
        ended, masks = False, {}
        while not ended:
            masks.setdefault(env.trail[-1], set()).add(tuple(info["action_mask"]))
            action = chooser.choice(np.flatnonzero(info["action_mask"]))
            _, _, terminated, truncated, info = env.step(action)
            ended = terminated or truncated
        for cell, found in masks.items():
            counts[cell in beside].add(len(found))
    assert max(counts[True]) == most
    assert counts[False] == {1}


WRONG = {
    "doors": ({"doors": 7}, ValueError, "doors = 7: expected a whole number from 0 to 6"),
    "no door": ({"plan": "scenario1", "doors": 1}, WorldError, "'scenario1' has no open door"),
    "probability": (
        {"doors": 1, "closed_probability": 2.0},
        ValueError,
        "closed_probability = 2.0",
    ),
    "option": ({"speeed": 1}, TypeError, "speeed: no such option; there are plan"),
    "observation": (
        {"observation": "sound"},
        ValueError,
        "observation = 'sound': expected rss or history",
    ),
    "half a place": ({"places": 2.5}, ValueError, "places = 2.5: expected a whole number from 1"),
    "text": ({"sigma_db": "2"}, ValueError, "sigma_db = '2': expected a number"),
    "none": ({"sigma_db": None}, ValueError, "sigma_db = None: expected a number"),
    "plan": ({"plan": 3}, ValueError, "plan = 3: expected a name"),
    "seconds": ({"max_steps": 1.5}, ValueError, "max_steps = 1.5: expected"),
    "long history": ({"history": 10**12}, ValueError, "history = 1000000000000: expected"),
    "sensitivity": ({"sensitivity_dbm": np.nan}, ValueError, "sensitivity_dbm = nan: expected"),
    "choice": ({"hover": "no"}, ValueError, "hover = 'no': expected True or False"),
    "confirmed distance": (
        {"goal_dbm": None, "confirmations": 9},
        ValueError,
        "goal_dbm = None: expected a level for the readings",
    ),
    "action": ({"hover": True}, ValueError, "action 9: expected 0 to 8"),
}


@pytest.mark.parametrize(("options", "error", "message"), WRONG.values(), ids=WRONG)
def test_wrong_options_and_actions_are_refused(options, error, message):
    def fly():
        env = NavigationEnv(EnvOptions.of(**{"plan": "flat", "goal_dbm": -30.0} | options))
        env.reset(seed=0)
        env.step(9)

    with pytest.raises(error, match=message):
        fly()
