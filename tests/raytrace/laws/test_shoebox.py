"""A room of six walls: as many paths as a shoebox has images."""

import numpy as np
import pytest
from buildings import box

from raytrace import Grid, TraceConfig, Transmitter, compute_radio_map, trace_paths

SHOEBOX = box(10.0, 6.0)
SOURCE = (2.345, 1.678, 1.234)


def images_within(order: int) -> int:
    """Count the images of order up to n: lattice points with |i| + |j| + |k| <= n."""
    side = range(-order, order + 1)
    return sum(abs(i) + abs(j) + abs(k) <= order for i in side for j in side for k in side)


def image_distances(source: tuple[float, ...], receiver: np.ndarray, order: int) -> np.ndarray:
    """Sorted distances from a shoebox's images, by the closed form of Allen and Berkley (1979)."""
    axes = []
    for s, size in zip(source, (10.0, 6.0, 3.0), strict=True):
        k = np.arange(-order, order + 1)
        axes.append((k, np.where(k % 2 == 0, k * size + s, (k + 1) * size - s)))
    (i, x), (j, y), (k, z) = axes
    grid = np.stack(np.meshgrid(x, y, z, indexing="ij"), axis=-1)
    orders = sum(np.abs(o) for o in np.meshgrid(i, j, k, indexing="ij"))
    return np.sort(np.linalg.norm(grid[orders <= order] - receiver, axis=1))


@pytest.mark.parametrize("order", range(7))
def test_every_receiver_sees_every_image(order: int) -> None:
    receivers = SHOEBOX.random_points(20, seed=1)
    config = TraceConfig(order, max_diffractions=1)
    paths = trace_paths(SHOEBOX.scene, Transmitter(SOURCE), receivers, config)
    seen = np.bincount(paths.receiver, minlength=20)
    np.testing.assert_array_equal(seen, images_within(order))


def test_there_are_377_images_of_order_6() -> None:
    assert images_within(6) == 377


def test_path_lengths_are_the_distances_of_the_images() -> None:
    receivers = SHOEBOX.random_points(20, seed=2)
    paths = trace_paths(SHOEBOX.scene, Transmitter(SOURCE), receivers)
    for number, receiver in enumerate(receivers):
        expected = image_distances(SOURCE, receiver, 6)
        np.testing.assert_allclose(np.sort(paths.at(number).length_m), expected, atol=1e-9)


def test_a_lattice_of_receivers_misses_no_image() -> None:
    grid = Grid.over((0.0, 0.0, 10.0, 6.0), 1.0, 2.0)
    radio_map = compute_radio_map(SHOEBOX.scene, Transmitter((2.0, 4.0, 1.5)), grid)
    np.testing.assert_array_equal(radio_map.path_count, 377)
