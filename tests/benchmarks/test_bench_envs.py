"""Steps a second of the Gymnasium environments, one process, per second of processor time.

    pytest tests/benchmarks/test_bench_envs.py --benchmark-enable -s

Without --benchmark-enable each is stepped a few times only.
"""

from __future__ import annotations

import time

import numpy as np
import pytest
from test_bench_learning import hall_with_pillars

pytest.importorskip("gymnasium")

from rssnav.envs import NavigationEnv, NavigationVectorEnv
from rssnav.envs import options as env_options
from rssnav.envs.options import EnvOptions

ROUNDS = 5
CASES = {
    "single": (None, {}),
    "single, history": (None, {"observation": "history"}),
    "1024": (1024, {}),
    "8192": (8192, {}),
    "1024, 2 dB": (1024, {"sigma_db": 2.0}),
}


@pytest.mark.parametrize(("size", "options"), CASES.values(), ids=CASES)
def test_bench_steps(size, options, monkeypatch, benchmark):
    mission = hall_with_pillars().mission()
    monkeypatch.setattr(env_options, "_mission", lambda *_: mission)
    options = EnvOptions.of(plan="scenario1", **options)
    env = NavigationEnv(options) if size is None else NavigationVectorEnv(options, size)
    steps = (2_000_000 // (size or 20)) if benchmark.enabled else 20
    shape = (64,) if size is None else (64, size)
    actions = list(np.random.default_rng(0).integers(0, 8, shape))
    rates = []

    def one_round() -> None:
        env.reset(seed=0)
        begin = time.process_time()
        for k in range(steps):
            step = env.step(actions[k & 63])
            if size is None and (step[2] or step[3]):
                env.reset()
        rates.append(steps * (size or 1) / (time.process_time() - begin))

    benchmark.pedantic(one_round, rounds=ROUNDS, warmup_rounds=1)
    benchmark.extra_info.update(steps_per_s=max(rates))
    print(f"\n{size or 1} environments, {options.observation}: {max(rates):.3g} steps a second")
