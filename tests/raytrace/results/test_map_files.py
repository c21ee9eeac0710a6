"""A map file is whole or it is refused, and opens without this project."""

import os
from dataclasses import dataclass, fields, replace
from pathlib import Path

import h5py
import numpy as np
import pytest
import xarray as xr

from raytrace import (
    Antenna,
    Grid,
    HalfWaveDipole,
    Isotropic,
    MapFileError,
    PatternTable,
    RadioMap,
    TraceConfig,
    Transmitter,
)
from raytrace.antennas import Monopole, Patch, Sector
from raytrace.arrays import Floats
from raytrace.radio.antennas import Amplitudes
from raytrace.results.antenna_file import as_stored
from raytrace.results.layers import LAYERS

REQUIRED = ("rss_dbm", "rss_coherent_dbm", "path_count")


def small_map() -> RadioMap:
    rng = np.random.default_rng(51)
    grid = Grid.over((0.0, 0.0, 7.0, 5.0), 0.5, 2.0)
    rss = rng.uniform(-120.0, -20.0, grid.shape)
    rss[2, 3] = -np.inf
    return RadioMap(
        rss_dbm=rss,
        rss_coherent_dbm=rss - rng.uniform(0.0, 9.0, grid.shape),
        path_count=np.where(np.isneginf(rss), 0, rng.integers(9, 10_000, grid.shape)),
        grid=grid,
        transmitter=Transmitter((1.5, 2.25, 0.75), 17.5, 5.2e9, HalfWaveDipole(2.15)),
        config=TraceConfig(5, 0),
        provenance={"tracer_version": 1, "wall_time_s": 1.25, "material_edition": "none"},
    ).with_plan("name = 'ein Plan mit Umlauten: äöü'\n", "ab" * 32)


@pytest.fixture
def saved(tmp_path: Path) -> Path:
    path = tmp_path / "map.h5"
    small_map().save(path)
    return path


THETA, PHI = np.linspace(0.0, 180.0, 91), np.linspace(0.0, 360.0, 181)
ANTENNAS = [
    HalfWaveDipole(),
    HalfWaveDipole(2.15, (0.0, 1.0, 1.0)),
    Isotropic(-3.0),
    Monopole(4.5),
    Patch(3.3),
    Sector(7.0, 60.0, 25.0, -45.0),
    PatternTable.of_gain(THETA, PHI, np.add.outer(-THETA / 30.0, np.cos(np.radians(PHI)))),
]


@pytest.mark.parametrize("antenna", ANTENNAS)
def test_a_map_comes_back_as_it_was(tmp_path: Path, antenna: Antenna) -> None:
    first = small_map()
    first = replace(first, transmitter=replace(first.transmitter, antenna=antenna))
    first.save(tmp_path / "map.h5")
    second = RadioMap.load(tmp_path / "map.h5")
    for layer in REQUIRED:
        np.testing.assert_array_equal(getattr(first, layer), getattr(second, layer))
        assert getattr(first, layer).dtype == getattr(second, layer).dtype
    np.testing.assert_array_equal(first.grid.x, second.grid.x)
    np.testing.assert_array_equal(first.grid.y, second.grid.y)
    for name in ("transmitter", "config", "plan_text", "plan_sha256", "provenance"):
        assert getattr(first, name) == getattr(second, name)
    for name in ("height_m", "cell_size_m"):
        assert getattr(first.grid, name) == getattr(second.grid, name)


@dataclass(frozen=True)
class Cardioid:
    """An antenna that the project does not know."""

    azimuth_deg: float

    def amplitudes(self, sine: Floats, azimuth: Floats) -> Amplitudes:
        around = 1.0 + np.cos(azimuth - np.radians(self.azimuth_deg)) * np.sqrt(1.0 - sine**2)
        return Amplitudes(0.7 * around, 0.2j * around * sine)

    def describe(self) -> str:
        return f"cardioid towards {self.azimuth_deg:g} deg"


def test_an_unknown_antenna_comes_back_as_its_pattern(tmp_path: Path) -> None:
    first, antenna = small_map(), Cardioid(70.0)
    first = replace(first, transmitter=replace(first.transmitter, antenna=antenna))
    first.save(tmp_path / "map.h5")
    read = RadioMap.load(tmp_path / "map.h5").transmitter.antenna
    assert isinstance(read, PatternTable)
    assert read.name == antenna.describe()
    assert read == as_stored(antenna)
    rng = np.random.default_rng(53)
    at = rng.uniform(-1.0, 1.0, 500), rng.uniform(-4.0, 7.0, 500)
    for found, expected in zip(read.amplitudes(*at), antenna.amplitudes(*at), strict=True):
        np.testing.assert_allclose(found, expected, atol=1e-3)


def test_both_antennas_may_have_tables_of_different_sizes(tmp_path: Path) -> None:
    first = small_map()
    tables = [PatternTable.of(HalfWaveDipole(axis=(1.0, 0.0, 0.5)), step) for step in (2.0, 5.0)]
    transmitter = replace(first.transmitter, antenna=tables[0])
    replace(first, transmitter=transmitter, receive_antenna=tables[1]).save(tmp_path / "map.h5")
    read = RadioMap.load(tmp_path / "map.h5")
    assert [read.transmitter.antenna, read.receive_antenna] == tables


def test_plain_hdf5_shows_units_names_and_coordinates(saved: Path) -> None:
    first = small_map()
    with h5py.File(saved) as file:
        for layer in REQUIRED:
            assert file[layer].attrs["units"] == ("1" if layer == "path_count" else "dBm")
            assert file[layer].attrs["long_name"]
            for axis, name in enumerate(("y", "x")):
                scale = file[layer].dims[axis][0]
                np.testing.assert_array_equal(scale[:], getattr(first.grid, name))
                assert scale.attrs["units"] == "m"
                assert scale.is_scale
        assert file.attrs["plan_text"] == first.plan_text
        assert file.attrs["plan_sha256"] == first.plan_sha256
        assert file.attrs["max_reflections"] == 5
        assert file.attrs["frequency_hz"] == 5.2e9
        assert file.attrs["made_with_material_edition"] == "none"


def full_map() -> RadioMap:
    """A map with every layer there is."""
    first = small_map()
    rng = np.random.default_rng(52)
    optional = {
        name: rng.uniform(0.0, 1.0, first.grid.shape)
        for name, layer in LAYERS.items()
        if not layer.required
    }
    for name, layer in optional.items():
        if (value := LAYERS[name].without_path) is not None:
            layer[np.isneginf(first.rss_dbm)] = value
    return replace(first, **optional)


def test_optional_layers_come_back_and_others_stay_none(tmp_path: Path) -> None:
    first = full_map()
    assert list(first.layers) == list(LAYERS)
    first.save(tmp_path / "map.h5")
    second = RadioMap.load(tmp_path / "map.h5")
    for name, layer in first.layers.items():
        np.testing.assert_array_equal(layer, second.layers[name])
    assert small_map().delay_spread_s is None
    assert list(small_map().layers) == list(REQUIRED)


def test_every_layer_is_a_field_of_the_map() -> None:
    assert set(LAYERS) <= {field.name for field in fields(RadioMap)}


def test_xarray_opens_the_file_with_coordinates_and_units(tmp_path: Path) -> None:
    first = full_map()
    first.save(tmp_path / "map.h5")
    with xr.open_dataset(tmp_path / "map.h5", engine="h5netcdf", phony_dims=None) as data:
        assert data["delay_spread_s"].dims == ("y", "x")
        assert data["delay_spread_s"].attrs["units"] == "s"
        np.testing.assert_array_equal(data["x"], first.grid.x)
        cell = data["rss_dbm"].sel(x=first.grid.x[3], y=first.grid.y[1])
        assert float(cell) == first.rss_dbm[1, 3]


def test_data_set_is_the_file_as_xarray_reads_it(saved: Path) -> None:
    mine = RadioMap.load(saved).to_xarray()
    assert float(mine["z"]) == 2.0
    with xr.open_dataset(saved, engine="h5netcdf") as data:
        for name in (*REQUIRED, "x", "y"):
            xr.testing.assert_equal(data[name], mine[name].drop_vars("z", errors="ignore"))
            assert data[name].attrs == mine[name].attrs
        assert set(data.attrs) == set(mine.attrs)


def test_a_file_of_before_the_optional_layers_and_axes_is_read(saved: Path) -> None:
    with h5py.File(saved, "r+") as file:
        for name in [key for key in file.attrs if key.startswith("receive_antenna")]:
            del file.attrs[name]
        del file.attrs["transmit_antenna_axis"]
    read = RadioMap.load(saved)
    assert read.transmitter == small_map().transmitter
    assert read.receive_antenna == HalfWaveDipole()


@pytest.mark.parametrize(
    "antenna",
    [
        Isotropic(3.0),
        HalfWaveDipole(2.15, (1.0, 0.0, 0.0)),
        PatternTable.of_gain([0.0, 90.0, 180.0], [0.0, 180.0, 360.0], np.eye(3)),
    ],
    ids=lambda antenna: type(antenna).__name__,
)
def test_the_receive_antenna_comes_back(antenna: Antenna, tmp_path: Path) -> None:
    replace(small_map(), receive_antenna=antenna).save(tmp_path / "map.h5")
    read = RadioMap.load(tmp_path / "map.h5")
    assert read.receive_antenna == antenna
    assert read.transmitter == small_map().transmitter


@pytest.mark.parametrize("fraction", [0.0, 0.01, 0.2, 0.5, 0.9, 0.98])
def test_a_truncated_file_is_refused(saved: Path, fraction: float) -> None:
    content = saved.read_bytes()
    saved.write_bytes(content[: int(fraction * len(content))])
    with pytest.raises(MapFileError, match=r"map\.h5.*again") as error:
        RadioMap.load(saved)
    assert (error.value.path, error.value.remedy) == (saved, "make_map")


@pytest.mark.parametrize("content", [b"", b"x,y,rss\n1,2,3\n", b"\x89HDF\r\n\x1a\n" + bytes(999)])
def test_a_file_of_another_kind_is_refused(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "map.h5"
    path.write_bytes(content)
    with pytest.raises(MapFileError, match=r"map\.h5"):
        RadioMap.load(path)


def test_hdf5_of_another_kind_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "map.h5"
    with h5py.File(path, "w") as file:
        file["rss_dbm"] = np.zeros((3, 3))
    with pytest.raises(MapFileError, match=r"map\.h5.*not a radio map"):
        RadioMap.load(path)


@pytest.mark.parametrize("version", [0, 3, "1"])
def test_another_version_is_refused(saved: Path, version: int | str) -> None:
    with h5py.File(saved, "r+") as file:
        file.attrs["format_version"] = version
    with pytest.raises(MapFileError, match=rf"map\.h5.*{version}.*again"):
        RadioMap.load(saved)


@pytest.mark.parametrize("name", [*REQUIRED, "x", "y"])
def test_a_missing_dataset_is_named(saved: Path, name: str) -> None:
    with h5py.File(saved, "r+") as file:
        del file[name]
    with pytest.raises(MapFileError, match=rf"map\.h5.*{name}.*again"):
        RadioMap.load(saved)


@pytest.mark.parametrize("name", ["format_version", "frequency_hz", "transmit_antenna"])
def test_a_missing_attribute_is_named(saved: Path, name: str) -> None:
    with h5py.File(saved, "r+") as file:
        del file.attrs[name]
    with pytest.raises(MapFileError, match=rf"map\.h5.*{name}.*again"):
        RadioMap.load(saved)


@pytest.mark.parametrize("data", [np.full((10, 14), np.nan), np.zeros((3, 3)), np.zeros(140)])
def test_a_layer_that_does_not_fit_is_refused(saved: Path, data: np.ndarray) -> None:
    with h5py.File(saved, "r+") as file:
        del file["rss_dbm"]
        file["rss_dbm"] = data
    with pytest.raises(MapFileError, match=r"map\.h5.*rss_dbm"):
        RadioMap.load(saved)


def test_a_missing_file_is_just_missing(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match=r"no such radio map file.*nowhere\.h5") as error:
        RadioMap.load(tmp_path / "nowhere.h5")
    assert error.value.remedy == "make_map"
    assert error.value.path == tmp_path / "nowhere.h5"


def test_a_save_that_fails_leaves_the_old_file_and_nothing_else(saved: Path) -> None:
    before = saved.read_bytes()
    broken = replace(small_map(), provenance={"what": object()})
    with pytest.raises(TypeError):
        broken.save(saved)
    assert saved.read_bytes() == before
    assert os.listdir(saved.parent) == ["map.h5"]


def test_a_save_replaces_the_old_file(saved: Path) -> None:
    louder = replace(small_map(), rss_dbm=small_map().rss_dbm + 1.0)
    louder.save(saved)
    np.testing.assert_array_equal(RadioMap.load(saved).rss_dbm, louder.rss_dbm)
    assert os.listdir(saved.parent) == ["map.h5"]


def test_folders_are_made_on_the_way(tmp_path: Path) -> None:
    small_map().save(tmp_path / "new" / "folder" / "map.h5")
    assert (tmp_path / "new" / "folder" / "map.h5").exists()
