"""What all studies write: a table in two formats, and figures."""

import csv

import pytest

from rssnav.experiments.studies.common import as_markdown, write_study
from rssnav.experiments.tables import Column, Table
from rssnav.pictures.style import new_figure


@pytest.fixture
def table():
    return Table(
        "small",
        "Small",
        "What one sees.",
        (Column("name", "Name"), Column("length_m", "Length [m]", 1), Column("x", "x", 0, False)),
        (("a", 1.25, 1), ("b", None, 2), ("c", -3.0, 3)),
    )


def test_markdown_shows_what_people_see(table):
    assert as_markdown(table).splitlines() == [
        "| Name | Length [m] |",
        "| --- | --- |",
        "| a | 1.2 |",
        "| b | – |",
        "| c | −3.0 |",
        "",
        "What one sees.",
    ]


def test_a_study_writes_its_tables_and_figures(table, tmp_path):
    figure = new_figure(2.0, 1.0)
    study = write_study(tmp_path, (table,), {"small": figure})
    names = [path.relative_to(tmp_path).as_posix() for path in study.files]
    assert names == ["tables/small.csv", "tables/small.md", "figures/small.png"]
    assert all(path.is_file() for path in study.files)
    with study.files[0].open(newline="") as file:
        assert next(iter(csv.DictReader(file))) == {"name": "a", "length_m": "1.25", "x": "1"}
