"""Maps of several transmitters: what follows from them, and their file."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest
import xarray as xr

from raytrace import (
    Grid,
    HalfWaveDipole,
    Isotropic,
    MapFileError,
    PatternTable,
    RadioMap,
    TraceConfig,
    Transmitter,
    TransmitterMaps,
)
from raytrace.results.map_file import is_radio_map

GRID = Grid.over((0.0, 0.0, 4.0, 3.0), 0.5, 1.5)
TABLE = PatternTable.of(HalfWaveDipole(axis=(1.0, 0.0, 0.5)), 5.0)
KITCHEN = "K\u00fcche"
TRANSMITTERS = {
    "hall": Transmitter((1.0, 2.0, 2.4), 20.0, 2.4e9),
    KITCHEN: Transmitter((3.0, 1.0, 2.0), 17.0, 2.4e9, TABLE),
    "5 GHz": Transmitter((1.0, 2.0, 2.4), 23.0, 5.2e9, Isotropic(2.0)),
}


@pytest.fixture(scope="module")
def maps() -> TransmitterMaps:
    rng = np.random.default_rng(71)
    found: dict[str, RadioMap] = {}
    for name, transmitter in TRANSMITTERS.items():
        rss = rng.uniform(-110.0, -30.0, GRID.shape)
        rss[0, :2] = rss[1, rng.integers(8)] = -np.inf
        found[name] = RadioMap(
            rss_dbm=rss,
            rss_coherent_dbm=rss + 1.0,
            path_count=np.where(np.isneginf(rss), 0, rng.integers(1, 99, GRID.shape)),
            grid=GRID,
            transmitter=transmitter,
            config=TraceConfig(3, 1, 2),
            plan_text="name = 'Stra\u00dfe'",
            plan_sha256="cd" * 32,
            provenance={"tracer_version": 4, "wall_time_s": 1.5, "material_edition": "none"},
            strongest_path_dbm=rss - 1.0,
            receive_antenna=Isotropic(),
        )
    return TransmitterMaps(found)


@pytest.fixture
def saved(maps: TransmitterMaps, tmp_path: Path) -> Path:
    maps.save(tmp_path / "maps.h5")
    return tmp_path / "maps.h5"


def test_best_server_and_total_power_are_those_of_each_cell(maps: TransmitterMaps) -> None:
    for at in np.ndindex(*GRID.shape):
        rss = [one.rss_dbm[at] for one in maps.values()]
        best = int(np.argmax(rss))
        heard = np.isfinite(rss[best])
        assert maps.best_server[at] == (best if heard else -1)
        assert maps.best_server_dbm[at] == rss[best]
        assert maps.best_server_map.rss_dbm[at] == rss[best]
        strongest = list(maps.values())[best].layers["strongest_path_dbm"]
        assert maps.best_server_map.layers["strongest_path_dbm"][at] == strongest[at]
        total = sum(10.0 ** (level / 10.0) for level in rss)
        if heard:
            assert maps.total_dbm[at] == pytest.approx(10.0 * np.log10(total), abs=1e-9)
        else:
            assert np.isneginf(maps.total_dbm[at])


def test_only_transmitters_of_the_same_frequency_interfere(maps: TransmitterMaps) -> None:
    at, noise = (3, 4), 10.0**-9.4
    hall, kitchen, fast = (10.0 ** (one.rss_dbm[at] / 10.0) for one in maps.values())
    for name, ratio in (
        ("hall", hall / (kitchen + noise)),
        (KITCHEN, kitchen / (hall + noise)),
        ("5 GHz", fast / noise),
    ):
        found = maps.sinr_db(server=name)
        assert found[at] == pytest.approx(10.0 * np.log10(ratio), abs=1e-9)
        np.testing.assert_array_equal(np.isneginf(found), np.isneginf(maps[name].rss_dbm))
    best = maps.names[maps.best_server[at]]
    assert maps.sinr_db(-70.0)[at] == maps.sinr_db(-70.0, best)[at]
    assert (maps.sinr_db(-70.0) <= maps.sinr_db(-94.0)).all()
    with pytest.raises(KeyError, match="no transmitter 'attic': there are hall"):
        maps.sinr_db(server="attic")
    with pytest.raises(ValueError, match="noise_dbm = nan"):
        maps.sinr_db(float("nan"))


def test_maps_that_do_not_belong_together_are_refused(maps: TransmitterMaps) -> None:
    first = maps["hall"]
    coarse = Grid.over((0.0, 0.0, 4.0, 3.0), 0.5, 1.0)
    for other, what in (
        (replace(first, grid=coarse), "grids"),
        (replace(first, config=TraceConfig(2)), "limits of the trace"),
        (replace(first, strongest_path_dbm=None), "layers"),
        (replace(first, receive_antenna=HalfWaveDipole()), "receive antennas"),
        (replace(first, plan_sha256="ef"), "plans"),
    ):
        with pytest.raises(ValueError, match=f"maps of 'a' and 'b' have different {what}"):
            TransmitterMaps({"a": first, "b": other})
    with pytest.raises(ValueError, match="at least one"):
        TransmitterMaps({})


FIELDS = (
    "transmitter", "config", "receive_antenna", "plan_text", "plan_sha256", "provenance"
)  # fmt: skip


def test_maps_come_back_as_they_were(maps: TransmitterMaps, saved: Path) -> None:
    read = TransmitterMaps.load(saved)
    assert read.names == maps.names
    for name, one in maps.items():
        other = read[name]
        assert list(other.layers) == list(one.layers)
        for layer, values in one.layers.items():
            np.testing.assert_array_equal(other.layers[layer], values)
        assert [getattr(other, key) for key in FIELDS] == [getattr(one, key) for key in FIELDS]
        assert other.grid.same_as(one.grid)
    assert is_radio_map(saved)


def test_xarray_opens_the_file_as_the_data_set(maps: TransmitterMaps, saved: Path) -> None:
    mine = maps.to_xarray()
    assert mine["rss_dbm"].dims == ("transmitter", "y", "x")
    with xr.open_dataset(saved, engine="h5netcdf") as data:
        assert list(data["transmitter"].values) == list(TRANSMITTERS)
        for name in ("rss_dbm", "path_count", "x", "y", "transmitter_x", "frequency_hz"):
            np.testing.assert_array_equal(data[name], mine[name])
            assert data[name].attrs == mine[name].attrs
        assert set(data.attrs) == set(mine.attrs)
        kitchen = data["rss_dbm"].sel(transmitter=KITCHEN)
        np.testing.assert_array_equal(kitchen, maps[KITCHEN].rss_dbm)


def test_files_of_one_and_of_several_transmitters_are_told_apart(
    maps: TransmitterMaps, saved: Path, tmp_path: Path
) -> None:
    maps["hall"].save(tmp_path / "one.h5")
    with pytest.raises(MapFileError, match="holds maps of transmitters, expected the map of one"):
        RadioMap.load(saved)
    with pytest.raises(MapFileError, match="holds the map of one transmitter, expected maps"):
        TransmitterMaps.load(tmp_path / "one.h5")


def replace_dataset(file: h5py.File, name: str) -> None:
    """Remove a member, or give it another size or doubled names."""
    values = file[name][()] if isinstance(file[name], h5py.Dataset) else None
    del file[name]
    if name == "transmitter":
        file[name] = np.array([b"a", b"a", b"b"])
    elif values is not None:
        file[name] = values[:2]


@pytest.mark.parametrize(
    "name",
    ["transmitter", "rss_dbm", "path_count", "transmitter_x", "transmitter_power_dbm",
     "frequency_hz", "antenna", "antennas", "antennas/1", "x"],
)  # fmt: skip
def test_what_is_missing_or_has_another_size_is_named(saved: Path, name: str) -> None:
    with h5py.File(saved, "r+") as file:
        replace_dataset(file, name)
    with pytest.raises(MapFileError, match=name.split("/")[0]):
        TransmitterMaps.load(saved)


def test_layers_of_a_transmitter_that_contradict_each_other_are_named(saved: Path) -> None:
    with h5py.File(saved, "r+") as file:
        values = file["path_count"][()]
        values[1, 2, 3] = 0
        file["path_count"][...] = values
    with pytest.raises(MapFileError, match="path_count"):
        TransmitterMaps.load(saved)


@pytest.mark.parametrize(
    ("name", "value"),
    [("frequency_hz", 0.0), ("frequency_hz", np.nan), ("transmitter_z", np.inf), ("antenna", 3),
     ("antenna", -1), ("transmitter_power_dbm", np.nan), ("rss_dbm", np.nan)],
)  # fmt: skip
def test_values_out_of_range_are_named(saved: Path, name: str, value: float) -> None:
    with h5py.File(saved, "r+") as file:
        values = file[name][()]
        values[-1] = value
        file[name][...] = values
    with pytest.raises(MapFileError, match=name):
        TransmitterMaps.load(saved)
