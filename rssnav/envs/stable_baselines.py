"""`NavigationVectorEnv` as the `VecEnv` of Stable-Baselines3 (needs the extra ``rssnav[sb3]``).

>>> import gymnasium
>>> from sb3_contrib import MaskablePPO
>>> from rssnav.envs.stable_baselines import NavigationVecEnv
>>> env = NavigationVecEnv(256, plan="scenario1", observation="history")
>>> agent = MaskablePPO("MlpPolicy", env, n_steps=64).learn(100_000)
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from raytrace.extras import needs_extra
from rssnav.envs.options import EnvOptions
from rssnav.envs.vector import NavigationVectorEnv

with needs_extra("sb3"):
    from stable_baselines3.common.vec_env import (  # pyright: ignore[reportMissingImports]
        VecEnv,  # pyright: ignore[reportUnknownVariableType]
    )

Indices = int | Sequence[int] | None


class NavigationVecEnv(VecEnv):  # pyright: ignore[reportUntypedBaseClass]
    """N UAVs in one mission, stepped together, for the learners of Stable-Baselines3.

    A new episode begins in the step that ends one; the last observation of the ended one is
    ``infos[i]["terminal_observation"]``. ``action_masks`` is what MaskablePPO of sb3-contrib asks
    for.

    Parameters
    ----------
    num_envs : int
        N.
    **options
        See `rssnav.envs.options.EnvOptions`.
    """

    def __init__(self, num_envs: int, **options: Any) -> None:
        self.vector = NavigationVectorEnv(
            EnvOptions.of(**options), num_envs, autoreset_mode="SameStep"
        )
        self.render_mode = None
        super().__init__(
            num_envs, self.vector.single_observation_space, self.vector.single_action_space
        )

    def reset(self) -> Any:
        """Begin an episode of every environment, with the seeds that ``seed`` set."""
        observations, _ = self.vector.reset(seed=self._seeds)
        self._reset_seeds()
        self._reset_options()
        return observations

    def step_async(self, actions: NDArray[np.integer]) -> None:
        """Keep the actions of the next step."""
        self._actions = actions

    def step_wait(self) -> tuple[Any, NDArray[np.float32], NDArray[np.bool_], list[dict[str, Any]]]:
        """Step every environment: observations, rewards, ends and infos."""
        seen, reward, terminated, truncated, info = self.vector.step(self._actions)
        ended = terminated | truncated
        infos: list[dict[str, Any]] = [{} for _ in range(self.num_envs)]
        for i in np.flatnonzero(ended).tolist():
            infos[i] = {
                "terminal_observation": info["final_obs"][i],
                "TimeLimit.truncated": bool(truncated[i]),
            }
        return seen, reward.astype(np.float32), ended, infos

    def action_masks(self) -> NDArray[np.bool_]:
        """Possible actions of each environment, (N, actions)."""
        return self.vector.action_masks()

    def close(self) -> None:
        """Nothing is held open."""

    def has_attr(self, attr_name: str) -> bool:
        """Whether the environments have an attribute or a method."""
        return hasattr(self, attr_name)

    def get_attr(self, attr_name: str, indices: Indices = None) -> list[Any]:
        """Attribute of the environments, which is the same of each."""
        return [getattr(self, attr_name)] * len(self._chosen(indices))

    def set_attr(self, attr_name: str, value: Any, indices: Indices = None) -> None:
        """Refuse: the environments are one object."""
        raise NotImplementedError(f"{attr_name}: give options when the environments are made")

    def env_method(
        self, method_name: str, *method_args: Any, indices: Indices = None, **method_kwargs: Any
    ) -> list[Any]:
        """Result of a method for the chosen environments; there is ``action_masks``."""
        if method_name != "action_masks":
            raise AttributeError(f"{method_name}: the environments have action_masks() only")
        return list(self.action_masks()[self._chosen(indices)])

    def env_is_wrapped(self, wrapper_class: type, indices: Indices = None) -> list[bool]:
        """No environment is wrapped alone."""
        return [False] * len(self._chosen(indices))

    def _chosen(self, indices: Indices) -> list[int]:
        if indices is None:
            return list(range(self.num_envs))
        return [indices] if isinstance(indices, int) else list(indices)
