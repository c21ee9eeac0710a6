"""An image method of others, written for sound, sees the same images from the same places."""

import numpy as np
import pytest
from buildings import HEIGHT_M, Building, Point, ring
from comparing import off_ties
from numpy.typing import NDArray
from rooms import L_SHAPE, SLANTED, SOURCE

from raytrace import TraceConfig, Transmitter, trace_paths

pra = pytest.importorskip("pyroomacoustics")

Floats = NDArray[np.float64]

SINGLE_M = 1e-4
"""It computes in single precision: 5e-5 m off at order 5."""

U_SHAPE = (
    (0.0, 0.0), (7.0, 0.0), (7.0, 4.0), (5.0, 4.25),
    (5.0, 2.0), (3.0, 1.75), (2.5, 4.0), (0.0, 4.0),
)  # fmt: skip
STAR = (
    (3.0, 0.0), (3.75, 1.25), (6.0, 1.5), (4.0, 2.5),
    (4.5, 4.5), (2.5, 3.0), (0.0, 3.5), (1.0, 1.0),
)  # fmt: skip
OUTLINES = {"L": L_SHAPE, "slanted": SLANTED, "U": U_SHAPE, "star": STAR}


def visible_distances(
    outline: tuple[Point, ...], source: Floats, receivers: Floats, order: int
) -> list[Floats]:
    """Sorted distances [m] of the images that each receiver sees."""
    board = pra.Material(0.1)
    room = pra.Room.from_corners(np.array(outline).T, max_order=order, materials=board)
    room.extrude(HEIGHT_M, materials=board)
    room.add_source(source)
    for receiver in receivers:
        room.add_microphone(receiver)
    room.image_source_model()
    images, visible = room.sources[0].images.T, room.visibility[0].astype(bool)
    return [
        np.sort(np.linalg.norm(images[seen] - receiver, axis=1))
        for receiver, seen in zip(receivers, visible, strict=True)
    ]


@pytest.mark.parametrize("order", [3, 5])
@pytest.mark.parametrize("name", OUTLINES)
def test_the_same_images_are_visible(name: str, order: int) -> None:
    room = Building(OUTLINES[name], ring(OUTLINES[name]))
    receivers, source = room.random_points(12, seed=71), off_ties(SOURCE)
    expected = visible_distances(room.outline, np.array(source), receivers, order)
    paths = trace_paths(room.scene, Transmitter(source), receivers, TraceConfig(order, 0))
    for number, distances in enumerate(expected):
        found = np.sort(paths.at(number).length_m)
        assert len(found) == len(distances)
        np.testing.assert_allclose(found, distances, rtol=0, atol=SINGLE_M)
