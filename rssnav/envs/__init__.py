"""Gymnasium environments: find a radio source indoors.

>>> import gymnasium
>>> import rssnav.envs
>>> env = gymnasium.make("rssnav/Scenario1-v0", speed=2)
>>> many = gymnasium.make_vec("rssnav/Scenario1-v0", num_envs=1024)

The ids are in :data:`IDS`; Gymnasium finds them by itself where rssnav is installed. They need the
extra ``rssnav[gym]``.
"""

from raytrace.extras import needs_extra

with needs_extra("gym"):
    from rssnav.envs.registration import IDS, register_envs

from rssnav.envs.single import NavigationEnv
from rssnav.envs.vector import NavigationVectorEnv

__all__ = ["IDS", "NavigationEnv", "NavigationVectorEnv", "register_envs"]

register_envs()
