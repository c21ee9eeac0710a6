"""Beams that are too weak are not grown: no strong path is missing, and the rest is bounded."""

import math
from itertools import pairwise
from typing import NamedTuple

import numba
import numpy as np
import pytest
import shapely
from buildings import GLASS, Building, box, door, wall
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from random_plans import random_building
from scipy.special import fresnel

from raytrace import (
    Grid,
    Isotropic,
    Layer,
    Layered,
    Paths,
    RadioMap,
    TraceConfig,
    Transmitter,
    compute_radio_map,
    received_power,
    trace_paths,
)
from raytrace.kernels.building import image_bounces, image_heights
from raytrace.kernels.edge_losses import directions_between, largest_amplitude
from raytrace.kernels.horizontal_edge_bounds import (
    DISTANCES,
    MIDDLE_M,
    EdgeHeights,
    bounds_over_edge,
)
from raytrace.kernels.losses import COSINE_BINS
from raytrace.kernels.plan_view import distances_to_cells
from raytrace.kernels.wedge import Wedge, new_wedge
from raytrace.radio.materials import MATERIALS, Slab
from raytrace.radio.tables import field_tables
from raytrace.solver.slab_bounds import reflection_of, slab_bounds, transmission_of

MOST = 20
"""More transmissions than any path of the plans has."""

THREE_ROOMS = Building(
    box(9.0, 4.0).outline,
    (
        *box(9.0, 4.0).sheets,
        *wall((3.0, 0.0), (3.0, 4.0), door(1.0, 2.0)),
        *wall((6.0, 0.0), (6.0, 4.0), door(2.5, 3.5, filling=GLASS)),
    ),
)
LAYERS = (("brick", 0.09), ("air", 0.19), ("plasterboard", 0.016))
CAVITY = Slab.of(
    Layered("cavity", tuple(Layer(MATERIALS[name], d) for name, d in LAYERS)), 0.296
).as_wall()
"""A layered wall, which resonates."""

STARTS = MIDDLE_M * np.arange(DISTANCES) / (DISTANCES - np.arange(DISTANCES))
"""Where the intervals of distances behind a horizontal edge begin [m]."""

SOURCE = Transmitter((1.2345, 1.8123, 1.3))


def keys(paths: Paths) -> dict[tuple[float, ...], float]:
    """Powers of paths by receiver and points, rounded to micrometres."""
    return {
        (int(paths.receiver[k]), *np.round(paths.vertices[k, : n + 2].ravel(), 6).tolist()): p
        for k, (n, p) in enumerate(
            zip(paths.n_interactions, np.abs(paths.gain) ** 2 * paths.weight, strict=True)
        )
    }


@pytest.mark.parametrize("number", [None, MOST])
@given(seed=st.integers(0, 2**32 - 1), below_db=st.floats(50.0, 110.0))
@settings(max_examples=3, derandomize=True)
def test_no_strong_path_is_missing(number: int | None, seed: int, below_db: float) -> None:
    building = random_building(seed, 3)
    source, *receivers = building.random_points(4, seed)
    transmitter = Transmitter((float(source[0]), float(source[1]), float(source[2])), 0.0)
    whole, part = (
        keys(trace_paths(building.scene, transmitter, np.array(receivers), config))
        for config in (TraceConfig(2, 1, MOST), TraceConfig(2, 1, number, -below_db))
    )
    assert not part.keys() - whole.keys()
    missing = [whole[key] for key in whole.keys() - part.keys()]
    assert max(missing, default=0.0) < 10.0 ** (-0.1 * below_db)


def map_of(config: TraceConfig, threads: int = 2) -> RadioMap:
    grid = Grid.over((0.0, 0.0, 9.0, 4.0), 0.5, 1.1)
    return compute_radio_map(THREE_ROOMS.scene, SOURCE, grid, config, threads=threads)


@pytest.fixture(scope="module")
def whole() -> RadioMap:
    return map_of(TraceConfig(2, 1, MOST))


@pytest.mark.parametrize("number", [None, MOST])
@pytest.mark.parametrize(
    ("min_power_dbm", "dynamic_range_db"),
    [(-110.0, math.inf), (-110.0, 10.0), (-60.0, 30.0), (-60.0, 10.0), (-40.0, math.inf)],
)
def test_what_is_missing_keeps_its_bound(
    whole: RadioMap, number: int | None, dynamic_range_db: float, min_power_dbm: float
) -> None:
    config = TraceConfig(2, 1, number, min_power_dbm, dynamic_range_db=dynamic_range_db)
    part = map_of(config)
    everything, kept = (10.0 ** (m.rss_dbm / 10.0) for m in (whole, part))
    assert part.left_out_db is not None
    left = kept * 10.0 ** (part.left_out_db / 10.0)
    some = kept > 0.0
    assert (kept <= everything * (1.0 + 1e-12)).all()
    assert (everything[some] <= (kept + left)[some] * (1.0 + 1e-12)).all()
    assert np.isposinf(part.left_out_db[~some]).all()


def test_a_low_limit_leaves_out_nothing(whole: RadioMap) -> None:
    """The limit by loss alone finds what a large number of transmissions does."""
    part = map_of(TraceConfig(2, 1, None, -400.0))
    np.testing.assert_array_equal(part.rss_dbm, whole.rss_dbm)
    np.testing.assert_array_equal(part.path_count, whole.path_count)
    assert part.left_out_db is not None
    assert (part.left_out_db < -50.0).all()


def test_a_range_leaves_out_little() -> None:
    whole, part = (
        map_of(TraceConfig(2, 1, None, -120.0, dynamic_range_db=x)) for x in (60.0, 25.0)
    )
    assert (part.path_count < whole.path_count).any()
    np.testing.assert_allclose(part.rss_dbm, whole.rss_dbm, atol=0.1)


def test_it_depends_neither_on_threads_nor_on_other_receivers() -> None:
    config = TraceConfig(2, 1, None, -80.0, dynamic_range_db=20.0)
    maps = [map_of(config, threads) for threads in (1, 2, 3)]
    for other in maps[1:]:
        np.testing.assert_array_equal(other.rss_coherent_dbm, maps[0].rss_coherent_dbm)
        np.testing.assert_array_equal(other.left_out_db, maps[0].left_out_db)
    some = maps[0].grid.points()[::5]
    found = received_power(THREE_ROOMS.scene, SOURCE, some, config)
    np.testing.assert_allclose(found, maps[0].rss_dbm.ravel()[::5], rtol=0, atol=1e-9)


@pytest.mark.parametrize(
    "slab", [Slab.of("concrete", 0.2), Slab.of("glass", 0.01), Slab.of("metal", 0.01), CAVITY]
)
def test_slabs_keep_no_more_than_their_bounds(slab: Slab) -> None:
    transmitter = Transmitter((0.0, 0.0, 1.0), antenna=Isotropic())
    tables = field_tables(transmitter, [slab], through_walls=True)
    cosines = np.linspace(0.0, 1.0, 20011)
    c = slab.material.coefficients(slab.thickness_m, transmitter.frequency_hz, cosines)
    at = np.minimum((cosines * COSINE_BINS).astype(int), COSINE_BINS - 1)
    c = c.relative_to_air(slab.thickness_m, transmitter.frequency_hz, cosines)
    for tabulated, te, tm in (
        (reflection_of(tables), c.r_te, c.r_tm),
        (transmission_of(tables), c.t_te, c.t_tm),
    ):
        bounds = slab_bounds(tables, *tabulated)[0]
        power = np.maximum(np.abs(te), np.abs(tm)) ** 2
        assert (power <= bounds[at, at]).all()
        assert (np.diff(bounds, axis=1)[np.triu_indices(COSINE_BINS - 1)] >= 0.0).all()
        assert bounds[0, -1] == pytest.approx(1.001 * power.max(), rel=1e-3)


def test_distances_to_cells_are_those_of_polygons() -> None:
    view, rng = THREE_ROOMS.scene.view, np.random.default_rng(0)
    outlines = [
        shapely.linearrings(view.ends[first:last, :2])
        for first, last in pairwise(view.cell_edges.tolist())
    ]
    for _ in range(50):
        one, other = rng.uniform(0.0, (3.0, 4.0), (2, 2))
        for end in (one, other):
            way = shapely.LineString([one, end])
            if any(shapely.crosses(way, outline) for outline in outlines):
                continue
            expected = [shapely.distance(way, outline) for outline in outlines]
            assert distances_to_cells(view, one, end) == pytest.approx(expected, abs=1e-12)


def test_unlimited_transmissions_need_a_power() -> None:
    with pytest.raises(ValueError, match="max_transmissions = None, but min_power_dbm = -inf"):
        TraceConfig(max_transmissions=None)
    with pytest.raises(ValueError, match=r"dynamic_range_db = 0\.0: expected a positive"):
        TraceConfig(dynamic_range_db=0.0)
    assert TraceConfig(3, 1, None, -120.0).max_transmissions is None


@numba.njit
def bound_between(
    wedge: Wedge,
    low: tuple[float, float],
    high: tuple[float, float],
    incoming: tuple[float, float],
    factors: tuple[float, float, float],
    size: float,
) -> tuple[float, float, float]:
    """Largest amplitude between two directions, and the least sines to the faces."""
    found = directions_between(wedge, low, high)
    faces = factors[1], factors[2]
    amplitude = largest_amplitude(wedge, incoming, found, faces, factors[0], size)
    return amplitude, found.o_sine, found.n_sine


def test_no_direction_exceeds_the_bound_behind_an_edge() -> None:
    """The sum of the four terms, after Kouyoumjian and Pathak, at directions within intervals."""
    rng = np.random.default_rng(5)
    for _ in range(300):
        n = rng.uniform(1.05, 2.0)
        wedge = new_wedge(n, 0, 1)
        incoming, *ends = rng.uniform(0.0, n * np.pi, 3)
        low, high = sorted(ends)
        high = min(high, low + 3.0)
        factors, kl = rng.uniform(0.0, [2.0, 1.0, 1.0]), 10.0 ** rng.uniform(-3.0, 4.0)
        bound, o_sine, n_sine = bound_between(
            wedge,
            (np.cos(low), np.sin(low)),
            (np.cos(high), np.sin(high)),
            (np.cos(incoming / (2 * n)), np.sin(incoming / (2 * n))),
            (factors[0], factors[1], factors[2]),
            1.0 / (2.0 * n * np.sqrt(2.0 * np.pi * kl)),
        )
        phi = np.linspace(low, high, 400)
        weights = (factors[0], factors[0], factors[2], factors[1])
        terms = four_terms(n, phi, incoming, kl)
        field = sum(weight * np.abs(term) for weight, term in zip(weights, terms, strict=True))
        assert np.max(field) <= bound * (1.0 + 1e-9)
        assert bound <= 2.0 * factors[0] + factors[1] + factors[2]
        assert o_sine <= np.abs(np.sin(phi)).min() + 1e-12
        assert n_sine <= np.abs(np.sin(n * np.pi - phi)).min() + 1e-12


def four_terms(
    n: float, phi: NDArray, incoming: NDArray | float, kl: NDArray | float
) -> list[NDArray]:
    """Terms of the diffraction coefficient (n,) over the field of a free path as long."""
    found = []
    for beta in (phi - incoming, phi + incoming):
        for sign in (1.0, -1.0):
            nearest = np.round((beta + sign * np.pi) / (2.0 * np.pi * n))
            root = np.sqrt(kl) * np.sqrt(2.0) * np.abs(np.cos(n * np.pi * nearest - 0.5 * beta))
            sine, cosine = fresnel(root * np.sqrt(2.0 / np.pi))
            tail = np.sqrt(np.pi / 2.0) * ((0.5 - cosine) - 1j * (0.5 - sine))
            transition = 2j * root * np.exp(1j * root**2) * tail
            cotangent = 1.0 / np.tan((np.pi + sign * beta) / (2.0 * n))
            found.append(cotangent * transition / (2.0 * n * np.sqrt(2.0 * np.pi * kl)))
    return found


class Coefficients(NamedTuple):
    """Of floor or ceiling (as power), of the wall and of its shadow, at cosines of incidence."""

    surfaces: NDArray
    face: NDArray
    shadow: NDArray

    def at(self, column: NDArray, cosine: NDArray) -> NDArray:
        """Return those of the intervals of cosines."""
        return column[np.minimum((cosine * COSINE_BINS).astype(int), COSINE_BINS - 1)]

    def at_or_above(self) -> list[NDArray]:
        """Return the largest ones at a cosine or above."""
        return [np.maximum.accumulate(column[::-1])[::-1] for column in self]


@pytest.mark.parametrize("seed", range(40))
def test_no_height_exceeds_the_bound_behind_a_horizontal_edge(seed: int) -> None:
    """At random distances, obliqueness and heights between the lowest and the highest receiver."""
    rng = np.random.default_rng(seed)
    height, order, wavelength = rng.uniform(2.2, 5.0), 3, 10.0 ** rng.uniform(-2.0, 0.0)
    z_edge, z_source, *ends = rng.uniform(0.1, height - 0.1, 4)
    low, high = sorted(ends)
    made = Coefficients(*(rng.uniform(0.0, most, COSINE_BINS) for most in (1.0, 1.0, 2.0)))
    bounces, (before, at_low, at_high) = (
        image_bounces(order),
        [image_heights(z, height, order) - z_edge for z in (z_source, low, high)],
    )
    lowest, highest = np.minimum(at_low, at_high), np.maximum(at_low, at_high)
    h, length = rng.choice([-1.0, 1.0]) * 10.0 ** rng.uniform(-2.0, 1.5), rng.uniform(0.0, 30.0)
    length, least_sin_beta = max(length, abs(h)), rng.uniform(0.05, 1.0)
    most = rng.uniform(1.0, 3.0)
    ways = np.array([order]), np.array([h]), np.array([length]), np.array([least_sin_beta])
    heights = EdgeHeights(bounces, before, lowest, highest, *made.at_or_above(), wavelength, most)
    bounds = bounds_over_edge(heights, *ways)[0, :, :DISTANCES]
    assert (np.diff(bounds, axis=0) >= 0.0).all()
    assert (np.diff(bounds, axis=1) <= 0.0).all()
    n = 4000
    off, sin_beta = 10.0 ** rng.uniform(-2.0, 2.0, n), rng.uniform(least_sin_beta, 1.0, n)
    a, b = rng.integers(0, len(bounces), (2, n))
    rise_in, rise_out = before[a], rng.uniform(lowest[b], highest[b])
    across_in, across_out = np.hypot(h, rise_in), np.hypot(off, rise_out)
    incoming = np.arctan2(h, rise_in) % (2.0 * np.pi)
    phi = np.arctan2(off, rise_out)
    kl = 2.0 * np.pi / wavelength * across_in * across_out / (across_in + across_out) * sin_beta
    cosine = sin_beta * np.sqrt(np.abs(np.sin(incoming) * np.sin(phi)))
    shadow, face = made.at(made.shadow, cosine), made.at(made.face, cosine)
    terms = [np.abs(term) for term in four_terms(2.0, phi, incoming, kl)]
    field = shadow * (terms[0] + terms[1]) + face * (terms[2] + terms[3])
    kept = made.at(made.surfaces, sin_beta * np.abs(rise_in) / across_in) ** bounces[a]
    kept *= made.at(made.surfaces, sin_beta * np.abs(rise_out) / across_out) ** bounces[b]
    power = field**2 * kept / (length + off) ** 2 / most
    left = bounces[a] + bounces[b]
    some = left <= order
    nearest = np.searchsorted(STARTS[1:], off, side="right")
    assert (power[some] <= bounds[left[some], nearest[some]] * (1.0 + 1e-6)).all()
