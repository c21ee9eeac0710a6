"""Every format of the table writes its files, whole or not at all."""

import pytest

import floorplans
from floorplans import PlanError
from floorplans.exporters import FORMATS, ExportOptions, export, format_of


@pytest.mark.parametrize("kind", FORMATS, ids=lambda kind: kind.name)
def test_each_format_writes_what_it_reports(kind, tmp_path) -> None:
    for suffix in kind.suffixes:
        path = tmp_path / kind.name / f"plan{suffix}"
        files = export(floorplans.load("flat"), path)
        assert files[0] == path
        assert all(file.stat().st_size > 0 for file in files)
        written = {file for file in path.parent.rglob("*") if file.is_file()}
        assert set(files) <= written
        assert not [file for file in written if file.name.endswith(".part")]


def test_a_format_can_be_named(tmp_path) -> None:
    (path,) = export(floorplans.load("flat"), tmp_path / "plan.txt", "geojson")
    assert path.read_text().startswith('{"crs": null, "type": "FeatureCollection"')


def test_unknown_formats_say_which_are_known(tmp_path) -> None:
    plan = floorplans.load("flat")
    with pytest.raises(PlanError, match=r"'.doc'; known: .geojson, .json, .dxf"):
        export(plan, tmp_path / "plan.doc")
    with pytest.raises(PlanError, match='did you mean "geojson"'):
        export(plan, tmp_path / "plan.txt", "geojsn")
    assert format_of(tmp_path / "PLAN.DXF").name == "dxf"


def test_nothing_is_left_of_what_cannot_be_written(tmp_path) -> None:
    (tmp_path / "plan.yaml").mkdir()
    with pytest.raises(PlanError, match="cannot be written"):
        export(floorplans.load("flat"), tmp_path / "plan.yaml", options=ExportOptions())
    assert [file.name for file in tmp_path.iterdir()] == ["plan.yaml"]
