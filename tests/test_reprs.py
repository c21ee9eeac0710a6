"""What objects of the library print in an interactive session fits a line."""

from __future__ import annotations

import pytest

import floorplans
import raytrace
import rssnav
from rssnav.policies import Hypotheses

FLAT = floorplans.load("flat")
SCENE = rssnav.scene_of(FLAT)
SOURCE = raytrace.Transmitter(FLAT.source)
CONFIG = raytrace.TraceConfig(max_reflections=1, max_diffractions=0)
GRID = raytrace.Grid.over(FLAT.bounds, 1.0, 2.0)
MAP = raytrace.compute_radio_map(SCENE, SOURCE, GRID, CONFIG)
WORLD = rssnav.GridWorld.from_map(FLAT, MAP, speed=1)
AGENT = rssnav.RssAgent(terminal_dbm=-30.0)
PROCESS = AGENT.decision_process(WORLD, rssnav.QLearning())
POINTS = [[2.0, 7.0, 1.5], [3.0, 8.0, 1.5]]


@pytest.mark.parametrize(
    ("made", "tells"),
    [
        (FLAT, ["flat", "12 x 9 x 2.6 m", "9 walls"]),
        (FLAT.to_mesh(), ["triangles"]),
        (SCENE, ["12 x 9 x 2.6 m"]),
        (GRID, ["12 x 9 cells of 1 m", "2 m above"]),
        (MAP, ["12 x 9", "dBm"]),
        (raytrace.TransmitterMaps({"a": MAP, "b": MAP}), ["a, b", "12 x 9"]),
        (raytrace.trace_paths(SCENE, SOURCE, POINTS, CONFIG), ["2 receivers"]),
        (
            raytrace.trace_paths(SCENE, SOURCE, POINTS, CONFIG).impulse_response(1e8, 5),
            ["2 receivers", "5 taps"],
        ),
        (raytrace.trace_points(SCENE, SOURCE, POINTS, CONFIG), ["2 points"]),
        (raytrace.PatternTable.of(raytrace.Patch(), 10.0), ["patch", "19 x 37"]),
        (raytrace.AntennaArray.planar(4, 4), ["16 elements"]),
        (WORLD, ["flat", f"{len(WORLD.position)} cells", "speed 1"]),
        (PROCESS, [f"{PROCESS.n_states} states"]),
        (rssnav.train(WORLD, AGENT, runs=2, episodes=50, seed=0), ["rss", "of 2 runs"]),
        (rssnav.value_iteration(PROCESS, 0.9), [f"{PROCESS.n_states} states"]),
        (rssnav.PlanScene(FLAT, SCENE), ["flat"]),
        (WORLD.mission(), ["1 modes"]),
        (WORLD.mission().layout, ["flat", "speed 1"]),
        (Hypotheses.of_mission(WORLD.mission(), AGENT.task(rssnav.QLearning())), ["1 places"]),
    ],
    ids=lambda value: type(value).__name__ if not isinstance(value, list) else "",
)
def test_repr_is_a_line(made, tells) -> None:
    text = repr(made)
    assert len(text) <= 120
    assert "\n" not in text
    assert all(part in text for part in tells)
