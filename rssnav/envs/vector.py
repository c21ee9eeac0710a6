"""Many environments in one compiled step."""

from __future__ import annotations

from typing import Any

import numpy as np
from gymnasium import vector
from gymnasium.utils import seeding
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from rssnav.arguments import require
from rssnav.envs.options import EnvOptions
from rssnav.envs.spaces import action_space, observation_space, observed
from rssnav.envs.state import EnvState
from rssnav.kernels import fleet as kernel
from rssnav.kernels.stepping import FOUND, TRUNCATED

_MODES = ("NextStep", "SameStep")


class NavigationVectorEnv(vector.VectorEnv[Any, Any, Any]):
    """N UAVs in one mission, equal to `SyncVectorEnv` of `NavigationEnv` to the last bit.

    Parameters
    ----------
    options : EnvOptions
        World, aim and senses.
    num_envs : int
        N.
    autoreset_mode : {"NextStep", "SameStep"} or gymnasium.vector.AutoresetMode
        When the next episode begins; with the latter the last observation of the ended one is
        ``info["final_obs"]``.

    Raises
    ------
    ValueError
        For no environment, or another autoreset mode.
    """

    def __init__(
        self, options: EnvOptions, num_envs: int = 1, *, autoreset_mode: Any = "NextStep"
    ) -> None:
        require(num_envs >= 1, "num_envs", num_envs, "at least 1")
        mode = str(getattr(autoreset_mode, "value", autoreset_mode))
        require(mode in _MODES, "autoreset_mode", autoreset_mode, " or ".join(_MODES))
        self.options, self.num_envs = options, num_envs
        self._state = EnvState(options, num_envs)
        self._same_step = mode == "SameStep"
        self.metadata = {"render_modes": [], "autoreset_mode": _autoreset(mode)}
        self.single_action_space = action_space(options)
        self._n_actions = int(self.single_action_space.n)
        self.single_observation_space = observation_space(options, self._state.mission)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self._ended = np.zeros(num_envs, dtype=np.int8)
        self._all = np.ones(num_envs, dtype=np.bool_)

    def reset(
        self, *, seed: int | list[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Any, dict[str, Any]]:
        """Begin an episode of every environment, or of those in ``options["reset_mask"]``.

        Parameters
        ----------
        seed : int, list of int, or None
            Of each environment, or of the first: the others have the numbers that follow.
        options : dict, optional
            ``reset_mask`` (N,) bool.

        Raises
        ------
        ValueError
            For another number of seeds than environments.
        """
        chosen = self._all if options is None else options.get("reset_mask", self._all)
        seeds: list[int | None] = (
            [None if seed is None else seed + i for i in range(self.num_envs)]
            if seed is None or isinstance(seed, int | np.integer)
            else seed
        )
        if len(seeds) != self.num_envs:
            raise ValueError(f"seed: {len(seeds)} seeds for {self.num_envs} environments")
        if seeds[0] is not None:
            self._np_random, self._np_random_seed = seeding.np_random(seeds[0])
        self._state.seed(seeds)
        self._state.reset(np.asarray(chosen, dtype=np.bool_))
        masks = self._state.masks
        return self._observed(masks), self._info(masks)

    def step(
        self, actions: Any
    ) -> tuple[Any, NDArray[np.float64], NDArray[np.bool_], NDArray[np.bool_], dict[str, Any]]:
        """Step every environment; an impossible action leaves its UAV where it is.

        Parameters
        ----------
        actions : (N,) int
            One for each environment.

        Returns
        -------
        observations, rewards, terminated, truncated, info
            As in Gymnasium; the three in the middle have shape (N,).

        Raises
        ------
        ValueError
            For actions of another shape or number.
        """
        state = self._state
        chosen = np.ascontiguousarray(actions, dtype=np.int64)
        if chosen.shape != (self.num_envs,):
            raise ValueError(f"actions: shape {chosen.shape}, expected ({self.num_envs},)")
        known = kernel.step_all(
            state.moves,
            state.sensor,
            state.steady,
            state.fleet,
            state.view,
            chosen,
            self._n_actions,
            self._same_step,
            self._ended,
        )
        if not known:
            raise ValueError(f"actions: expected 0 to {self._n_actions - 1}")
        terminated, truncated = self._ended == FOUND, self._ended == TRUNCATED
        masks = state.masks
        info = self._info(masks)
        if self._same_step and self._ended.any():
            self._add_final(info, terminated | truncated)
        return self._observed(masks), state.fleet.reward.copy(), terminated, truncated, info

    def action_masks(self) -> NDArray[np.bool_]:
        """Possible actions of each environment, (N, actions)."""
        return self._state.masks.astype(np.bool_)

    def _observed(self, masks: NDArray[np.int8]) -> Any:
        view, mission = self._state.view, self._state.mission
        return observed(self.options, mission, view.history, view.cells, masks)

    def _info(self, masks: NDArray[np.int8]) -> dict[str, Any]:
        return {"action_mask": masks.copy(), "_action_mask": self._all.copy()}

    def _add_final(self, info: dict[str, Any], ended: NDArray[np.bool_]) -> None:
        """Add the last observation and info of the episodes that ended, as `SyncVectorEnv` has."""
        view, which = self._state.view, np.flatnonzero(ended)
        masks = self._state.with_hover(view.final_masks)
        mission = self._state.mission
        final = observed(self.options, mission, view.final_history, view.final_cells, masks)
        found = np.full(self.num_envs, None, dtype=np.object_)
        for i in which.tolist():
            found[i] = {k: v[i] for k, v in final.items()} if isinstance(final, dict) else final[i]
        masks[~ended] = 0
        info |= {
            "final_obs": found,
            "_final_obs": ended.copy(),
            "final_info": {"action_mask": masks, "_action_mask": ended.copy()},
            "_final_info": ended.copy(),
        }


def _autoreset(mode: str) -> Any:
    """Gymnasium's name of a mode; before 1.1 it had none."""
    names = getattr(vector, "AutoresetMode", None)
    return mode if names is None else names(mode)
