"""Known paths evaluated again have the gains that a new trace gives them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from random_plans import random_building
from rooms import ROOMS, SOURCE

from raytrace import (
    Antenna,
    Dielectric,
    HalfWaveDipole,
    Isotropic,
    Layer,
    Layered,
    MemoryLimitError,
    Paths,
    Scene,
    TraceConfig,
    TracedPoints,
    Transmitter,
    evaluate_paths,
    received_power,
    trace_paths,
    trace_points,
)
from raytrace.radio.materials import PERFECT_CONDUCTOR, Slab

Floats = NDArray[np.float64]

CONFIG = TraceConfig(2, 1, 1)
NAMES = ("glass window and door", "corner of 270 degrees", "door with lintel")
SLANTED = HalfWaveDipole(axis=(0.3, -0.5, 0.8))
STUDS = Layered(
    "studs",
    (
        Layer(Dielectric.of_law("board", 2.7, 0.0, 0.01), 0.0125),
        Layer(Dielectric.of_law("air", 1.0), 0.07),
        Layer(Dielectric.of_law("wood", 2.0, 0.0, 0.005), 0.0125),
    ),
)


def other_slabs(scene: Scene) -> tuple[Slab, ...]:
    """Return slabs of other kinds: layers, a conductor, a lossy dielectric."""
    kinds = (
        Slab(STUDS, STUDS.thickness_m).as_wall(),
        Slab(PERFECT_CONDUCTOR, 0.1),
        Slab(Dielectric.of_law("lossy", 7.0, 0.0, 0.3), 0.15),
    )
    return tuple(kinds[k % len(kinds)] for k in range(len(scene.slabs)))


@dataclass(frozen=True)
class Variant:
    """What paths are evaluated with: another scene, and antennas."""

    scene: Callable[[Scene], Scene]
    transmitter: Transmitter
    receive_antenna: Antenna | None = None


VARIANTS = {
    "as traced": Variant(lambda scene: scene, Transmitter(SOURCE)),
    "other materials": Variant(
        lambda scene: replace(scene, slabs=other_slabs(scene)), Transmitter(SOURCE)
    ),
    "other frequency": Variant(lambda scene: scene, Transmitter(SOURCE, 0.0, 5.2e9)),
    "isotropic": Variant(
        lambda scene: scene, Transmitter(SOURCE, antenna=Isotropic()), Isotropic()
    ),
    "slanted": Variant(
        lambda scene: replace(scene, slabs=other_slabs(scene)),
        Transmitter(SOURCE, frequency_hz=3.5e9, antenna=SLANTED),
        HalfWaveDipole(2.15, axis=(-1.0, 0.2, 0.4)),
    ),
}


def assert_gains_are(found: Paths, expected: Paths) -> None:
    """Compare gains of the same paths, whose order of strength may differ."""
    assert len(found) == len(expected)
    keys = [
        np.lexsort([*p.vertices.reshape(len(p), -1).round(6).T, *p.interactions.T, p.receiver])
        for p in (found, expected)
    ]
    gains, others = found.gain[keys[0]], expected.gain[keys[1]]
    np.testing.assert_allclose(gains, others, rtol=2e-12, atol=1e-15)


@pytest.mark.parametrize("variant", VARIANTS)
@pytest.mark.parametrize("name", NAMES)
def test_paths_have_the_gains_of_a_new_trace(name: str, variant: str) -> None:
    room, wanted = ROOMS[name], VARIANTS[variant]
    scene, receivers = wanted.scene(room.scene), room.random_points(4, seed=8)
    paths = trace_paths(room.scene, Transmitter(SOURCE), receivers, CONFIG)
    receive = wanted.receive_antenna
    new = trace_paths(scene, wanted.transmitter, receivers, CONFIG, receive_antenna=receive)
    found = evaluate_paths(paths, scene.slabs, wanted.transmitter, receive_antenna=receive)
    assert_gains_are(found, new)
    sent = {"".join(sorted(new.sequence(k))) for k in range(len(new))}
    assert {"LOS", "R", "T", "D"} & sent


@given(seed=st.integers(0, 2**32 - 1), n_walls=st.integers(1, 4))
@settings(max_examples=5)
def test_random_plans_with_transmission(seed: int, n_walls: int) -> None:
    building = random_building(seed, n_walls)
    source, *receivers = building.random_points(4, seed)
    transmitter, points = Transmitter(tuple(source)), np.array(receivers)
    scene = replace(building.scene, slabs=other_slabs(building.scene))
    config = TraceConfig(2, 1, 2)
    paths = trace_paths(building.scene, transmitter, points, config)
    new = trace_paths(scene, transmitter, points, config)
    assert_gains_are(evaluate_paths(paths, scene.slabs, transmitter), new)
    kept = trace_points(building.scene, transmitter, points, config)
    power_dbm = received_power(scene, transmitter, points, config)
    expected = 10.0 ** ((power_dbm - transmitter.power_dbm) / 10.0)
    np.testing.assert_allclose(kept.powers(scene.slabs), expected, rtol=1e-11, atol=1e-20)


def test_straight_paths_alone_can_be_evaluated() -> None:
    """They have no interactions, and an evaluation of no paths gives none."""
    room, straight = ROOMS["glass window and door"], TraceConfig(0, 0)
    sender, points = Transmitter(SOURCE), room.random_points(9, seed=8)
    paths = trace_paths(room.scene, sender, points, straight)
    found = evaluate_paths(paths, room.scene.slabs, sender)
    np.testing.assert_allclose(found.gain, paths.gain, rtol=1e-12)
    kept = trace_points(room.scene, sender, points, straight)
    assert 0 < len(paths) == kept.n_paths < len(points)
    assert (kept.at(np.array([], dtype=np.int64)).powers() == np.empty(0)).all()


def test_surfaces_are_where_the_points_are() -> None:
    """Each interaction's angle is that between its two segments, and its slab that of the wall."""
    room = ROOMS["glass window and door"]
    paths = trace_paths(room.scene, Transmitter(SOURCE), room.random_points(5, seed=2), CONFIG)
    before = np.diff(paths.vertices, axis=1)
    with np.errstate(invalid="ignore", divide="ignore"):
        unit = before / np.linalg.norm(before, axis=2, keepdims=True)
    is_floor = (paths.interactions == 1) & (paths.vertices[:, 1:-1, 2] == 0.0)
    assert is_floor.any()
    assert (paths.surface[is_floor] == room.scene.floor_slab).all()
    reflected = paths.interactions == 1
    turn = np.einsum("ijk,ijk->ij", unit[:, :-1], unit[:, 1:])[reflected]
    expected = 0.5 * np.arccos(np.clip(-turn, -1.0, 1.0))
    np.testing.assert_allclose(paths.incidence[reflected], expected, atol=1e-6)
    assert (paths.surface[paths.interactions == 2] == -1).all()
    assert (paths.surface[paths.interactions == 3] >= 0).all()


def test_the_table_has_surfaces_and_angles() -> None:
    pytest.importorskip("pandas")
    room = ROOMS["corner of 270 degrees"]
    paths = trace_paths(room.scene, Transmitter(SOURCE), room.random_points(2, seed=2), CONFIG)
    table = paths.to_dataframe()
    for sequence, surfaces, angles in zip(
        table["sequence"], table["surfaces"], table["incidence_deg"], strict=True
    ):
        letters = "" if sequence == "LOS" else sequence
        assert [s == "-" for s in surfaces.split()] == [letter == "D" for letter in letters]
        assert [a == "-" for a in angles.split()] == [letter == "D" for letter in letters]


@pytest.fixture(scope="module")
def kept() -> TracedPoints:
    room = ROOMS["door with lintel"]
    return trace_points(room.scene, Transmitter(SOURCE), room.random_points(6, seed=4), CONFIG)


def slabs_at(kept: TracedPoints, values: Floats) -> list[Slab]:
    """Return slabs of two materials in turn, of four values; one is in layers too."""
    first, second = (
        Dielectric.of_law(name, 1.0 + np.exp(values[2 * k]), 0.0, np.exp(values[2 * k + 1]))
        for k, name in enumerate("ab")
    )
    layers = Layered("layers", (Layer(first, 0.02), Layer(second, 0.01)))
    kinds = (Slab(first, 0.1), Slab(second, 0.2), Slab(layers, 0.03).as_wall())
    return [kinds[k % 3] for k in range(len(kept.slabs))]


def test_derivatives_are_those_of_differences(kept: TracedPoints) -> None:
    values, step = np.array([1.3, -2.5, 1.0, -3.0]), 1e-3
    powers, derivatives = kept.derivatives(lambda v: slabs_at(kept, v), values)
    np.testing.assert_allclose(powers, kept.powers(slabs_at(kept, values)), rtol=1e-11)

    def at(k: int, steps: float) -> Floats:
        moved = values.copy()
        moved[k] += steps * step
        return kept.powers(slabs_at(kept, moved))

    for k in range(len(values)):
        expected = (8.0 * (at(k, 1) - at(k, -1)) - (at(k, 2) - at(k, -2))) / (12.0 * step)
        assert np.abs(expected).max() > 0.0
        np.testing.assert_allclose(
            derivatives[:, k], expected, rtol=1e-5, atol=1e-6 * np.abs(expected).max()
        )


def test_derivatives_with_patterned_antennas() -> None:
    room = ROOMS["glass window and door"]
    transmitter = Transmitter(SOURCE, antenna=SLANTED)
    kept = trace_points(room.scene, transmitter, room.random_points(5, seed=6), CONFIG)
    values, step = np.array([1.0, -2.0, 0.7, -3.0]), 1e-4
    _, derivatives = kept.derivatives(lambda v: slabs_at(kept, v), values)
    direction = np.array([0.3, -1.0, 0.5, 0.8])
    ahead, behind = (kept.powers(slabs_at(kept, values + s * direction)) for s in (step, -step))
    np.testing.assert_allclose(
        derivatives @ direction, (ahead - behind) / (2.0 * step), rtol=1e-5, atol=1e-14
    )


def test_what_is_left_out_keeps_its_bound(kept: TracedPoints) -> None:
    room = ROOMS["door with lintel"]
    points = room.random_points(6, seed=4)
    part = trace_points(room.scene, Transmitter(SOURCE), points, CONFIG, max_left_out=1e-2)
    assert part.n_paths < kept.n_paths
    assert (part.left_out <= 1e-2).all()
    np.testing.assert_allclose(part.powers(), kept.powers() * (1.0 - part.left_out), rtol=1e-10)


def test_some_points_have_the_powers_they_had(kept: TracedPoints) -> None:
    chosen = np.array([4, 0, 3])
    part = kept.at(chosen)
    np.testing.assert_allclose(part.powers(), kept.powers()[chosen], rtol=1e-12)
    values = np.array([1.3, -2.5, 1.0, -3.0])
    whole = kept.derivatives(lambda v: slabs_at(kept, v), values)[1]
    some = part.derivatives(lambda v: slabs_at(part, v), values)[1]
    np.testing.assert_allclose(some, whole[chosen], rtol=1e-9, atol=1e-20)


def test_threads_do_not_matter(kept: TracedPoints) -> None:
    room = ROOMS["door with lintel"]
    points = room.random_points(6, seed=4)
    one = trace_points(room.scene, Transmitter(SOURCE), points, CONFIG, threads=1)
    np.testing.assert_array_equal(one.powers(), kept.powers())


def test_wrong_calls_are_refused() -> None:
    room = ROOMS["door with lintel"]
    points, transmitter = room.random_points(3, seed=4), Transmitter(SOURCE)
    with pytest.raises(ValueError, match="expected a fraction"):
        trace_points(room.scene, transmitter, points, CONFIG, max_left_out=1.0)
    with pytest.raises(ValueError, match=r"points of shape \(3,\)"):
        trace_points(room.scene, transmitter, points[0], CONFIG)
    with pytest.raises(MemoryLimitError):
        trace_points(room.scene, transmitter, points, CONFIG, max_memory_bytes=300_000)
    paths = trace_paths(room.scene, transmitter, points, CONFIG)
    with pytest.raises(ValueError, match="no steps"):
        evaluate_paths(replace(paths, steps=None), room.scene.slabs, transmitter)
    with pytest.raises(ValueError, match="no steps"):
        _ = replace(paths, steps=None).surface


def test_points_that_a_power_limits_are_evaluated_as_they_were_traced() -> None:
    points = np.array([[1.0, 1.0, 1.0]])
    box = ROOMS["door with lintel"]
    sender = Transmitter(SOURCE, 0.0)
    for limits in ({"min_power_dbm": -80.0}, {"dynamic_range_db": 30.0}):
        traced = trace_points(box.scene, sender, points, TraceConfig(1, 0, 1, **limits))
        expected = received_power(box.scene, sender, points, TraceConfig(1, 0, 1, **limits))
        np.testing.assert_allclose(10.0 * np.log10(traced.powers()), expected, atol=1e-6)
        with pytest.raises(ValueError, match="that a power or a loss limits"):
            traced.powers(box.scene.slabs)
        with pytest.raises(ValueError, match="that a power or a loss limits"):
            traced.derivatives(lambda _: box.scene.slabs, np.zeros(0))
