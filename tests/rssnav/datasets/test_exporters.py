"""Each layout holds the values of the data set, by its own rules."""

from __future__ import annotations

import csv
import re

import numpy as np
import pytest
from PIL import Image
from small_datasets import SPEC, edited, made

import floorplans
from rssnav.datasets.container import read_plan_file
from rssnav.datasets.errors import DatasetError
from rssnav.datasets.exporters.challenge import wall_losses
from rssnav.datasets.exporters.formats import FORMATS, export_dataset
from rssnav.datasets.exporters.pieces import plan_pieces

KEEP = "\n[keep]\nstrongest_paths = 2\n"


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    folder = tmp_path_factory.mktemp("made") / "whole"
    made(folder, SPEC + KEEP)
    return folder


def exported(folder, out, layout):
    """Export; progress ends at the number of plans."""
    told: list[tuple[int, int]] = []
    export_dataset(folder, out, layout, lambda done, total: told.append((done, total)))
    assert told[-1] == (3, 3)
    return out


@pytest.mark.parametrize("layout", FORMATS)
def test_an_existing_folder_is_left_alone(whole, tmp_path, layout) -> None:
    (tmp_path / "letter").touch()
    with pytest.raises(DatasetError, match="exists already: expected a new folder"):
        export_dataset(whole, tmp_path, layout, lambda *_: None)
    assert [path.name for path in tmp_path.iterdir()] == ["letter"]


def test_the_challenge_has_path_loss_distance_and_walls(whole, tmp_path) -> None:
    out = exported(whole, tmp_path / "out", "challenge")
    pieces = list(plan_pieces(whole))
    outputs = sorted(path.name for path in (out / "Outputs").rglob("*.png"))
    assert len(outputs) == 12
    assert all(re.fullmatch(r"B[123]_Ant1_f[12]_S[01]\.png", name) for name in outputs)
    maps = pieces[1].maps
    rss = maps.layers["rss_dbm"][0, 0, 0, 1, 1]
    image = np.array(Image.open(out / "Outputs/Task_1_ICASSP/B2_Ant1_f2_S1.png"))
    wanted = np.where(np.isfinite(rss), 20.0 - rss, 255)
    assert np.abs(image - wanted).max() <= 0.5
    inputs = np.array(Image.open(out / "Inputs/Task_1_ICASSP/B2_Ant1_f2_S1.png"))
    x, y, _ = maps.positions[1]
    assert np.abs(inputs[..., 2] - np.hypot(maps.x - x, (maps.y - y)[:, None])).max() <= 0.5
    with (out / "Positions/Positions_B2_Ant1_f2.csv").open() as file:
        rows = list(csv.reader(file))
    assert rows[0] == ["", "X", "Y", "Azimuth"]
    assert [float(rows[2][1]), float(rows[2][2])] == pytest.approx(
        [(x - maps.x[0]) / 2.0, (y - maps.y[0]) / 2.0], abs=0.5
    )


def test_walls_have_the_losses_of_their_slab_where_they_stand() -> None:
    plan = floorplans.load("flat")
    x, y = np.arange(0.25, plan.bounds[2], 0.5), np.arange(0.25, plan.bounds[3], 0.5)
    reflection, transmission = wall_losses(plan, x, y, 1.5, 2.4e9)
    assert (reflection > 0).any()
    assert ((reflection > 0) == (transmission > 0)).all()
    r, t = (10.0 ** (-loss[reflection > 0] / 10.0) for loss in (reflection, transmission))
    assert (r + t <= 1.0 + 1e-9).all()
    middle = wall_losses(plan, x, y, plan.height_m - 0.05, 2.4e9)[0]
    assert (middle > 0).sum() > (reflection > 0).sum()  # above doors there is wall


def test_deepmimo_has_the_paths_of_the_cells_inside(whole, tmp_path) -> None:
    out = exported(whole, tmp_path / "out", "deepmimo")
    piece = next(plan_pieces(whole))
    file = out / piece.about.split / piece.about.name / "p0_h0_a0_f1_t0.npz"
    with np.load(file) as found:
        arrays = dict(found)
    n = int(piece.maps.inside[0].sum())
    assert arrays["power"].shape == arrays["delay"].shape == (n, 2)
    assert arrays["rx_pos"].shape == (n, 3)
    there = ~np.isnan(arrays["power"])
    straight = np.linalg.norm(arrays["rx_pos"] - arrays["tx_pos"], axis=1)
    los = there & (arrays["inter"] == 0)
    assert los.any()
    rows, columns = np.nonzero(los)
    assert arrays["delay"][rows, columns] * 299792458.0 == pytest.approx(straight[rows], rel=1e-5)
    assert set(np.unique(arrays["inter"][there])) <= {0, 1, 4, 14, 41}
    power = piece.maps.paths["path_power_dbm"][0, 0, 0, 1, 0][piece.maps.inside[0]]
    assert np.allclose(arrays["power"][there], power[there] - 20.0, atol=1e-4)


def test_a_layout_that_needs_paths_says_so(tmp_path) -> None:
    made(tmp_path / "set", edited("seeds = 3", "seeds = 1"))
    with pytest.raises(DatasetError, match="expected strongest_paths in"):
        export_dataset(tmp_path / "set", tmp_path / "out", "deepmimo", lambda *_: None)
    assert not (tmp_path / "out").exists()
    assert [path.name for path in tmp_path.iterdir()] == ["set"]


def test_zarr_has_every_array(whole, tmp_path) -> None:
    zarr = pytest.importorskip("zarr")
    out = exported(whole, tmp_path / "out", "zarr")
    root = zarr.open_group(store=str(out), mode="r")
    assert root.metadata.zarr_format == 3
    for piece in plan_pieces(whole):
        group = root[f"{piece.about.split}/{piece.about.name}"]
        for name, values in {**piece.maps.layers, **piece.maps.paths}.items():
            assert np.array_equal(group[name][...], values)
            assert group[name].metadata.dimension_names[:2] == ("preset", "height")


def test_samples_in_parquet_are_the_maps(whole, tmp_path) -> None:
    pq = pytest.importorskip("pyarrow.parquet")
    out = exported(whole, tmp_path / "out", "parquet")
    rows = [r for path in sorted((out / "data").glob("*")) for r in pq.read_table(path).to_pylist()]
    assert len(rows) == 12
    for row in rows:
        maps, _ = read_plan_file(whole / row["file"])
        index = tuple(
            row[f"index_{a}"] for a in ("preset", "height", "antenna", "frequency", "transmitter")
        )
        shape = row["n_y"], row["n_x"]
        found = np.array(row["rss_dbm"], np.float32).reshape(shape)
        assert np.array_equal(found, maps.layers["rss_dbm"][index])
    card = (out / "README.md").read_text()
    assert "- split: train\n    path: data/train-*.parquet" in card.split("---")[1]
