"""The first episodes of each realisation: its visits, and the policy it has learned.

A training stores visits summed over its realisations, and its final flights are those at
convergence. Each realisation can be repeated separately, step for step, so its first episodes are
trained again: this gives visits per realisation, for intervals over realisations, and the greedy
flight after the episodes that the paper shows.
"""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from raytrace.threads import n_threads
from rssnav.results import TrainingResult
from rssnav.training import train


@dataclass(frozen=True, eq=False)
class FirstEpisodes:
    """Visits and flights of R realisations in their first episodes.

    Attributes
    ----------
    early : int
        Episodes that the visits are counted over.
    visits : (R, S) int64
        Visits of each state in these episodes.
    episodes : int
        Episodes after which the policy is evaluated.
    reached : (R,) bool
        Whether the greedy flight of this policy reaches the source.
    path_steps : (R,) int64
        Steps of that flight.
    """

    early: int
    visits: NDArray[np.int64]
    episodes: int
    reached: NDArray[np.bool_]
    path_steps: NDArray[np.int64]


def first_episodes(
    result: TrainingResult,
    early: int,
    episodes: int,
    *,
    threads: int | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> FirstEpisodes:
    """Repeat the first episodes of each realisation of a training.

    Parameters
    ----------
    result : TrainingResult
        The training whose realisations are repeated.
    early : int
        Episodes to count visits over.
    episodes : int
        Episodes to train, at least ``early``.
    threads : int, optional
        Threads; realisations run in parallel.
    progress : callable, optional
        Called as ``progress(done, runs)``.
    """

    def repeat(run_id: int) -> TrainingResult:
        return train(
            result.world,
            result.agent,
            runs=result.schedule.runs,
            episodes=episodes,
            seed=result.schedule.seed,
            learning=result.learning,
            snapshot_episodes=(early,),
            only_runs=[run_id],
            threads=1,
        )

    repeated: list[TrainingResult] = []
    with ThreadPoolExecutor(n_threads(threads)) as pool:
        for each in pool.map(repeat, result.run_ids.tolist()):
            repeated.append(each)
            if progress is not None:
                progress(len(repeated), result.run_ids.size)
    return FirstEpisodes(
        early,
        np.concatenate([each.visit_counts for each in repeated]),
        episodes,
        np.concatenate([each.reached for each in repeated]),
        np.concatenate([each.path_steps for each in repeated]),
    )
