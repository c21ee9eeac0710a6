"""Maps of several transmitters: those at one place share beams, and are as if computed alone."""

import numpy as np
import pytest
from rooms import ROOMS, SOURCE

from raytrace import (
    Grid,
    HalfWaveDipole,
    Isotropic,
    TraceConfig,
    Transmitter,
    compute_radio_map,
    compute_radio_maps,
    trace,
)
from raytrace.results.layers import LAYERS

ROOM = ROOMS["glass window and door"]
GRID = Grid.over((0.4, 0.3, 3.4, 2.3), 1.0, 1.2)
X, Y, Z = SOURCE
TRANSMITTERS = {
    "2.4 GHz": Transmitter(SOURCE),
    "elsewhere": Transmitter((X + 0.2, Y, Z)),
    "5 GHz": Transmitter(SOURCE, 10.0, frequency_hz=5.2e9),
    "slanted": Transmitter(SOURCE, antenna=HalfWaveDipole(axis=(1, 1, 1))),
    "of unknown polarisation": Transmitter(SOURCE, antenna=Isotropic(polarisation="mean")),
}


@pytest.mark.parametrize(
    ("config", "n_grown"),
    [
        (TraceConfig(2, 1, 1), 2),
        (TraceConfig(2, 1, 1, max_paths=500), 2),
        (TraceConfig(2, 1, None, -90.0), 5),
        (TraceConfig(2, 1, 2, dynamic_range_db=20.0), 5),
    ],
)
def test_beams_of_one_place_are_grown_once(
    config: TraceConfig, n_grown: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    grown, prepare = list[object](), trace.prepare_within_range

    def counted(*arguments: object) -> object:
        grown.append(arguments)
        return prepare(*arguments)  # pyright: ignore[reportArgumentType]

    done: list[tuple[int, int]] = []
    with monkeypatch.context() as patched:
        patched.setattr(trace, "prepare_within_range", counted)
        maps = compute_radio_maps(
            ROOM.scene, TRANSMITTERS, GRID, config, progress=lambda *parts: done.append(parts)
        )
    assert len(grown) == n_grown
    assert list(maps) == list(TRANSMITTERS)
    assert done == sorted(done)
    assert done[-1] == (5000, 5000)
    for name, transmitter in TRANSMITTERS.items():
        alone = compute_radio_map(ROOM.scene, transmitter, GRID, config)
        for layer in LAYERS:
            np.testing.assert_array_equal(getattr(maps[name], layer), getattr(alone, layer))
