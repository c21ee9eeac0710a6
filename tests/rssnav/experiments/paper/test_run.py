"""The whole paper in miniature: from two small plans to the report."""

import csv
import json
import re
import shutil
from dataclasses import replace
from html import escape

import h5py
import numpy as np
import pytest
from cli_plans import run as command
from small_disk import no_file_above
from small_paper import plan_text, small_data

from rssnav import TrainingInterrupted, TrainingResult
from rssnav.experiments import training_store
from rssnav.experiments.paper import report_again, run_paper
from rssnav.experiments.paper import run as paper
from rssnav.experiments.paper.claims import CLAIMS
from rssnav.experiments.paper.counting import COMPARED_COUNTS, Count, counted_lengths_m
from rssnav.experiments.paper.data import Configuration, flights
from rssnav.experiments.paper.figures import FIGURES
from rssnav.experiments.paper.first_episodes import first_episodes
from rssnav.experiments.paper.interpretation import INTERPRETATIONS
from rssnav.experiments.paper.printed_values import PATH_LENGTH_M
from rssnav.experiments.paper.provenance import parameters
from rssnav.experiments.paper.report import Report, number, render
from rssnav.experiments.paper.tables.convergence import table as convergence_table
from rssnav.experiments.paper.tables.optimum import table as optimum_table
from rssnav.experiments.paper.tables.path_lengths import table as path_lengths
from rssnav.experiments.paper.trainings import TrainingPlan
from rssnav.experiments.tables import Column, Table
from rssnav.experiments.training_store import TrainingStore
from rssnav.result_file import ResultFileError

RUNS = 2


class Run:
    """A run of the paper, with what it said."""

    def __init__(self, folder):
        self.plans = []
        for k in (1, 2):
            self.plans.append(folder / f"plan{k}.toml")
            self.plans[-1].write_text(plan_text(k), encoding="utf-8")
        self.out = folder / "results"
        self.progress, self.notices = [], []
        self.paper = self.again()
        self.first_progress = list(self.progress)
        self.html = self.paper.report.read_text(encoding="utf-8")

    def again(self, **changes):
        self.progress.clear()
        self.notices.clear()
        settings = {"runs": RUNS, "plans": self.plans, **changes}
        return run_paper(
            self.out,
            progress=lambda *each: self.progress.append(each),
            notice=self.notices.append,
            **settings,
        )


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    return Run(tmp_path_factory.mktemp("paper"))


def test_stages_follow_each_other_and_end(run):
    stages = list(dict.fromkeys(stage for stage, _, _ in run.first_progress))
    assert stages == [
        "map of small1",
        "map of small2",
        "training",
        "first episodes",
        "figures",
        "tables and report",
    ]
    for stage in stages:
        done = [each[1] for each in run.first_progress if each[0] == stage]
        total = [each[2] for each in run.first_progress if each[0] == stage][-1]
        assert done == sorted(done)
        assert done[-1] == total


def test_everything_is_written(run):
    names = {str(path.relative_to(run.out)) for path in run.out.rglob("*") if path.is_file()}
    figures = {f"figures/{f.key}.{suffix}" for f in FIGURES for suffix in ("png", "pdf")}
    files = {f"training/{RUNS}-runs/{key.name}.h5" for key in run.paper.data.results}
    tables = {f"tables/{table.key}.csv" for table in run.paper.tables} | {"tables/claims.csv"}
    assert len(files) == 12
    assert figures | files | tables <= names
    assert {"maps/small1.h5", "maps/small2.h5", "summary.json", "report.html"} <= names
    assert not [name for name in names if "part" in name or "tmp" in name]


def test_the_report_shows_every_figure_table_and_claim(run):
    for figure in FIGURES:
        assert f'id="figure-{figure.key}"' in run.html
    for table in run.paper.tables:
        assert f'id="table-{table.key}"' in run.html
    for claim in CLAIMS:
        assert f'id="claim-{claim.key}"' in run.html
    assert run.html.count("data:image/png;base64,") == len(FIGURES)
    for reading in INTERPRETATIONS:
        assert escape(reading.name).replace("&#x27;", "&#39;") in run.html
    for scenario in run.paper.data.scenarios.values():
        assert scenario.plan.sha256 in run.html


def test_every_entry_of_the_contents_leads_somewhere(run):
    targets = re.findall(r'href="#([^"]+)"', run.html)
    assert len(targets) > len(CLAIMS)
    for target in targets:
        assert f'id="{target}"' in run.html


def test_the_report_needs_nothing_beside_it(run):
    text = re.sub(r"data:image/png;base64,[A-Za-z0-9+/=]+", "data:", run.html)
    assert "http" not in text
    assert "@import" not in text
    assert "url(" not in text
    assert "<script" not in text
    assert "<link" not in text
    assert set(re.findall(r'src="([^"]*)"', text)) == {"data:"}
    assert {href[0] for href in re.findall(r'href="([^"]*)"', text)} == {"#"}


@pytest.fixture
def one_figure(monkeypatch):
    """Drawing takes most of the time."""
    monkeypatch.setattr(paper, "FIGURES", FIGURES[:1])


@pytest.mark.usefixtures("one_figure")
def test_a_second_call_takes_everything_over(run):
    before = {
        path: path.stat().st_mtime_ns for path in (run.out / "training" / f"{RUNS}-runs").iterdir()
    }
    again = run.again()
    assert {path: path.stat().st_mtime_ns for path in before} == before
    assert (
        f"12 of 12 trainings were reused from {run.out / 'training' / f'{RUNS}-runs'}"
        in run.notices
    )
    assert again.record.trained == {}
    for key, result in run.paper.data.results.items():
        np.testing.assert_array_equal(again.data.results[key].steps, result.steps)


@pytest.mark.usefixtures("one_figure")
def test_the_report_can_be_made_again_from_the_folder_alone(run):
    report = run.out / "report.html"
    report.unlink()
    again = report_again(run.out)
    assert report.is_file()
    assert again.record.runs == RUNS
    assert again.record.trained == {}


def test_without_a_run_there_is_nothing_to_report_on(tmp_path):
    with pytest.raises(FileNotFoundError, match="rssnav experiments"):
        report_again(tmp_path)


def run_summary(**changed):
    """Text of a summary with a fault."""
    settings = {"seed": 0, "runs": 3, "quick": True, "plans": ["a", "b"], "count": "all steps"}
    return json.dumps({"run": settings | changed})


@pytest.mark.parametrize(
    "text",
    [
        "{",
        "[]",
        '{"run": 1}',
        run_summary(quick=1),
        run_summary(runs=-3),
        run_summary(plans=["flat", None]),
        run_summary(count=None),
        run_summary(count="some"),
        "[" * 100_000,
    ],
)
def test_a_damaged_summary_is_no_run_to_report_on(tmp_path, text):
    (tmp_path / "summary.json").write_text(text)
    with pytest.raises(ResultFileError, match=r"summary\.json is damaged"):
        report_again(tmp_path)


def test_two_plans_are_needed(tmp_path):
    with pytest.raises(ValueError, match="needs two"):
        run_paper(tmp_path, plans=["scenario1"])


def training_plan(folder, said, **changes):
    settings = {"runs": RUNS, "seed": 0, "resume": True, **changes}
    store = TrainingStore(folder, 2, settings["resume"], said.append)
    return TrainingPlan(store, settings["runs"], settings["seed"])


KEY = Configuration(1, "rss", 4)


@pytest.fixture
def world():
    return small_data().results[KEY].world


def test_a_training_of_another_seed_is_made_again(tmp_path, world):
    said = []
    first, _ = training_plan(tmp_path, said).result(KEY, world)
    other, trained = training_plan(tmp_path, said, seed=1).result(KEY, world)
    assert trained
    assert "schedule" in said[0]
    assert not np.array_equal(first.steps, other.steps)
    again, trained = training_plan(tmp_path, said, seed=1).result(KEY, world)
    assert not trained
    np.testing.assert_array_equal(again.steps, other.steps)


def test_a_training_on_another_map_is_made_again(tmp_path, world):
    said = []
    training_plan(tmp_path, said).result(KEY, world)
    louder = replace(world, rss_dbm=world.rss_dbm + 0.01)
    _, trained = training_plan(tmp_path, said).result(KEY, louder)
    assert trained
    assert "radio map" in said[0]


def test_a_damaged_training_is_made_again(tmp_path, world):
    said = []
    (tmp_path / f"{KEY.name}.h5").write_bytes(b"not a training")
    _, trained = training_plan(tmp_path, said).result(KEY, world)
    assert trained
    assert "cannot be read" in said[0]


def test_without_resume_everything_is_trained_again(tmp_path, world):
    said = []
    training_plan(tmp_path, said).result(KEY, world)
    _, trained = training_plan(tmp_path, said, resume=False).result(KEY, world)
    assert trained
    assert said == []


def test_an_interrupted_training_goes_on(tmp_path, world, monkeypatch):
    said = []
    whole, _ = training_plan(tmp_path / "whole", said).result(KEY, world)
    train = training_store.train

    def interrupted(*args, **kwargs):
        raise TrainingInterrupted(train(*args, **kwargs, only_runs=[1]))

    monkeypatch.setattr(training_store, "train", interrupted)
    with pytest.raises(TrainingInterrupted):
        training_plan(tmp_path, said).result(KEY, world)
    monkeypatch.undo()
    result, trained = training_plan(tmp_path, said).result(KEY, world)
    assert trained
    assert "resuming from 1 of 2 runs" in said[-1]
    np.testing.assert_array_equal(result.steps, whole.steps)


def test_first_episodes_are_those_of_the_training():
    data = small_data()
    for key, first in data.first_episodes.items():
        result = data.results[key]
        np.testing.assert_array_equal(first.visits.sum(axis=0), result.visit_counts[0])
        begun = result.steps[:, : first.early].sum(axis=1) + first.early
        np.testing.assert_array_equal(first.visits.sum(axis=1), begun)


def test_first_episodes_report_their_progress():
    seen = []
    key = Configuration(1, "rss", 1)
    first_episodes(
        small_data().results[key], 5, 10, progress=lambda done, total: seen.append((done, total))
    )
    assert seen == [(1, 3), (2, 3), (3, 3)]


def test_path_lengths_are_those_of_the_flights_that_arrive():
    data = small_data()
    key = Configuration(2, "location", 2)
    arrived = np.array([True, False, True])
    result = replace(data.results[key], path_length_m=np.array([1.0, 50.0, 2.0]), reached=arrived)
    data = replace(data, results={**data.results, key: result}, count=Count.ALL)
    row = path_lengths(data).records()[list(data.results).index(key)]
    assert (row["scenario"], row["agent"], row["speed_mps"]) == (2, "location-based", 2)
    assert (row["arrived"], row["mean_m"], row["sd_m"], row["median_m"]) == (2, 1.5, 0.5, 1.5)
    assert row["paper_m"] == 121.05
    assert row["ratio_to_paper"] == pytest.approx(1.5 / 121.05)
    assert row["shortest_m"] == data.shortest_in_metres[2, 2].length_m
    assert row["fewest_steps"] == data.shortest_in_steps[2, 2].steps


@pytest.mark.parametrize(
    ("count", "counted"),
    [
        (Count.ALL, slice(None)),
        (Count.WITHOUT_LAST, slice(-1)),
        (Count.WITHOUT_FIRST, slice(1, None)),
    ],
)
def test_lengths_count_the_steps_they_say(count, counted):
    for result in small_data().results.values():
        steps = [np.diff(result.world.position[flight], axis=0) for flight in flights(result)]
        wanted = [np.hypot(*step[counted].T).sum() for step in steps]
        np.testing.assert_allclose(counted_lengths_m(result, count), wanted, atol=1e-9)


def test_path_lengths_are_compared_under_both_counts():
    shown, other = (path_lengths(replace(small_data(), count=c)).records() for c in COMPARED_COUNTS)
    for one, two in zip(shown, other, strict=True):
        assert (one["mean_m"], one["other_mean_m"]) == (two["other_mean_m"], two["mean_m"])
        assert one["mean_m"] <= one["other_mean_m"] - one["speed_mps"]


def test_the_optimum_is_not_beaten():
    for row in optimum_table(small_data()).records():
        assert row["mean_return"] <= row["optimal_return"] * (1.0 + 1e-9)
        assert row["return_share"] == pytest.approx(row["mean_return"] / row["optimal_return"])


def test_a_configuration_without_arrivals_has_empty_fields():
    data = small_data()
    key = Configuration(1, "rss", 1)
    nowhere = replace(data.results[key], reached=np.zeros(3, dtype=bool))
    data = replace(data, results={**data.results, key: nowhere})
    assert path_lengths(data).records()[0]["mean_m"] is None
    assert optimum_table(data).records()[0]["return_share"] is None
    assert path_lengths(data).shown_rows[0][4] == (None, "–")


def test_convergence_counts_runs_and_truncated_episodes():
    data = small_data()
    key = Configuration(1, "rss", 1)
    result = data.results[key]
    truncated = np.zeros_like(result.truncated)
    truncated[0, :5] = True
    partly = replace(result, converged_episode=np.array([-1, 30, 50]), truncated=truncated)
    data = replace(data, results={**data.results, key: partly})
    row = convergence_table(data).records()[0]
    assert (row["runs"], row["converged"], row["truncated"]) == (3, 2, 5)
    assert row["episodes_to_convergence"] == 40.0
    assert row["low_episodes_to_convergence"] == 30.0
    assert row["episodes"] == result.episodes_flown.sum()


def test_the_papers_table_is_complete():
    assert set(PATH_LENGTH_M) == set(small_data().results)
    assert PATH_LENGTH_M[Configuration(1, "rss", 1)] == 105.88
    assert PATH_LENGTH_M[Configuration(2, "location", 4)] == 114.63


def test_csv_files_hold_the_results_to_the_last_digit(run):
    with (run.out / "tables" / "path_lengths.csv").open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    for row, result in zip(rows, run.paper.data.results.values(), strict=True):
        assert float(row["other_mean_m"]) == result.path_length_m[result.reached].mean()
        assert float(row["mean_steps"]) == result.path_steps[result.reached].mean()
    with (run.out / "tables" / "convergence.csv").open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    for row, result in zip(rows, run.paper.data.results.values(), strict=True):
        assert float(row["episodes_to_convergence"]) == result.converged_episode.mean()


def test_the_summary_holds_results_verdicts_and_record(run):
    summary = json.loads((run.out / "summary.json").read_text(encoding="utf-8"))
    assert summary["run"]["runs"] == RUNS
    assert sum(summary["verdicts"].values()) == len(CLAIMS)
    assert [claim["key"] for claim in summary["claims"]] == [claim.key for claim in CLAIMS]
    rows = summary["tables"]["path_lengths"]
    for row, result in zip(rows, run.paper.data.results.values(), strict=True):
        assert row["other_mean_m"] == result.path_length_m.mean()
    assert {"python", "numpy", "numba", "rssnav"} <= set(summary["versions"])
    for number_, scenario in run.paper.data.scenarios.items():
        assert summary["scenarios"][f"Scenario {number_}"]["plan_sha256"] == scenario.plan.sha256


def test_trainings_on_disk_are_those_of_the_report(run):
    for key, result in run.paper.data.results.items():
        path = run.out / "training" / f"{RUNS}-runs" / f"{key.name}.h5"
        stored = TrainingResult.load(path)
        np.testing.assert_array_equal(stored.path_length_m, result.path_length_m)
        with h5py.File(path) as file:
            assert file["schedule"].attrs["seed"] == 0


def test_parameters_are_those_of_the_trainings():
    rows = {(row["group"], row["name"]): row["value"] for row in parameters(small_data()).records()}
    assert rows["learning", "gamma"] == "0.98"
    assert rows["learning", "initial_q"] == "100"
    assert rows["trace", "max_reflections"] == "6"
    assert rows["rss agent", "terminal_dbm"] == "-21"
    assert rows["location agent", "terminal_distance_m"] == "2"
    assert rows["schedule", "max_total_steps"] == "none"


def test_text_in_the_report_is_escaped(run):
    table = Table("odd", "<b>Odd</b>", "a & b", (Column("x", "<x>"),), (("<script>",),))
    report = Report((), (table,), run.paper.findings, (), {}, run.paper.record)
    html = render(report)
    assert "<script>" not in html
    assert "&lt;script&gt;" in html
    assert "&lt;b&gt;Odd&lt;/b&gt;" in html


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.0, "0"),
        (100.0, "100"),
        (12345.6, "12,346"),
        (123.456, "123.5"),
        (-1.2345, "−1.23"),
        (0.01234, "0.012"),
    ],
)
def test_numbers_have_about_four_digits(value, text):
    assert number(value) == text


def test_quick_runs_say_so(run):
    quick = replace(run.paper.record, quick=True)
    report = Report((), run.paper.tables, run.paper.findings, (), {}, quick)
    assert "quick run" in render(report)
    assert "quick run" not in run.html


@pytest.mark.parametrize(
    ("words", "missing"),
    [
        (("report",), None),
        (("experiments", "--runs", RUNS), None),
        (("experiments", "--runs", RUNS), "training"),
        (("experiments", "--runs", RUNS), "maps"),
    ],
)
def test_a_full_disk_leaves_every_file_as_it_was(run, tmp_path, monkeypatch, words, missing):
    def content():
        return {path: path.read_bytes() for path in out.rglob("*") if path.is_file()}

    out = tmp_path / "results"
    shutil.copytree(run.out, out)
    if missing is not None:
        shutil.rmtree(out / missing)
    before = content()
    monkeypatch.setitem(run_paper.__kwdefaults__, "plans", run.plans)
    with no_file_above(64):
        failed = command(*words, "--out", out)
    assert failed.exit_code == 1, failed.output
    (line,) = [text for text in failed.stderr.splitlines() if text.startswith("rssnav: ")]
    assert "File too large" in line
    assert str(out) in line
    assert content() == before
