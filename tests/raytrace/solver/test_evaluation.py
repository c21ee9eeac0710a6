"""Beams are grown once and evaluated with any materials, antennas and frequencies."""

from dataclasses import replace

import numpy as np
import pytest
from buildings import CEILING_BOARD, CONCRETE, GLASS, PLASTERBOARD
from rooms import ROOMS, SOURCE

from raytrace import HalfWaveDipole, Isotropic, Paths, Scene, TraceConfig, Transmitter
from raytrace.kernels.guard import no_guard
from raytrace.kernels.sums import Sums
from raytrace.radio.materials import Slab
from raytrace.solver.accumulate import sum_paths
from raytrace.solver.dynamic_range import prepare_within_range
from raytrace.solver.evaluation import evaluation_of
from raytrace.solver.extruded_classes import path_classes
from raytrace.solver.path_class import PathClass
from raytrace.solver.setup import prepare
from raytrace.solver.workers import Workers

ROOM = ROOMS["glass window and door"]
CONFIG = TraceConfig(3, 1, max_transmissions=1, min_power_dbm=-95.0)
RECEIVERS = ROOM.random_points(12, seed=4)


def with_wood(scene: Scene) -> Scene:
    """Return the scene with walls and ceiling of another material."""
    slabs = list(scene.slabs)
    slabs[PLASTERBOARD] = slabs[CEILING_BOARD] = Slab.of("wood", 0.05)
    assert slabs[CONCRETE] != slabs[GLASS]
    return replace(scene, slabs=tuple(slabs))


VARIANTS = {
    "as built": (ROOM.scene, Transmitter(SOURCE)),
    "other materials": (with_wood(ROOM.scene), Transmitter(SOURCE)),
    "other frequency": (ROOM.scene, Transmitter(SOURCE, frequency_hz=5.2e9)),
    "other antenna": (ROOM.scene, Transmitter(SOURCE, antenna=Isotropic())),
    "slanted antenna": (
        ROOM.scene,
        Transmitter(SOURCE, antenna=HalfWaveDipole(axis=(0.3, -0.5, 0.8))),
    ),
}


@pytest.fixture(scope="module")
def grown() -> list[PathClass]:
    classes = path_classes(prepare(ROOM.scene, SOURCE, RECEIVERS, CONFIG))
    for path_class in classes:
        path_class.grow()
    return classes


def evaluated(classes: list[PathClass], variant: str) -> tuple[Sums, list[Paths]]:
    scene, transmitter = VARIANTS[variant]
    evaluation = evaluation_of(scene.slabs, transmitter, CONFIG)
    with Workers() as workers:
        (sums,) = sum_paths(workers, classes, [evaluation])
    return sums, [c.list_paths(evaluation) for c in classes]


def traced(variant: str) -> tuple[Sums, list[Paths]]:
    """Evaluate beams that are grown for the variant alone."""
    scene, transmitter = VARIANTS[variant]
    tracing = prepare(scene, transmitter.position, RECEIVERS, CONFIG)
    return evaluated(path_classes(tracing), variant)


@pytest.mark.parametrize("variant", VARIANTS)
def test_one_set_of_beams_serves_every_variant(grown: list[PathClass], variant: str) -> None:
    (sums, paths), (own_sums, own_paths) = evaluated(grown, variant), traced(variant)
    for part, own in zip(sums, own_sums, strict=True):
        np.testing.assert_array_equal(part, own)
    for some, own in zip(paths, own_paths, strict=True):
        np.testing.assert_array_equal(some.gain, own.gain)
        np.testing.assert_array_equal(some.vertices, own.vertices)


@pytest.mark.parametrize("limits", [{"min_power_dbm": -80.0}, {"dynamic_range_db": 30.0}])
@pytest.mark.parametrize("variant", [name for name in VARIANTS if name != "as built"])
def test_beams_that_a_loss_limits_serve_their_own_trace_alone(
    limits: dict[str, float], variant: str
) -> None:
    config = replace(CONFIG, **limits)
    own, other = (
        evaluation_of(VARIANTS[name][0].slabs, VARIANTS[name][1], config)
        for name in ("as built", variant)
    )
    tracing, _ = prepare_within_range(ROOM.scene, SOURCE, RECEIVERS, config, no_guard(), [own])
    again = evaluation_of(ROOM.scene.slabs, VARIANTS["as built"][1], config)
    for path_class in path_classes(tracing)[:2]:
        path_class.sum_paths(again)
        with pytest.raises(ValueError, match="expected the same ones, or a new trace"):
            path_class.sum_paths(other)
        with pytest.raises(ValueError, match="expected the same ones, or a new trace"):
            path_class.list_paths(other)


def test_the_variants_differ(grown: list[PathClass]) -> None:
    powers = [evaluated(grown, variant)[0].power for variant in VARIANTS]
    assert not any(np.allclose(powers[0], power) for power in powers[1:])
