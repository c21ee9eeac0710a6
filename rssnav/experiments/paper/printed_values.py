"""The numbers the paper prints.

Md Moin Uddin Chowdhury, Fatih Erden, Ismail Guvenc: "RSS-Based Q-Learning for Indoor UAV
Navigation", IEEE MILCOM 2019.
"""

from __future__ import annotations

from rssnav.experiments.paper.data import AgentName, Configuration

RUNS = 100
"""Realisations that its means are taken over."""

_AGENT_ORDER: tuple[AgentName, ...] = ("rss", "location")
_LENGTHS_M = {  # speed: Scenario 1 RSS, location; Scenario 2 RSS, location
    1: (105.88, 94.70, 122.61, 119.71),
    2: (104.22, 101.25, 121.65, 121.05),
    4: (102.91, 98.63, 126.22, 114.63),
}

PATH_LENGTH_M: dict[Configuration, float] = {
    Configuration(1 + k // 2, _AGENT_ORDER[k % 2], speed): row[k]
    for speed, row in _LENGTHS_M.items()
    for k in range(4)
}
"""Length of the final trajectory [m]: its Table IV."""
