import math
from dataclasses import replace

import numpy as np
import pytest

from rssnav import (
    Fluctuation,
    IntervalStates,
    LocationAgent,
    QLearning,
    RssAgent,
    ToleranceStates,
    TrainingInterrupted,
    train,
)

LEARNING = QLearning(eta=1e-3, max_steps=500)
PER_RUN = (
    "steps",
    "diagonal_steps",
    "truncated",
    "episodes_flown",
    "converged_episode",
    "converged_steps",
    "trajectories",
    "reached",
    "path_steps",
    "path_length_m",
    "n_discrete_states",
)


def assert_equal_runs(one, other, rows=slice(None), other_rows=slice(None)):
    for name in PER_RUN:
        a, b = getattr(one, name)[rows], getattr(other, name)[other_rows]
        if a.ndim == 2:
            width = max(a.shape[1], b.shape[1])
            a, b = (
                np.pad(x, ((0, 0), (0, width - x.shape[1])), constant_values=-1) for x in (a, b)
            )
        assert np.array_equal(a, b), name


AGENTS = pytest.mark.parametrize(
    "agent",
    [
        RssAgent(),
        LocationAgent(),
        RssAgent(ToleranceStates(0.5), fluctuation=Fluctuation(0.2, 0.5)),
        RssAgent(IntervalStates.uniform(-40.0, -20.0, 1.0)),
    ],
    ids=["rss", "location", "tolerance with fluctuation", "intervals"],
)


@AGENTS
def test_the_number_of_threads_changes_nothing(room_world, agent):
    one = train(room_world, agent, runs=6, episodes=60, learning=LEARNING, threads=1)
    many = train(room_world, agent, runs=6, episodes=60, learning=LEARNING, threads=4)
    assert_equal_runs(one, many)
    assert np.array_equal(one.visit_counts, many.visit_counts)


@AGENTS
def test_a_run_alone_is_the_run_of_the_whole(room_world, agent):
    options = {"runs": 6, "episodes": 200, "learning": LEARNING, "until_converged": True}
    whole = train(room_world, agent, **options)
    alone = train(room_world, agent, **options, only_runs=[4])
    assert alone.run_ids.tolist() == [4]
    assert not alone.complete
    assert_equal_runs(alone, whole, other_rows=slice(4, 5))


def test_seeds_and_runs_differ(room_world):
    first = train(room_world, RssAgent(), runs=2, episodes=20, seed=0)
    second = train(room_world, RssAgent(), runs=2, episodes=20, seed=1)
    assert not np.array_equal(first.steps[0], first.steps[1])
    assert not np.array_equal(first.steps, second.steps)


def test_training_stops_at_convergence_and_not_before(room_world):
    options = {"runs": 5, "episodes": 3000, "learning": LEARNING}
    stopped = train(room_world, RssAgent(), until_converged=True, min_episodes=1, **options)
    fixed = train(room_world, RssAgent(), **options)
    assert np.all(stopped.converged_episode > 2)
    assert np.array_equal(stopped.converged_episode, fixed.converged_episode)
    assert np.array_equal(stopped.episodes_flown, stopped.converged_episode)
    assert np.all(fixed.episodes_flown == 3000)
    for row, last in enumerate(stopped.converged_episode):
        assert np.array_equal(stopped.steps[row, :last], fixed.steps[row, :last])
        assert np.all(stopped.steps[row, last:] == -1)
        assert stopped.converged_steps[row] == stopped.steps[row, :last].sum()
        assert len(set(stopped.steps[row, last - 3 : last])) == 1


def test_min_episodes_are_flown_after_convergence(room_world):
    result = train(
        room_world,
        RssAgent(),
        runs=3,
        episodes=3000,
        learning=LEARNING,
        until_converged=True,
        min_episodes=1500,
        snapshot_episodes=(100, 1500, 2000),
    )
    assert np.all(result.episodes_flown == np.maximum(result.converged_episode, 1500))
    assert result.schedule.snapshot_episodes == (100, 1500)


def test_a_run_that_cannot_converge_says_so(room_world):
    restless = QLearning(eta=0.0, max_steps=500)
    result = train(
        room_world, RssAgent(), runs=2, episodes=50, learning=restless, until_converged=True
    )
    assert np.all(result.converged_episode == -1)
    assert np.all(result.converged_steps == -1)
    assert np.all(result.episodes_flown == 50)


def test_capped_episodes_are_truncated_and_never_converge(room_world):
    short = QLearning(epsilon_max=0.0, epsilon_min=0.0, max_steps=3)
    result = train(room_world, LocationAgent(), runs=1, episodes=50, learning=short)
    assert result.truncated.all()
    assert np.all(result.steps == 3)
    assert np.all(result.converged_episode == -1)


def test_visits_count_every_state_occupied(room_world):
    result = train(room_world, RssAgent(), runs=4, episodes=30, snapshot_episodes=(10, 30))
    for snapshot, episodes in enumerate((10, 30)):
        occupied = result.steps[:, :episodes].sum() + 4 * episodes
        assert result.visit_counts[snapshot].sum() == occupied
        assert result.visits[snapshot].sum() == pytest.approx(occupied / 4)
    assert result.visits.shape == (2, 5, 8)
    assert np.all(result.visit_counts[1] >= result.visit_counts[0])


def test_episode_lengths_add_up(room_world):
    result = train(room_world, RssAgent(), runs=2, episodes=5)
    straight = result.steps - result.diagonal_steps
    expected = straight + np.sqrt(2.0) * result.diagonal_steps
    assert np.allclose(result.episode_length_m, expected)


def test_the_final_flight_begins_at_the_start_and_ends_at_the_goal(room_world):
    result = train(room_world, LocationAgent(), runs=3, episodes=1000, learning=LEARNING)
    for k in range(3):
        positions = result.trajectory_m(k)
        assert tuple(positions[0]) == (6.5, 1.5)
        assert np.hypot(*(positions[-1] - room_world.source[:2])) < 2.0
        steps = np.hypot(*np.diff(positions, axis=0).T)
        assert len(steps) == result.path_steps[k]
        assert steps.sum() == pytest.approx(result.path_length_m[k])


def test_tolerance_states_get_along_with_fluctuation(room_world):
    """With Th well above the fluctuation and below the cells' differences, learning succeeds."""
    agent = RssAgent(ToleranceStates(0.3), fluctuation=Fluctuation(0.01))
    result = train(room_world, agent, runs=3, episodes=2000, learning=LEARNING)
    assert result.reached.all()
    assert np.all(result.n_discrete_states < 2 * room_world.n_states)


def test_progress_counts_the_runs(room_world):
    seen = []
    train(
        room_world,
        RssAgent(),
        runs=5,
        episodes=5,
        progress=lambda done, runs: seen.append((done, runs)),
    )
    assert seen == [(k, 5) for k in range(1, 6)]


def interrupted_after(runs_done):
    def progress(done, runs):
        if done == runs_done:
            raise KeyboardInterrupt

    return progress


def test_an_interrupt_keeps_the_finished_runs_and_resumes_to_the_same_result(room_world):
    options = {"runs": 8, "episodes": 50, "learning": LEARNING, "keep_q": True}
    whole = train(room_world, RssAgent(), **options)
    with pytest.raises(TrainingInterrupted, match=r"interrupted with \d+ finished") as caught:
        train(room_world, RssAgent(), **options, threads=1, progress=interrupted_after(3))
    part = caught.value.result
    assert part is not None
    assert not part.complete
    assert 3 <= part.run_ids.size < 8
    resumed = train(room_world, RssAgent(), **options, resume=part)
    assert resumed.complete
    assert_equal_runs(resumed, whole)
    assert np.array_equal(resumed.visit_counts, whole.visit_counts)
    assert np.array_equal(resumed.q, whole.q)


def test_resuming_a_complete_result_trains_nothing(room_world):
    whole = train(room_world, RssAgent(), runs=2, episodes=5)
    again = train(room_world, RssAgent(), runs=2, episodes=5, resume=whole)
    assert_equal_runs(whole, again)


@pytest.mark.parametrize(
    ("name", "changes"),
    [
        ("agent", {"agent": LocationAgent()}),
        ("learning", {"learning": QLearning(gamma=0.9)}),
        ("schedule", {"seed": 1}),
    ],
)
def test_resuming_another_training_is_refused(room_world, name, changes):
    part = train(room_world, RssAgent(), runs=2, episodes=5, only_runs=[0])
    options = {"agent": RssAgent(), **changes}
    with pytest.raises(ValueError, match=f"a different {name}"):
        train(room_world, runs=2, episodes=5, resume=part, **options)


def test_resuming_in_another_world_is_refused(room_world):
    part = train(room_world, RssAgent(), runs=2, episodes=5, only_runs=[0])
    louder = replace(room_world, rss_dbm=room_world.rss_dbm + 0.1)
    with pytest.raises(ValueError, match="a different radio map"):
        train(louder, RssAgent(), runs=2, episodes=5, resume=part)


def test_a_run_cannot_be_merged_with_itself(room_world):
    part = train(room_world, RssAgent(), runs=2, episodes=5, only_runs=[0])
    with pytest.raises(ValueError, match="in both results"):
        part.merged(part)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("runs", 0),
        ("runs", 2.5),
        ("episodes", 0),
        ("seed", -1),
        ("seed", 2**64),
        ("seed", 10**400),
        ("runs", 10**9),
        ("runs", float("nan")),
        ("episodes", float("inf")),
        ("min_episodes", 0),
        ("threads", 0),
        ("snapshot_episodes", (0,)),
        ("only_runs", (100,)),
        ("only_runs", ()),
    ],
)
def test_options_out_of_range_are_refused_by_name(room_world, name, value):
    with pytest.raises(ValueError, match=f"^{name}"):
        train(room_world, RssAgent(), **{"runs": 2, "episodes": 2, name: value})


def test_a_run_that_has_flown_its_steps_begins_no_more_episodes(room_world):
    options = {"runs": 3, "learning": LEARNING, "seed": 5}
    whole = train(room_world, RssAgent(), episodes=400, **options)
    budget = train(room_world, RssAgent(), episodes=400, max_total_steps=1500, **options)
    flown = budget.episodes_flown
    assert np.all(flown < 400)
    for run in range(3):
        assert np.array_equal(budget.steps[run, : flown[run]], whole.steps[run, : flown[run]])
        assert budget.steps[run, : flown[run]].sum() >= 1500
        assert budget.steps[run, : flown[run] - 64].sum() < 1500
    assert budget.visit_counts.shape == (0, room_world.n_states)


def test_a_step_budget_survives_the_file(room_world, tmp_path):
    result = train(room_world, RssAgent(), runs=1, episodes=9, max_total_steps=50)
    result.save(tmp_path / "result.h5")
    assert type(result).load(tmp_path / "result.h5").schedule == result.schedule


def test_results_do_not_depend_on_the_types_of_numbers(room_world):
    learning = replace(LEARNING, gamma=1.0, goal_reward=8.0, initial_q=4.0)
    others = {"gamma": 1, "goal_reward": np.int64(8), "initial_q": np.float32(4), "max_steps": 5e2}
    expected = train(room_world, LocationAgent(), runs=2, episodes=20, learning=learning)
    found = train(
        room_world, LocationAgent(), runs=2, episodes=20, learning=replace(learning, **others)
    )
    assert_equal_runs(found, expected)


@pytest.mark.parametrize("steps", [0, 0.5, 2**31, math.inf, math.nan])
def test_a_limit_of_steps_is_an_integer(steps):
    with pytest.raises(ValueError, match=r"max_steps = .*: expected an integer"):
        QLearning(max_steps=steps)
