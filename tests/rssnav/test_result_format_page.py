"""docs/result_format.md lists what a training result's file holds, and its example reads one."""

from __future__ import annotations

import re

import h5py
import pytest
from documents import ROOT
from small_worlds import world_of

from rssnav import LocationAgent, train

PAGE = (ROOT / "docs" / "result_format.md").read_text(encoding="utf-8")
ROW = re.compile(r"^\| `([a-z_/]+)` \| \((.*?)\) \| (\S+) \|", re.MULTILINE)


@pytest.fixture
def file(tmp_path, room):
    result = train(world_of(room), LocationAgent(), runs=3, episodes=250, keep_q=True)
    result.save(tmp_path / "rss.h5")
    with h5py.File(tmp_path / "rss.h5") as file:
        yield file


def test_the_page_lists_every_dataset_with_its_units_and_dimensions(file) -> None:
    found = {}
    file.visititems(
        lambda name, item: found.update({name: item}) if isinstance(item, h5py.Dataset) else None
    )
    listed = {name: (shape.split(", "), units) for name, shape, units in ROW.findall(PAGE)}
    assert set(listed) == set(found)
    for name, (dimensions, units) in listed.items():
        assert len(dimensions) == found[name].ndim, name
        assert units == found[name].attrs["units"], name


def test_the_example_reads_a_file(file, tmp_path, monkeypatch, capsys) -> None:
    monkeypatch.chdir(tmp_path)
    (example,) = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)
    exec(compile(example, "result_format.md", "exec"), {})
    assert capsys.readouterr().out.strip().endswith("location")
