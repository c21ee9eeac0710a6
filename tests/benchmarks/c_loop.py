"""Builds q_loop.c and runs it on the tables of a learning problem."""

from __future__ import annotations

import ctypes
import shutil
import subprocess
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from rssnav.learning_rules import LearningProblem

SOURCE = Path(__file__).with_name("q_loop.c")
COMPILER = shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")


class _Moves(ctypes.Structure):
    _fields_ = [
        (name, ctypes.c_void_p)
        for name in ("next_state", "possible", "n_possible", "terminal", "reward")
    ] + [("start", ctypes.c_int64)]


class _Parameters(ctypes.Structure):
    _fields_ = [
        (name, ctypes.c_double) for name in ("gamma", "epsilon_min", "alpha_min", "decay")
    ] + [("max_steps", ctypes.c_int64)]


class _Run(ctypes.Structure):
    _fields_ = [
        (name, ctypes.c_void_p)
        for name in ("q", "best_value", "best_action", "visits", "generator")
    ] + [
        ("epsilon", ctypes.c_double),
        ("alpha", ctypes.c_double),
        ("steps", ctypes.c_void_p),
        ("path_hash", ctypes.c_void_p),
    ]


def build(folder: Path, *flags: str) -> ctypes.CDLL:
    """Compile the loop with -O3 -march=native and further flags."""
    library = folder / f"q_loop{len(list(folder.iterdir()))}.so"
    command = [str(COMPILER), "-O3", "-march=native", *flags, "-shared", "-fPIC"]
    subprocess.run([*command, str(SOURCE), "-o", str(library)], check=True)
    return ctypes.CDLL(str(library))


class CRun:
    """One realisation of a tabular problem, learnt by the C loop."""

    def __init__(
        self, problem: LearningProblem, generator: NDArray[np.uint64], episodes: int
    ) -> None:
        twin = problem.learner(generator, episodes)
        run, moves, greedy = twin.run, twin.moves, twin.greedy
        self.episodes = episodes
        self.q, self.visits = run.q.copy(), run.visits.copy()
        self.steps = np.zeros(episodes, dtype=np.int32)
        self.path_hash = np.zeros(episodes, dtype=np.uint64)
        reward = np.ascontiguousarray(problem.process.reward)
        parameters = twin.parameters
        self._keep = (twin, reward, greedy.value.copy(), greedy.action.copy(), generator.copy())
        self._moves = _Moves(
            moves.next_state.ctypes.data,
            moves.possible.ctypes.data,
            moves.n_possible.ctypes.data,
            moves.terminal.ctypes.data,
            reward.ctypes.data,
            int(moves.starts[0]),
        )
        self._parameters = _Parameters(
            parameters.gamma,
            parameters.epsilon_min,
            parameters.alpha_min,
            parameters.step_decay,
            parameters.max_steps,
        )
        self._run = _Run(
            self.q.ctypes.data,
            self._keep[2].ctypes.data,
            self._keep[3].ctypes.data,
            self.visits.ctypes.data,
            self._keep[4].ctypes.data,
            problem.learning.epsilon_max,
            problem.learning.alpha_max,
            self.steps.ctypes.data,
            self.path_hash.ctypes.data,
        )

    def learn(self, library: ctypes.CDLL, function: str) -> None:
        """Fly all episodes with ``learn_plain`` or ``learn_cached``."""
        getattr(library, function)(
            ctypes.byref(self._moves),
            ctypes.byref(self._parameters),
            ctypes.byref(self._run),
            ctypes.c_int64(self.episodes),
        )
