"""All studies: their names, and what run_study writes of any of them."""

import csv

import pytest

from rssnav.cli.experiments import What
from rssnav.experiments.studies import STUDIES, Study, run_study
from rssnav.experiments.tables import Column, Table
from rssnav.pictures.style import new_figure


def small_table(rows):
    return Table(
        "small",
        "Small",
        "What one sees.",
        (Column("name", "Name"), Column("length_m", "Length [m]", 1), Column("x", "x", 0, False)),
        tuple(rows),
    )


def test_the_command_line_has_every_study():
    assert {what.value for what in What} == {"paper", *STUDIES}


@pytest.mark.parametrize("study", STUDIES.values(), ids=STUDIES)
def test_pieces_say_completely_what_is_measured(study):
    assert len(set(study.pieces)) == len(study.pieces)


def test_markdown_shows_what_people_see():
    table = small_table([("a", 1.25, 1), ("b", None, 2), ("c", -3.0, 3)])
    assert table.markdown().splitlines() == [
        "| Name | Length [m] |",
        "| --- | --- |",
        "| a | 1.2 |",
        "| b | – |",
        "| c | −3.0 |",
        "",
        "What one sees.",
    ]


def test_a_study_measures_its_pieces_and_writes_tables_and_figures(small_study):
    def measure(piece, conditions):
        return [(piece, piece / 4, conditions.runs)]

    study = Study(
        "small",
        5,
        2,
        (1, 5),
        measure,
        lambda outcomes: (small_table(outcomes),),
        lambda _: {"small": new_figure(2.0, 1.0)},
    )
    result = run_study(study, small_study, quick=True)
    names = [path.relative_to(small_study).as_posix() for path in result.files]
    assert names == ["tables/small.csv", "tables/small.md", "figures/small.png"]
    assert all(path.is_file() for path in result.files)
    with result.files[0].open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert rows == [
        {"name": "1", "length_m": "0.25", "x": "2"},
        {"name": "5", "length_m": "1.25", "x": "2"},
    ]
