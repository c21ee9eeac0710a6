"""The tracer's paths beside the brute force's."""

import numpy as np
from brute_force import Found, find_paths
from brute_force_facets import Facets
from brute_force_field import Radio, path_gains
from buildings import Building
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from raytrace import Isotropic, Paths, TraceConfig, Transmitter, trace_paths

Floats = NDArray[np.float64]


def off_ties(position: tuple[float, float, float]) -> tuple[float, float, float]:
    """Return a place next to one on a lattice, from which no ray runs through two corners [m]."""
    return position[0] + 1.234e-5, position[1] + 0.789e-5, position[2]


def facets_of(building: Building) -> Facets:
    """Return the building as the brute force sees it."""
    ground = np.full(len(building.ground), building.floor)
    return Facets(
        np.concatenate([building.triangles, building.ground]),
        np.concatenate([building.triangle_slab, ground]),
    )


def as_found(paths: Paths) -> Found:
    """Return the tracer's paths as the brute force would have them."""
    return Found(paths.receiver, paths.interactions.astype(np.int64), paths.vertices)


def assert_same_paths(ours: Found, theirs: Found, tolerance_m: float) -> None:
    """Require the same receivers, interactions and points, in any order."""
    a, b = (
        np.column_stack([p.receiver, p.kinds, p.vertices.reshape(-1, 3 * p.vertices.shape[1])])
        for p in (ours, theirs)
    )
    assert len(a) == len(b) or min(len(a), len(b)), f"{len(a)} paths, expected {len(b)}"
    if not len(a):
        return
    far_a, _ = cKDTree(b).query(a)
    far_b, match = cKDTree(a).query(b)
    extra, missing = (p[far > tolerance_m] for p, far in ((a, far_a), (b, far_b)))
    assert not len(extra), f"{len(extra)} of {len(a)} paths are none: {extra[0]}"
    assert not len(missing), f"{len(missing)} of {len(b)} paths are missing: {missing[0]}"
    assert len(a) == len(b), f"{len(a)} paths, expected {len(b)}"
    assert len(set(match.tolist())) == len(a), "some path is there twice"


def check_every_path(
    building: Building,
    source: tuple[float, float, float],
    receivers: Floats,
    config: TraceConfig,
    tolerance_m: float = 1e-9,
) -> None:
    """Require that the tracer's paths are the brute force's."""
    source = off_ties(source)
    paths = trace_paths(building.scene, Transmitter(source), receivers, config)
    limits = config.max_reflections, config.max_diffractions, config.max_transmissions
    found = find_paths(facets_of(building), np.array(source), receivers, *limits)
    assert_same_paths(as_found(paths), found, tolerance_m)
    steps = np.linalg.norm(np.diff(found.vertices, axis=1), axis=2).sum(axis=1)
    np.testing.assert_allclose(np.sort(paths.length_m), np.sort(steps), rtol=0, atol=tolerance_m)


def check_every_gain(
    building: Building,
    source: tuple[float, float, float],
    receivers: Floats,
    config: TraceConfig,
) -> None:
    """Require that the gains of the tracer's paths are those of a field vector.

    Near grazing incidence tables are interpolated over steep slopes: the error counts against the
    strongest path there.
    """
    transmitter = Transmitter(off_ties(source), antenna=Isotropic())
    paths = trace_paths(building.scene, transmitter, receivers, config, receive_antenna=Isotropic())
    radio = Radio(building.slabs, transmitter, Isotropic(), config.max_transmissions)
    expected = path_gains(facets_of(building), as_found(paths), radio)
    error = np.abs(paths.gain - expected)
    allowed = 1e-3 * np.abs(expected) + 1e-6 * np.abs(expected).max(initial=0.0)
    worst = np.argmax(error - allowed) if len(paths) else 0
    assert (error <= allowed).all(), (
        f"{paths.sequence(int(worst))}: {paths.gain[worst]}, expected {expected[worst]}"
    )
