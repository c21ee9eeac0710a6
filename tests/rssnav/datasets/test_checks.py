"""A check finds whatever is wrong with a data set; readers and commands tell it."""

from __future__ import annotations

import ast
import importlib.util
import json
import re
import shutil
from pathlib import Path

import pytest
from cli_plans import done, fault, run
from documents import ROOT, blocks
from small_datasets import edited, made

from rssnav.datasets.baselines import baselines
from rssnav.datasets.checks import problems
from rssnav.datasets.errors import DatasetError


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    folder = tmp_path_factory.mktemp("made") / "whole"
    made(folder, edited("[transmitters]", "[split]\ntrain=1\ntest=1\nvalidation=1\n[transmitters]"))
    return folder


@pytest.fixture
def copy(whole, tmp_path):
    return Path(shutil.copytree(whole, tmp_path / "copy"))


def first(folder: Path, pattern: str = "*/*/*.h5") -> Path:
    return sorted(folder.glob(pattern))[0]


def flip(path: Path) -> None:
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 1
    path.write_bytes(content)


DAMAGE = {
    "a flipped bit": (lambda f: flip(first(f)), "its content is not that of the manifest"),
    "a lost file": (lambda f: first(f).unlink(), "missing"),
    "a lost plan": (lambda f: first(f, "*/*/*.toml").unlink(), "toml"),
    "another plan": (
        lambda f: shutil.copy(sorted(f.glob("*/*/*.toml"))[1], first(f, "*/*/*.toml")),
        "is not the plan of the maps",
    ),
    "a file too many": (
        lambda f: shutil.copy(first(f), first(f).with_name("extra.h5")),
        "extra.h5: not in the manifest",
    ),
    "a lost card": (lambda f: (f / "README.md").unlink(), "README.md: missing"),
    "another spec": (
        lambda f: (f / "spec.toml").write_text(
            (f / "spec.toml").read_text().replace("seeds = 3", "seeds = 4")
        ),
        "plan 'flat-000003' of the spec is missing",
    ),
}


@pytest.mark.parametrize("what", DAMAGE)
def test_damage_is_found(copy, what: str) -> None:
    assert list(problems(copy)) == []
    damage, words = DAMAGE[what]
    damage(copy)
    found = list(problems(copy))
    assert any(words in problem for problem in found), found


def test_the_command_tells_problems_and_exits_with_1(copy) -> None:
    assert done("dataset", "check", copy).endswith(": no problems\n")
    flip(first(copy))
    result = run("dataset", "check", copy, "--json")
    assert result.exit_code == 1
    assert len(json.loads(result.stdout)["problems"]) == 1


def test_no_data_set_is_told(tmp_path) -> None:
    line = fault("dataset", "check", tmp_path)
    assert "no data set: expected a folder with spec.toml" in line
    (tmp_path / "spec.toml").write_text("nam = 1")
    assert "unknown key nam: did you mean name?" in fault("dataset", "info", tmp_path)


def test_info_counts_plans_and_maps(whole) -> None:
    facts = json.loads(done("dataset", "info", whole, "--json"))
    assert facts["complete"]
    assert (facts["plans_finished"], facts["maps"]) == (3, 12)
    assert facts["splits"]["test"] == {"plans": 1, "maps": 4}


def test_a_missing_library_names_the_extra(tmp_path, monkeypatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "pyarrow.parquet", None)
    with pytest.raises(ImportError, match=r'pip install "rssnav\[dataset\]"'):
        made(tmp_path / "set")


def test_baselines_are_exact_where_only_distance_matters(tmp_path) -> None:
    """Empty halls, direct paths alone: RSS is that of free space."""
    text = edited('kind = "flat"', 'kind = "hall"\nfurniture = false')
    for old, new in (
        ("reflections = 1", "reflections = 0"),
        ("cell_size_m = 2.0", "cell_size_m = 1.0"),
        ("[transmitters]", "[split]\ntrain=2\ntest=1\n[transmitters]"),
    ):
        text = edited(old, new, text)
    made(tmp_path / "set", text)
    rows = baselines(tmp_path / "set", 0, lambda *_: None)
    assert [row.n_maps for row in rows] == [4] * 4
    assert [row.rmse_db < 1e-3 for row in rows] == [True, True, True, False]
    assert all(row.mae_db <= row.rmse_db for row in rows)


def test_baselines_need_both_splits(whole, tmp_path) -> None:
    made(tmp_path / "set", edited("[transmitters]", "[split]\ntrain=1\n[transmitters]"))
    with pytest.raises(DatasetError, match="need maps in the splits train and test"):
        baselines(tmp_path / "set", 0, lambda *_: None)


@pytest.mark.skipif(importlib.util.find_spec("torch") is None, reason="PyTorch is not installed")
def test_the_reader_for_pytorch_streams_each_map_once(whole, monkeypatch) -> None:
    monkeypatch.chdir(whole.parent)
    page = (ROOT / "docs" / "how_to" / "make_a_dataset.md").read_text("utf-8")
    text = next(b.text for b in blocks(page) if "IterableDataset" in b.text)
    import h5py
    import pyarrow.parquet as pq

    rows = pq.read_table(whole / "manifest.parquet").to_pylist()
    axes = ("preset", "height", "antenna", "frequency", "transmitter")
    names = {"h5py": h5py, "axes": axes}
    exec(compile(text.replace("flats/", "whole/"), "page", "exec"), names)
    loader = names["torch"].utils.data.DataLoader(names["Maps"](rows), batch_size=None)
    assert sum(1 for _ in loader) == len(rows)


def test_readers_on_the_page_have_about_ten_lines() -> None:
    page = (ROOT / "docs" / "how_to" / "make_a_dataset.md").read_text("utf-8")
    readers = [b.text for b in blocks(page) if re.search("h5py|xarray|torch", b.text)]
    assert len(readers) == 3
    for text in readers:
        assert len(ast.unparse(ast.parse(text)).splitlines()) <= 14
