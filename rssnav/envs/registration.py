"""The environments' ids."""

from __future__ import annotations

from gymnasium.envs.registration import register, registry

IDS = {
    "rssnav/Scenario1-v0": {"plan": "scenario1"},
    "rssnav/Scenario2-v0": {"plan": "scenario2"},
    "rssnav/Office-v0": {"plan": "office"},
    "rssnav/Building-v0": {},
}
"""Ids, and the options that each one sets: the paper's scenarios, a generated office, any plan."""


def register_envs() -> None:
    """Register the ids with Gymnasium, which calls this by its entry point for plug-ins."""
    for name, options in IDS.items():
        if name not in registry:
            register(
                name,
                entry_point="rssnav.envs.making:make_env",
                vector_entry_point="rssnav.envs.making:make_vector_env",
                kwargs=dict(options),
            )
