"""Maps drawn in one call, tables as CSV files, and one-line descriptions."""

import csv
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pytest

import floorplans
from raytrace import Grid, RadioMap, Scene, TraceConfig, Transmitter, compute_radio_map, trace_paths
from rssnav.scenes import scene_of

TRANSMITTER = Transmitter((1.2, 7.9, 0.8))


@pytest.fixture(scope="module")
def flat() -> Scene:
    return scene_of(floorplans.load("flat"))


@pytest.fixture(scope="module")
def radio_map(flat: Scene) -> RadioMap:
    grid = Grid.over((0.0, 0.0, 12.0, 9.0), 1.5, 1.3)
    return compute_radio_map(flat, TRANSMITTER, grid, TraceConfig(1, 0))


def test_a_plot_shows_the_layer_where_the_cells_are(radio_map: RadioMap, flat: Scene) -> None:
    axes = radio_map.plot("delay_spread_s", walls=flat.walls)
    try:
        image, lines = axes.images[0], axes.collections[0]
        shown = np.ma.getdata(image.get_array())
        has_path = radio_map.path_count > 0
        assert not has_path.all()
        np.testing.assert_array_equal(np.ma.getmaskarray(image.get_array()), ~has_path)
        assert radio_map.delay_spread_s is not None
        np.testing.assert_array_equal(shown[has_path], radio_map.delay_spread_s[has_path])
        assert tuple(image.get_extent()) == (0.0, 12.0, 0.0, 9.0)
        assert len(lines.get_paths()) == len(flat.walls)
        star = axes.lines[0].get_xydata()
        np.testing.assert_allclose(star, [TRANSMITTER.position[:2]])
    finally:
        plt.close("all")


def test_a_plot_may_join_other_axes(radio_map: RadioMap) -> None:
    _, axes = plt.subplots()
    try:
        assert radio_map.plot(ax=axes) is axes
        with pytest.raises(ValueError, match="layer = 'rss': expected one of rss_dbm, "):
            radio_map.plot("rss", ax=axes)
    finally:
        plt.close("all")


def test_a_table_of_a_map_has_every_cell_and_layer(radio_map: RadioMap, tmp_path: Path) -> None:
    radio_map.to_csv(tmp_path / "map.csv")
    with (tmp_path / "map.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert list(rows[0]) == ["x", "y", "z", *radio_map.layers]
    points = np.array([[float(row[axis]) for axis in "xyz"] for row in rows])
    np.testing.assert_array_equal(points, radio_map.grid.points())
    found = np.array([float(row["rss_dbm"]) for row in rows])
    np.testing.assert_array_equal(found, radio_map.rss_dbm.ravel())


def test_a_table_of_paths_is_the_data_frame(flat: Scene, tmp_path: Path) -> None:
    pandas = pytest.importorskip("pandas")
    points = np.array([[3.1, 6.3, 1.4], [9.7, 2.2, 1.1]])
    paths = trace_paths(flat, TRANSMITTER, points, TraceConfig(2, 1))
    paths.to_csv(tmp_path / "paths.csv")
    read = pandas.read_csv(tmp_path / "paths.csv", keep_default_na=False, dtype=str)
    expected = paths.to_dataframe()
    for column in ("receiver", "sequence", "delay_s", "gain_real", "surfaces"):
        assert read[column].astype(expected[column].dtype).tolist() == expected[column].tolist()


def test_descriptions_fit_a_line(radio_map: RadioMap, flat: Scene) -> None:
    text = repr(radio_map)
    assert text.startswith("<RadioMap 8 x 6 cells of 1.5 m, ")
    assert text.endswith("from (1.2, 7.9, 0.8) at 2.4 GHz>")
    paths = trace_paths(flat, TRANSMITTER, np.array([[3.1, 6.3, 1.4]]), TraceConfig(2, 1))
    assert repr(paths) == f"<Paths: {len(paths)} to 1 receiver, at most 3 interactions>"
    empty = trace_paths(flat, TRANSMITTER, np.array([[-9.0, 0.0, 1.0]]), TraceConfig(0, 0))
    assert repr(empty).startswith("<Paths: 0 to 0 receivers")
    assert "\n" not in text + repr(empty)
