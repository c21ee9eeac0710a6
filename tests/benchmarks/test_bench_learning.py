"""Speed of the learning loop beside plain C doing the same work on the same tables.

    pytest tests/benchmarks/test_bench_learning.py --benchmark-enable -s

prints million steps a second of the kernel and of q_loop.c, one thread, rounds taken in turn so
that all see the same machine, and how much faster two threads train than one. Without
--benchmark-enable each runs once, briefly, and only the equality of results is tested.
"""

from __future__ import annotations

import time

import numpy as np
import pytest
from c_loop import COMPILER, CRun, build

from raytrace.threads import n_threads
from rssnav import LocationAgent, QLearning, RssAgent, train
from rssnav.agents import Agent
from rssnav.kernels import common
from rssnav.learning_rules import Learner, LearningProblem
from rssnav.training import generator_states
from rssnav.world import ACTIONS, GridWorld

EPISODES = 1500
ROUNDS = 7

needs_compiler = pytest.mark.skipif(COMPILER is None, reason="needs a C compiler")


def hall_with_pillars(n_x: int = 96, n_y: int = 26) -> GridWorld:
    """A world of the paper's size: open floor, with every third cell of every third row blocked."""
    i_x, i_y = np.meshgrid(np.arange(n_x), np.arange(n_y))
    free = ~((i_x % 3 == 1) & (i_y % 3 == 1))
    state_of = np.full((n_y + 2, n_x + 2), -1, dtype=np.int32)
    cell = np.argwhere(free)
    state_of[1:-1, 1:-1][free] = np.arange(len(cell))
    there = cell[:, None, :] + ACTIONS[None, :, ::-1] + 1
    position = cell[:, ::-1] + 0.5
    distance_m = np.hypot(*(position - (5.0, 14.0)).T)
    rss_dbm = -20.5 - 22.0 * np.log10(distance_m / 1.9) + 2.0 * np.sin(np.arange(len(cell)))
    rss_dbm[distance_m < 2.0] = -20.0 + 1e-3 * np.arange(np.count_nonzero(distance_m < 2.0))
    return GridWorld(
        next_state=state_of[there[..., 0], there[..., 1]],
        rss_dbm=rss_dbm,
        position=position,
        cell=cell.astype(np.int32),
        distance_m=distance_m,
        start_state=int(state_of[3, 94]),
        speed=1,
        step_length_m=np.hypot(*ACTIONS.T),
        shape=(n_y, n_x),
        source=(5.0, 14.0, 1.5),
        plan_name="hall with pillars",
        plan_sha256="0" * 64,
    )


def fly_all(learner: Learner, episodes: int) -> None:
    while learner.run.counters[common.EPISODE] < episodes:
        learner.advance(episodes)


AGENTS = pytest.mark.parametrize("agent", [RssAgent(), LocationAgent()], ids=["rss", "location"])


@needs_compiler
@AGENTS
def test_c_loop_gives_the_same_results(agent: Agent, tmp_path):
    problem = LearningProblem.of(hall_with_pillars(), agent, QLearning())
    learner = problem.learner(generator_states(0, 0), 100)
    fly_all(learner, 100)
    library = build(tmp_path, "-ffp-contract=off")
    for function in ("learn_plain", "learn_cached"):
        run = CRun(problem, generator_states(0, 0), 100)
        run.learn(library, function)
        assert np.array_equal(run.steps, learner.run.episodes[:, common.STEPS]), function
        assert np.array_equal(run.visits, learner.run.visits), function
        assert np.array_equal(run.q, learner.run.q), function


@needs_compiler
@AGENTS
def test_bench_kernel_beside_c(agent: Agent, tmp_path, benchmark):
    episodes = EPISODES if benchmark.enabled else 20
    problem = LearningProblem.of(hall_with_pillars(), agent, QLearning())
    library = build(tmp_path)
    rates: dict[str, list[float]] = {"kernel": [], "learn_plain": [], "learn_cached": []}

    def one_round() -> None:
        learner = problem.learner(generator_states(0, 0), episodes)
        begin = time.thread_time()
        fly_all(learner, episodes)
        seconds = time.thread_time() - begin
        rates["kernel"].append(learner.run.counters[common.TOTAL_STEPS] / seconds)
        for function in ("learn_plain", "learn_cached"):
            run = CRun(problem, generator_states(0, 0), episodes)
            begin = time.thread_time()
            run.learn(library, function)
            rates[function].append(run.steps.sum() / (time.thread_time() - begin))

    benchmark.pedantic(one_round, rounds=ROUNDS, warmup_rounds=1)
    best = {name: max(values) / 1e6 for name, values in rates.items()}
    benchmark.extra_info.update(best)
    kernel, plain, cached = best.values()
    print(
        f"\n{agent.name}: kernel {kernel:.1f}, C {plain:.1f}, C with cached maxima {cached:.1f} "
        f"million steps a second; ratios {kernel / plain:.2f} and {kernel / cached:.2f}"
    )


@pytest.mark.skipif(n_threads(None) < 2, reason="needs two cores")
def test_bench_two_threads_beside_one(benchmark):
    world = hall_with_pillars()
    episodes = EPISODES if benchmark.enabled else 20
    seconds: dict[int, list[float]] = {1: [], 2: []}
    cpu: dict[int, list[float]] = {1: [], 2: []}

    def one_round() -> None:
        for threads, taken in seconds.items():
            begin = time.perf_counter()
            result = train(world, LocationAgent(), runs=8, episodes=episodes, threads=threads)
            taken.append(time.perf_counter() - begin)
            cpu[threads].append(result.cpu_s.sum())

    benchmark.pedantic(one_round, rounds=ROUNDS, warmup_rounds=1)
    one, two = (min(taken) for taken in seconds.values())
    benchmark.extra_info.update(one_thread_s=one, two_threads_s=two)
    print(
        f"\ntwo threads are {one / two:.2f} times as fast as one ({one:.2f} s, {two:.2f} s); CPU "
        f"time in the loop {min(cpu[1]):.2f} s and {min(cpu[2]):.2f} s"
    )
