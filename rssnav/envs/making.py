"""Entry points of the ids."""

from __future__ import annotations

from typing import Any

from rssnav.envs.options import EnvOptions
from rssnav.envs.single import NavigationEnv
from rssnav.envs.vector import NavigationVectorEnv


def make_env(*, render_mode: str | None = None, **options: Any) -> NavigationEnv:
    """Make one environment (`EnvOptions`)."""
    return NavigationEnv(EnvOptions.of(**options), render_mode=render_mode)


def make_vector_env(
    num_envs: int = 1, *, autoreset_mode: str = "NextStep", **options: Any
) -> NavigationVectorEnv:
    """Make many environments that are stepped together (`EnvOptions`)."""
    return NavigationVectorEnv(EnvOptions.of(**options), num_envs, autoreset_mode=autoreset_mode)
