"""A byte order mark before a text file is no reason to refuse it."""

from __future__ import annotations

from codecs import BOM_UTF8
from pathlib import Path

import pytest
from ifc_models import house

import floorplans
from floorplans.exporters import export
from floorplans.importers import ImportOptions, import_plan


def written_as(suffix: str, folder: Path) -> Path:
    path = folder / f"flat{suffix}"
    if suffix == ".ifc":
        return house().write(path)
    export(floorplans.load("flat"), path)
    return path


@pytest.mark.parametrize("suffix", [".dxf", ".geojson", ".ifc", ".yaml"])
def test_a_file_with_a_byte_order_mark_is_imported_as_without(suffix: str, tmp_path: Path):
    path = written_as(suffix, tmp_path)
    options = ImportOptions(level="0") if suffix == ".ifc" else ImportOptions()
    without = import_plan(path, options).plan
    path.write_bytes(BOM_UTF8 + path.read_bytes())
    assert import_plan(path, options).plan == without
