"""One environment."""

from __future__ import annotations

from typing import Any

import gymnasium
import numpy as np
from numpy.typing import NDArray

from rssnav.envs.options import EnvOptions
from rssnav.envs.rendering import as_text, picture
from rssnav.envs.spaces import action_space, observation_space, observed
from rssnav.envs.state import EnvState
from rssnav.kernels import fleet as kernel
from rssnav.kernels.stepping import FOUND, MODE, TRUNCATED

_ONE = np.ones(1, dtype=np.bool_)


class NavigationEnv(gymnasium.Env[Any, Any]):
    """A UAV that looks for a radio source indoors.

    An impossible action leaves it where it is. ``info["action_mask"]`` holds the possible ones.

    Parameters
    ----------
    options : EnvOptions
        World, aim and senses.
    render_mode : {"rgb_array", "ansi"}, optional
        What :meth:`render` returns: a picture of the map, walls, trail, UAV and source in which
        cells that were not visited are dimmed, or the same as text.

    Raises
    ------
    ValueError
        For another render mode.
    """

    metadata: dict[str, Any] = {"render_modes": ["rgb_array", "ansi"], "render_fps": 8}

    def __init__(self, options: EnvOptions, *, render_mode: str | None = None) -> None:
        modes = self.metadata["render_modes"]
        if render_mode is not None and render_mode not in modes:
            raise ValueError(f"render_mode: {render_mode!r}, expected one of {', '.join(modes)}")
        self.options, self.render_mode = options, render_mode
        self._state = EnvState(options, 1)
        self.mission = self._state.mission
        self.action_space = action_space(options)
        self._n_actions = int(self.action_space.n)
        self.observation_space = observation_space(options, self.mission)
        self._action = np.zeros(1, dtype=np.int64)
        self._ended = np.zeros(1, dtype=np.int8)
        self.trail: list[int] = []
        self._lists = _SteadyLists(self._state, options) if self._state.steady else None

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Any, dict[str, Any]]:
        """Begin an episode.

        Parameters
        ----------
        seed : int, optional
            Of all random numbers from now on.
        options : dict, optional
            Ignored.

        Returns
        -------
        observation, info
            What the UAV sees, and ``action_mask`` (n_actions,) bool among others.
        """
        super().reset(seed=seed)
        state = self._state
        if seed is not None or not state.seeded:
            state.start_stream(0, self.np_random)
        state.reset(_ONE)
        self.trail = [int(state.view.cells[0])]
        if self._lists is not None:
            return self._lists.reset(self.trail[0])
        return self._observed(), self._info()

    def step(self, action: Any) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        """Fly an action.

        Parameters
        ----------
        action : int
            0 to 7, counter-clockwise from +x; further ones as the options allow.

        Returns
        -------
        observation, reward, terminated, truncated, info
            As in Gymnasium; terminated when the source is found.

        Raises
        ------
        ValueError
            For another action, and before `reset`.
        """
        if self._lists is not None:
            result = self._lists.step(int(action))
            self.trail.append(self._lists.cell)
            return result
        if not self.trail or not self.action_space.contains(action):
            raise ValueError(
                f"action {action!r}: expected 0 to {self._n_actions - 1}, after reset()"
            )
        self._action[0] = action
        state = self._state
        self._step()
        self.trail.append(int(state.view.cells[0]))
        ended, reward = int(self._ended[0]), float(state.fleet.reward[0])
        return self._observed(), reward, ended == FOUND, ended == TRUNCATED, self._info()

    def _step(self) -> None:
        state = self._state
        kernel.step_all(
            state.moves,
            state.sensor,
            state.steady,
            state.fleet,
            state.view,
            self._action,
            self._n_actions,
            False,
            self._ended,
        )

    def action_masks(self) -> NDArray[np.bool_]:
        """Possible actions (n_actions,); the name that MaskablePPO of sb3-contrib looks for."""
        if self._lists is not None:
            return self._lists.mask().astype(np.bool_)
        return self._state.masks[0].astype(np.bool_)

    def render(self) -> Any:
        """Picture (height, width, 3) uint8 or text, by the render mode; None without one."""
        if self.render_mode is None or not self.trail:
            return None
        mode = int(self._state.fleet.whole[0, MODE])
        draw = picture if self.render_mode == "rgb_array" else as_text
        return draw(self.mission, mode, self.trail)

    def _observed(self) -> Any:
        view = self._state.view
        many = observed(self.options, self.mission, view.history, view.cells, self._state.masks)
        if isinstance(many, dict):
            return {name: values[0] for name, values in many.items()}
        return np.int64(many[0]) if self.options.observation == "cell" else many[0]

    def _info(self) -> dict[str, Any]:
        return {"action_mask": self._state.masks[0].copy()}


class _SteadyLists:
    """The step where nothing is drawn, on Python's lists: a compiled call costs more than it.

    `rssnav.kernels.stepping.fly_steady` in Python; tests compare them bit for bit.
    """

    def __init__(self, state: EnvState, options: EnvOptions) -> None:
        steady = state.steady
        assert steady is not None
        own = np.arange(state.mission.n_states)[:, None]
        next_state = state.mission.next_state[0]
        arrived = np.where(next_state >= 0, next_state, own)
        if options.hover:
            arrived = np.hstack((arrived, own))
        self._next: list[list[int]] = arrived.tolist()
        self._rss: list[float] = steady.rss_dbm.tolist()
        self._found: list[bool] = steady.found.tolist()
        self._task, self._arrival = steady.task, steady.task.arrival.tolist()
        masks = state.with_hover(state.view.mask_of)
        self._masks = list(np.ascontiguousarray(masks))
        self._kind, self._k = options.observation, options.history
        self._position = list(state.mission.layout.position)
        self._n_actions = len(self._next[0])
        self.cell, self._seconds = -1, 0

    def reset(self, cell: int) -> tuple[Any, dict[str, Any]]:
        self.cell, self._seconds = cell, 0
        self._history = [self._rss[cell]] * self._k
        return self._see(cell), {"action_mask": self._masks[cell].copy()}

    def mask(self) -> NDArray[np.int8]:
        return self._masks[self.cell]

    def step(self, action: int) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        here, task = self.cell, self._task
        if here < 0 or not 0 <= action < self._n_actions:
            raise ValueError(
                f"action {action!r}: expected 0 to {self._n_actions - 1}, after reset()"
            )
        there = self.cell = self._next[here][action]
        self._seconds += 1
        reward = self._rss[there] - self._rss[here] if task.difference else 0.0
        if self._arrival:
            reward += self._arrival[there]
        found = self._found[there]
        if found and task.goal_replaces:
            reward = 0.0
        reward += task.per_second
        if found:
            reward += task.goal_reward
        truncated = not found and self._seconds >= task.max_seconds
        info = {"action_mask": self._masks[there].copy()}
        return self._see(there), reward, found, truncated, info

    def _see(self, cell: int) -> Any:
        reading = self._rss[cell]
        if self._kind == "rss":
            return np.array([reading])
        if self._kind == "cell":
            return np.int64(cell)
        if self._kind == "history":
            self._history = [*self._history[1:], reading]
            return np.array(self._history)
        return {
            "rss": np.array([reading]),
            "position": self._position[cell].copy(),
            "action_mask": self._masks[cell].copy(),
        }
