"""Angles, phases, the delay profile and the table of a cell's paths; settings of a trace."""

from __future__ import annotations

import csv
from dataclasses import replace
from io import StringIO
from itertools import pairwise

import numpy as np
import pytest
from shapely.geometry import Polygon

import floorplans
from floorplans import Wall
from raytrace import HalfWaveDipole, Isotropic, trace_paths
from raytrace.antennas import Patch, Rotated
from raytrace.results.csv_file import write_csv
from rssnav.cli.radio import config_of, radio_of
from rssnav.explorer.antenna_choice import AntennaChoice
from rssnav.explorer.cell_panel import ANGLES, DELAYS, _table
from rssnav.explorer.cell_paths import TOP, CellPaths, path_colours
from rssnav.explorer.delay_profile import SHOWN_DB, DelayProfile
from rssnav.explorer.file_buttons import written
from rssnav.explorer.map_settings import MapSettings
from rssnav.explorer.space_view import map_picture, page_3d
from rssnav.explorer.tracing import TracedMap
from rssnav.maps import cells_inside, make_map
from rssnav.presets import PRESETS
from rssnav.scenes import scene_of

FLAT = floorplans.load("flat")
SETTINGS = MapSettings(max_reflections=2)
RECEIVER = (6.5, 4.5, 2.0)


def paths_with(settings: MapSettings) -> CellPaths:
    paths = trace_paths(
        scene_of(FLAT), settings.transmitter(FLAT), np.array([RECEIVER]),
        settings.config(complete=True), receive_antenna=settings.receive_antenna.antenna,
    )  # fmt: skip
    return CellPaths(FLAT, settings, RECEIVER, paths)


@pytest.fixture(scope="module")
def found() -> CellPaths:
    return paths_with(SETTINGS)


def towards(angles_deg: np.ndarray) -> np.ndarray:
    """Unit vectors (n, 3) of azimuth and elevation (n, 2) [deg]."""
    azimuth, elevation = np.radians(angles_deg).T
    flat = np.cos(elevation)
    return np.column_stack([flat * np.cos(azimuth), flat * np.sin(azimuth), np.sin(elevation)])


def test_angles_lead_from_end_to_end_of_each_path(found) -> None:
    vertices, last = found.paths.vertices, found.paths.n_interactions
    rows = np.arange(len(last))
    leaving = vertices[:, 1] - vertices[:, 0]
    coming = vertices[rows, last] - vertices[rows, last + 1]
    for angles, vector in ((found.departure_deg, leaving), (found.arrival_deg, coming)):
        length = np.linalg.norm(vector, axis=1, keepdims=True)
        np.testing.assert_allclose(towards(angles), vector / length, atol=1e-12)


def test_the_table_of_a_file_gives_the_complex_gains(found) -> None:
    text = written("paths.csv", lambda path: write_csv(path, found.columns(50))).decode()
    rows = list(csv.DictReader(StringIO(text)))
    assert len(rows) == 50
    power, phase, real, imag = (
        np.array([float(row[name]) for row in rows])
        for name in ("power_dbm", "phase_deg", "gain_real", "gain_imag")
    )
    amplitude = 10.0 ** ((power - SETTINGS.power_dbm) / 20.0)
    np.testing.assert_allclose(amplitude * np.exp(1j * np.radians(phase)), real + 1j * imag)
    assert np.all(np.diff(power) <= 0.0)


def test_a_phase_of_unknown_polarisation_is_not_shown() -> None:
    unknown = paths_with(replace(SETTINGS, receive_antenna=AntennaChoice.of("unpolarised")))
    assert unknown.phase_deg is None
    assert "phase_deg" not in unknown.columns(5)
    assert "The phase is unknown" in _table(unknown, ANGLES)


@pytest.mark.parametrize("columns", [DELAYS, ANGLES])
def test_the_table_has_a_row_for_each_of_the_strongest(found, columns) -> None:
    html = _table(found, columns)
    body = html[html.index("<tbody>") :]
    assert body.count("<tr>") == TOP
    assert body.count("<td>") % TOP == 0


def test_the_delay_profile_has_a_stem_for_each_path_above_its_foot(found) -> None:
    profile = DelayProfile()
    n = profile.show(found)
    power_dbm = found.power_dbm
    assert n == np.count_nonzero(power_dbm > power_dbm.max() - SHOWN_DB)
    shown = profile._stems.data
    np.testing.assert_allclose(np.sort(shown["power"]), np.sort(power_dbm[:n]))
    np.testing.assert_allclose(np.sort(shown["delay"]), np.sort(1e9 * found.paths.delay_s[:n]))
    assert shown["colour"][-TOP:] == path_colours(power_dbm[:TOP])[::-1]
    assert profile.show(None) == 0
    assert not profile.model.visible


def test_directions_of_antennas_are_those_of_the_tracer() -> None:
    assert AntennaChoice.of("dipole").antenna == HalfWaveDipole()
    assert AntennaChoice("dipole", 90.0, 0.0).antenna == HalfWaveDipole(axis=(0.0, 1.0, 0.0))
    assert AntennaChoice("patch", 180.0, 0.0).antenna == Rotated.towards(Patch(), (-1.0, 0.0, 0.0))
    assert AntennaChoice("isotropic", 40.0, 50.0).antenna == Isotropic()


@pytest.mark.parametrize(
    ("name", "angle"),
    [("/etc/hostname.csv", 0.0), ("", 0.0), ("patch", np.inf), ("patch", 1e9), ("patch", "0")],
)
def test_an_antenna_is_never_a_file_and_has_an_angle(name, angle) -> None:
    with pytest.raises(ValueError, match=r"antenna|Azimuth"):
        AntennaChoice(name, angle)


@pytest.mark.parametrize("preset", PRESETS)
def test_settings_are_those_of_the_commands(preset) -> None:
    settings = MapSettings().with_preset(preset)
    assert settings.preset == preset
    assert settings.config(complete=True) == PRESETS[preset].config
    radio = radio_of("flat", FLAT, None, {"preset": preset})
    assert settings.transmitter(FLAT) == radio.transmitters["source"]
    assert settings.receive_antenna.antenna == radio.receive_antenna
    for most, option in ((None, "none"), (2, "2")):
        chosen = replace(settings, max_transmissions=most)
        options = {"transmissions": option}
        assert chosen.config(complete=True) == config_of(PRESETS[preset], options)
        assert chosen.preset == (preset if chosen == settings else None)


def test_the_map_on_the_floor_is_north_up_in_the_colours_of_the_map() -> None:
    corners = [(0, 0), (6, 0), (6, 2), (3, 2), (3, 4), (0, 4), (0, 0)]
    walls = tuple(Wall(a, b, "concrete", 0.2, FLAT.height_m) for a, b in pairwise(corners))
    places = {"source": (1.5, 0.5, 1.5), "start": (0.5, 3.5)}
    plan = replace(FLAT, outline=Polygon(corners), walls=walls, **places)
    settings = replace(SETTINGS, cell_size_m=1.0, max_reflections=0)
    radio_map = make_map(plan, cell_size_m=1.0, config=settings.config(complete=False))
    rss = radio_map.rss_dbm.copy()
    rss[0, 0] = -np.inf
    radio_map = replace(radio_map, rss_dbm=rss)
    inside = cells_inside(plan, radio_map.grid)
    picture = map_picture(radio_map, inside)[::-1]
    grey = picture[0, 0, :3]
    assert grey.max() == grey.min()
    assert (picture[~inside, 3] == 0).all()
    assert (picture[inside, 3] == 255).all()
    green = np.where(inside & np.isfinite(rss), picture[..., 1].astype(int), -1)
    strongest = np.unravel_index(np.argmax(np.where(inside, rss, -np.inf)), rss.shape)
    assert green[strongest] == green.max()
    traced = TracedMap(plan, settings, radio_map, True)
    assert "RSS [dBm]" in page_3d(plan, None, traced)
    assert "RSS [dBm]" not in page_3d(plan)
