"""Maps of several transmitters: those at one place share beams, and are as if computed alone."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest
from rooms import ROOMS, SOURCE

from raytrace import (
    Antenna,
    Grid,
    HalfWaveDipole,
    Isotropic,
    PatternTable,
    SceneError,
    SceneWarning,
    TraceConfig,
    Transmitter,
    TransmitterMaps,
    compute_radio_map,
    compute_radio_maps,
    trace,
)
from raytrace.radio.antennas import Amplitudes
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
        np.testing.assert_array_equal(maps[name].path_count, alone.path_count)
        for layer in LAYERS:  # up to rounding, which the small spread of angles magnifies
            values = getattr(maps[name], layer), getattr(alone, layer)
            np.testing.assert_allclose(*values, rtol=0.0, atol=1e-6)


RANGE = TraceConfig(2, 1, None, -120.0, dynamic_range_db=20.0)
SAME_BUT_FREQUENCY = {
    "5 GHz": Transmitter(SOURCE, frequency_hz=5.2e9),
    "elsewhere": Transmitter((X + 0.2, Y, Z)),
    "2.4 GHz": Transmitter(SOURCE),
}


def test_a_range_is_that_of_the_lowest_frequency(tmp_path: Path) -> None:
    maps = compute_radio_maps(ROOM.scene, SAME_BUT_FREQUENCY, GRID, RANGE)
    maps.save(tmp_path / "maps.h5")
    maps = TransmitterMaps.load(tmp_path / "maps.h5")
    assert list(maps) == list(SAME_BUT_FREQUENCY)
    for name in ("2.4 GHz", "elsewhere"):
        alone = compute_radio_map(ROOM.scene, SAME_BUT_FREQUENCY[name], GRID, RANGE)
        for layer in LAYERS:
            np.testing.assert_array_equal(getattr(maps[name], layer), getattr(alone, layer))
    np.testing.assert_array_equal(maps["5 GHz"].path_count, maps["2.4 GHz"].path_count)
    assert (maps["5 GHz"].left_out_db == np.inf).all()


@pytest.mark.parametrize("antenna", [HalfWaveDipole(), Isotropic(polarisation="mean")])
def test_the_other_frequencies_lack_weak_paths_alone(antenna: Antenna) -> None:
    transmitters = {
        str(hz): Transmitter(SOURCE, frequency_hz=hz, antenna=antenna)
        for hz in (1.1e9, 2.4e9, 5.2e9, 6.5e9)
    }
    maps = compute_radio_maps(ROOM.scene, transmitters, GRID, RANGE, receive_antenna=antenna)
    for name, transmitter in transmitters.items():
        whole = compute_radio_map(
            ROOM.scene, transmitter, GRID, TraceConfig(2, 1, 20), receive_antenna=antenna
        )
        missing = whole.rss_dbm - maps[name].rss_dbm
        assert missing.min() > -1e-9
        assert np.median(missing) < 0.3
        assert (maps[name].path_count <= whole.path_count).all()


@dataclass  # neither frozen nor with a hash
class OwnAntenna:
    """An antenna of a user, all around and vertically polarised."""

    amplitude: float = 1.0

    def amplitudes(self, sine: np.ndarray, azimuth: np.ndarray) -> Amplitudes:
        """See `Antenna`."""
        return Amplitudes(np.full(np.shape(sine), self.amplitude), np.zeros(np.shape(sine)))

    def describe(self) -> str:
        """See `Antenna`."""
        return "of a user"


def test_antennas_need_no_hash() -> None:
    antenna = OwnAntenna()
    transmitters = {
        name: replace(transmitter, antenna=antenna)
        for name, transmitter in SAME_BUT_FREQUENCY.items()
    }
    transmitters["as a table"] = Transmitter(
        SOURCE, frequency_hz=6e9, antenna=PatternTable.of(antenna)
    )
    maps = compute_radio_maps(ROOM.scene, transmitters, GRID, RANGE)
    assert np.isposinf(maps["5 GHz"].left_out_db).all()
    for name in ("2.4 GHz", "elsewhere", "as a table"):
        alone = compute_radio_map(ROOM.scene, transmitters[name], GRID, RANGE)
        np.testing.assert_array_equal(maps[name].rss_dbm, alone.rss_dbm)
        np.testing.assert_array_equal(maps[name].left_out_db, alone.left_out_db)


def test_equal_transmitters_have_equal_maps() -> None:
    transmitters = {**SAME_BUT_FREQUENCY, "2.4 GHz again": Transmitter(SOURCE)}
    maps = compute_radio_maps(ROOM.scene, transmitters, GRID, RANGE)
    for layer in LAYERS:
        one, other = (getattr(maps[name], layer) for name in ("2.4 GHz", "2.4 GHz again"))
        np.testing.assert_allclose(one, other, rtol=0.0, atol=1e-6)


@pytest.mark.parametrize("config", [RANGE, TraceConfig(1, 0, 1), TraceConfig(1, 0, 1, -90.0)])
@pytest.mark.parametrize("frequency_hz", [1e8, 1e12])
def test_an_unknown_material_is_told_of_its_transmitter(
    config: TraceConfig, frequency_hz: float
) -> None:
    wrong = {"wrong": Transmitter(SOURCE, frequency_hz=frequency_hz)}
    with pytest.raises(SceneError, match=r"transmitter 'wrong': .* GHz: defined only for"):
        compute_radio_maps(ROOM.scene, {**SAME_BUT_FREQUENCY, **wrong}, GRID, config)


@pytest.mark.parametrize("names", [("none upwards", "all around"), ("all around", "none upwards")])
def test_power_that_is_bounded_is_told_for_every_transmitter(names: tuple[str, ...]) -> None:
    antennas = {"none upwards": HalfWaveDipole(), "all around": Isotropic()}
    transmitters = {name: Transmitter(SOURCE, antenna=antennas[name]) for name in names}
    above = Grid(np.array([X]), np.array([Y]), Z + 0.005, 1.0)
    line_of_sight = TraceConfig(0, 0, 0)
    with pytest.warns(SceneWarning, match="1 of 1 cells are too near to the transmitter"):
        maps = compute_radio_maps(
            ROOM.scene, transmitters, above, line_of_sight, receive_antenna=Isotropic()
        )
    assert maps["all around"].rss_dbm.item() == transmitters["all around"].power_dbm
    assert maps["none upwards"].rss_dbm.item() < -100.0
