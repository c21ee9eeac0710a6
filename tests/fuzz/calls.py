"""Calls of the library with absurd arguments, as text: a name, and a line for each argument."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import small_plans
import small_worlds
import trimesh
from hypothesis import strategies as st
from shapely.geometry import Polygon

from floorplans import FloorPlan, Opening, Wall, generate
from raytrace import (
    Antenna,
    AntennaArray,
    Grid,
    HalfWaveDipole,
    Isotropic,
    Monopole,
    Patch,
    Paths,
    PatternTable,
    Rotated,
    Scene,
    Sector,
    TraceConfig,
    Transmitter,
    channel_matrix,
    compute_radio_map,
    estimate_cost,
    trace_paths,
)
from rssnav import (
    Fluctuation,
    GridWorld,
    IntervalStates,
    LocationAgent,
    QLearning,
    RssAgent,
    ToleranceStates,
    train,
)

SCALARS = (
    "None", "True", "-1", "0", "1", "2**31", "2**63", "2**64", "1e308", "-1e308",
    "5e-324", "1e-9", "0.5", "nan", "inf", "-inf",
    "np.float64('nan')", "np.int64(3)", "np.float32(2.5)",
)  # fmt: skip
"""Numbers and texts as Python source."""
TEXTS = ("''", "'a'", "'[/]'", "'x' * 10000", "None", "3", "nan")
MATERIALS = ("[]", "[('glass', nan)]", "[('gold', 1.0)]", "[('glass', 0.1)]", "[('glass', -1)]")
OTHERS = (
    "()", "[]", "(1, 2)", "(1, 2, 3)", "[nan, 1, 2]", "[inf] * 4", "np.zeros(0)",
    "np.zeros((3, 3))", "np.zeros((3, 4))", "np.full((2, 3), nan)", "(0, 0, 1e9, 1e9)",
    "(0, 0, 0, 0)",
    "(nan,) * 4", "[1e308, 1e308, 1e308]", "[-1]", "[2**63]", "(0.5,)",
    "np.zeros(28, dtype=int)", "np.full(28, 99)",
)  # fmt: skip
"""Sequences and arrays; given only where one is expected."""
SHAPES = (
    "Polygon()", "Polygon([(0, 0), (6, 4), (6, 0), (0, 4)])",
    "Polygon([(0, 0), (1e300, 0), (6, 4)])",
    "Polygon([(0, 0), (6, 0), (6, 4)], [[(1, 1), (9, 1), (2, 9)]])", "trimesh.Trimesh()",
    "trimesh.Trimesh([[0, 0, 0], [nan, 0, 0], [0, 0, 1]], [[0, 1, 2]])",
    "trimesh.Trimesh([[0, 0, 0], [1, 0, 0], [0, 1, 1]], [[0, 1, 2]])", "trimesh.creation.box()",
)  # fmt: skip
"""Polygons for outlines, meshes for scenes."""
ANTENNAS = ("HalfWaveDipole(300)", "Patch(1e300)", "Sector(-300, 0.01, 1e308, 1e308)")


WALL = "Wall((3, 0), (3, 4), 'glass', 0.1, 3.0)"


@cache
def _mesh() -> Any:
    return small_plans.box().to_mesh()


@cache
def _scene() -> Scene:
    walls = _mesh()
    return Scene.from_mesh(walls.mesh, walls.face_material, walls.materials)


@cache
def _world() -> GridWorld:
    return small_worlds.world_of(small_worlds.room_plan())


def _box_with(**values: Any) -> FloorPlan:
    return replace(small_plans.box(), **values)


def _wall_in_box(**values: Any) -> FloorPlan:
    return small_plans.box((Wall(**values),))


def _opening_in_box(**values: Any) -> FloorPlan:
    return small_plans.box((Wall((3, 0), (3, 4), "glass", 0.1, 3.0, (Opening(**values),)),))


def _traced(**values: Any) -> object:
    """Trace a map within limits that were accepted; only the small ones are computed."""
    config = TraceConfig(**values)
    estimate_cost(_scene(), Transmitter((1, 1, 1.5)), Grid.over((0, 0, 6, 4), 1, 2), config)
    return config


def _map_over(**values: Any) -> object:
    grid = Grid.over(**values)
    if grid.shape[0] * grid.shape[1] > 1000:
        return grid
    return compute_radio_map(_scene(), Transmitter((1, 1, 1.5)), grid, TraceConfig(0, 0), threads=1)


def _paths(**values: Any) -> object:
    return trace_paths(_scene(), Transmitter(**values), [[2, 2, 1.5]], TraceConfig(0, 0))


def _paths_to(receivers: Any) -> object:
    return trace_paths(_scene(), Transmitter((1, 1, 1.5)), receivers, TraceConfig(0, 0))


def _trained(**values: Any) -> object:
    return train(_world(), LocationAgent(), max_total_steps=200, threads=1, **values)


def _trained_by(**values: Any) -> object:
    return _trained(runs=1, episodes=2, learning=QLearning(**values))


def _world_of(speed: Any) -> object:
    return small_worlds.world_of(small_worlds.room_plan(), speed)


def _fluctuating(**values: Any) -> object:
    return RssAgent(ToleranceStates(1.0), fluctuation=Fluctuation(**values))


def _heard_from(make: Callable[..., Antenna]) -> Callable[..., object]:
    """Trace to a receiver with the antenna that is made; its gains are finite."""

    def heard(**values: Any) -> object:
        antenna = make(**values)
        gain = _paths_from(antenna).gain
        assert np.isfinite(gain).all(), f"{antenna}: {gain}"
        return antenna

    return heard


def _paths_from(antenna: Antenna) -> Paths:
    transmitter = Transmitter((1, 1, 1.5), antenna=antenna)
    return trace_paths(_scene(), transmitter, [[2, 2, 1.5]], TraceConfig(0, 0))


def _channels(**values: Any) -> object:
    array = AntennaArray.linear(2)
    channels = channel_matrix(_paths_from(Isotropic()), array, array, **values)
    assert np.isfinite(channels).all()
    return channels


def _taps(**values: Any) -> object:
    response = _paths_from(Isotropic()).impulse_response(**values)
    assert all(np.isfinite(part).all() for part in vars(response).values())
    return response


CALLS: dict[str, tuple[Any, dict[str, str]]] = {
    "FloorPlan": (_box_with, {
        "name": "'box'", "outline": "Polygon([(0, 0), (6, 0), (6, 4), (0, 4)])", "height_m": "3.0",
        "walls": f"small_plans.box().walls + ({WALL},)", "floor_material": "'concrete'",
        "ceiling_material": "'concrete'", "source": "(1, 1, 1.5)", "start": "(4.5, 2.5)",
        "floor_thickness_m": "0.2", "ceiling_thickness_m": "0.2", "origin": "None",
        "materials": "()", "material_edition": "None",
    }),
    "Wall": (_wall_in_box, {
        "start": "(3, 0)", "end": "(3, 4)", "material": "'glass'", "thickness_m": "0.1",
        "height_m": "3.0", "openings": "()",
    }),
    "Opening": (_opening_in_box, {
        "offset_m": "1", "width_m": "1", "sill_m": "0", "head_m": "2", "kind": "'door'",
        "material": "None", "thickness_m": "None",
    }),
    "Scene.from_mesh": (Scene.from_mesh, {
        "mesh": "_mesh().mesh", "face_material": "np.array(_mesh().face_material)",
        "materials": "[*_mesh().materials]", "edition": "'P.2040-4'",
    }),
    "TraceConfig": (_traced, {
        "max_reflections": "1", "max_diffractions": "0", "max_transmissions": "0",
        "min_power_dbm": "-inf", "max_paths": "None",
    }),
    "Grid.over": (_map_over, {"bounds": "(0, 0, 6, 4)", "cell_size_m": "1", "height_m": "2"}),
    "Transmitter": (_paths, {
        "position": "(1, 1, 1.5)", "power_dbm": "25.0", "frequency_hz": "2.4e9",
    }),
    "trace_paths": (_paths_to, {"receivers": "[[2, 2, 1.5]]"}),
    "PatternTable.of_gain": (PatternTable.of_gain, {
        "theta_deg": "[0, 90, 180]", "phi_deg": "[0, 120, 240, 360]",
        "gain_dbi": "np.zeros((3, 4))", "name": "'table'",
    }),
    "PatternTable.of": (PatternTable.of, {"antenna": "HalfWaveDipole()", "step_deg": "10"}),
    "HalfWaveDipole": (_heard_from(HalfWaveDipole), {
        "peak_gain_db": "0.0", "axis": "(0.0, 1.0, 0.0)",
    }),
    "Isotropic": (_heard_from(Isotropic), {"gain_db": "0.0"}),
    "Monopole": (_heard_from(Monopole), {"peak_gain_db": "0.0"}),
    "Patch": (_heard_from(Patch), {"permittivity": "2.2"}),
    "Sector": (_heard_from(Sector), {
        "peak_gain_db": "8.0", "beamwidth_deg": "65.0", "front_to_back_db": "30.0",
        "slant_deg": "0.0",
    }),
    "Rotated": (_heard_from(Rotated), {
        "antenna": "Sector()", "x_axis": "(0.0, 1.0, 0.0)", "z_axis": "(0.0, 0.0, 1.0)",
    }),
    "Rotated.towards": (_heard_from(Rotated.towards), {
        "antenna": "Sector()", "direction": "(0.0, 1.0, 0.0)",
    }),
    "AntennaArray": (_heard_from(AntennaArray), {
        "element": "Patch()", "offsets": "((0.0, 0.0, 0.0),)", "weights": "(1.0,)",
    }),
    "AntennaArray.linear": (_heard_from(AntennaArray.linear), {
        "n": "2", "spacing": "0.5", "axis": "(0.0, 1.0, 0.0)",
    }),
    "AntennaArray.planar": (_heard_from(AntennaArray.planar), {
        "n_y": "2", "n_z": "2", "spacing": "0.5",
    }),
    "AntennaArray.steered": (AntennaArray.linear(2).steered, {"direction": "(0.0, 1.0, 0.0)"}),
    "channel_matrix": (_channels, {"offsets_hz": "(0.0, 1e6)", "n_receivers": "1"}),
    "impulse_response": (_taps, {
        "bandwidth_hz": "20e6", "n_taps": "64", "start_s": "0.0", "n_receivers": "1",
    }),
    "generate": (generate, {
        "kind": "'flat'", "seed": "1", "area_m2": "60.0", "furniture": "True",
        "n_transmitters": "3",
    }),
    "train": (_trained, {
        "runs": "1", "episodes": "2", "seed": "0", "until_converged": "False",
        "min_episodes": "1", "snapshot_episodes": "(1,)", "keep_q": "True", "only_runs": "None",
    }),
    "QLearning": (_trained_by, {
        "gamma": "0.9", "epsilon_max": "1.0", "epsilon_min": "0.01", "alpha_max": "0.5",
        "alpha_min": "0.05", "eta": "1e-5", "goal_reward": "1000.0", "initial_q": "100.0",
        "goal_reward_is": "'added'", "maximum_over": "'all'", "decay": "'step'",
        "tie_break": "'first'", "max_steps": "100", "rule": "'q_learning'",
    }),
    "Fluctuation": (_fluctuating, {"sigma_db": "1.0", "correlation": "0.5"}),
    "IntervalStates": (IntervalStates, {"edges_dbm": "(-80.0, -60.0)"}),
    "IntervalStates.uniform": (IntervalStates.uniform, {
        "low_dbm": "-80", "high_dbm": "-20", "width_db": "10",
    }),
    "GridWorld.from_map": (_world_of, {"speed": "1"}),
    "LocationAgent": (LocationAgent, {"terminal_distance_m": "2.0"}),
}  # fmt: skip
"""What is called, and arguments that are right."""
PLANS = ("FloorPlan", "Wall", "Opening")

NAMES = {
    "nan": np.nan, "inf": np.inf, "np": np, "small_plans": small_plans, "_mesh": _mesh,
    "Wall": Wall, "HalfWaveDipole": HalfWaveDipole, "Sector": Sector, "Patch": Patch,
    "Polygon": Polygon, "trimesh": trimesh,
}  # fmt: skip


def _absurd(right: str) -> tuple[str, ...]:
    """Arguments of the kind of one that is right, and of no other kind."""
    kind, _, _ = right.partition("(")
    if kind in ("Polygon", "_mesh"):
        word = {"Polygon": "Polygon", "_mesh": "trimesh"}[kind]
        return tuple(shape for shape in SHAPES if shape.startswith(word))
    if kind in ("HalfWaveDipole", "Sector", "Patch"):
        return ANTENNAS
    if right.startswith("[*"):
        return MATERIALS
    if right.startswith("'"):
        return TEXTS
    return OTHERS if kind == "" or right[0] in "[(ns" else SCALARS


@st.composite
def _calls(draw: st.DrawFn) -> bytes:
    name = draw(st.sampled_from(sorted(CALLS)))
    arguments = dict(CALLS[name][1])
    for _ in range(draw(st.integers(1, 2))):
        key = draw(st.sampled_from(sorted(arguments)))
        long = ("10**400", "-10**400") if name in PLANS else ()  # others raise OverflowError
        arguments[key] = draw(st.sampled_from((*_absurd(CALLS[name][1][key]), *long)))
    lines = [name, *(f"{key} = {value}" for key, value in arguments.items())]
    return "\n".join(lines).encode()


def cases() -> st.SearchStrategy[bytes]:
    """Draw calls with one or two absurd arguments."""
    return _calls()


def run(path: Path) -> None:
    """Make the call that a file describes."""
    name, *lines = path.read_text().splitlines()
    arguments = dict(line.split(" = ", 1) for line in lines)
    if name in CALLS:
        CALLS[name][0](**{key: eval(value, dict(NAMES)) for key, value in arguments.items()})


def run_right_ones() -> None:
    """Make every call once with right arguments, which loads the kernels."""
    for call, arguments in CALLS.values():
        call(**{key: eval(value, dict(NAMES)) for key, value in arguments.items()})
