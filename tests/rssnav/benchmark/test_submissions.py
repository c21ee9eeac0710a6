"""Results are read as they were written; whatever is wrong in them is named."""

from __future__ import annotations

import json
from dataclasses import replace

import pytest
from benchmark_records import SMALL, records

from rssnav.benchmark.errors import BenchmarkError
from rssnav.benchmark.page import as_markdown, as_page, write
from rssnav.benchmark.policies import PolicySpec
from rssnav.benchmark.protocol import QUICK
from rssnav.benchmark.scores import scores
from rssnav.benchmark.submissions import as_json, check_names, merged, read_scores
from rssnav.missions import RandomPolicy


@pytest.fixture
def file(tmp_path):
    found = scores(records())
    path = tmp_path / "results.json"
    path.write_text(as_json(found, SMALL))
    return path, found


def test_results_are_read_as_written(file):
    path, found = file
    assert read_scores(path, SMALL) == found


def changed(path, change):
    content = json.loads(path.read_text())
    change(content)
    path.write_text(json.dumps(content))


def of_score(name, value):
    return lambda content: content["scores"][0].__setitem__(name, value)


DAMAGE = {
    "other version": (lambda c: c.update(version=0), "version: 0"),
    "no version": (lambda c: c.pop("version"), "version: None"),
    "other program": (lambda c: c.update(benchmark="else"), "not a results.json"),
    "smaller extent": (lambda c: c["extent"].update(generated=3), "extent"),
    "no scores": (lambda c: c.update(scores=[]), "at least one entry"),
    "no table": (lambda c: c.update(scores=[3]), r"scores\[0\]: expected a table"),
    "missing": (lambda c: c["scores"][0].pop("spl"), r"scores\[0\]: spl is missing"),
    "unknown": (of_score("speed", 1), "speed: no such key"),
    "track": (of_score("track", "all"), "track: 'all'; expected 'RSS' or"),
    "condition": (of_score("condition", "9 dB"), "condition: '9 dB'"),
    "name": (of_score("policy", "a\n| b"), "printable"),
    "text": (of_score("turns", "3"), "turns: '3'"),
    "bool": (of_score("collisions", True), "collisions: True"),
    "nan": (of_score("energy_kj", float("nan")), "energy_kj: nan"),
    "negative": (of_score("flights", -3), "flights: -3"),
    "beyond one": (of_score("spl", {"value": 1.2, "low": 0.0, "high": 1.3}), "spl: "),
    "a building left out": (of_score("spl_by_building", [0.5]), "spl_by_building: 2 numbers"),
    "flights left out": (of_score("flights", 3), "flights: 6"),
    "a site left out": (of_score("site", "paper"), "site: one of this extent"),
    "a condition left out": (lambda c: c["scores"].pop(), "has 5 entries; expected 6"),
    "huge": (of_score("turns", 10**400), "turns: 1000"),
    "wrong interval": (of_score("spl", {"value": 0.1, "low": 0.2, "high": 0.3}), "low <= value"),
    "wrong mean": (of_score("spl", {"value": 0.1, "low": 0.0, "high": 0.3}), "the mean of"),
    "no buildings": (of_score("spl_by_building", []), "spl_by_building"),
    "distribution": (of_score("found_within", [0.5, 0.4, 0.6, 0.6, 0.6]), "numbers that rise"),
    "success": (of_score("success", {"value": 1.0, "low": 1.0, "high": 1.0}), "at most 1 together"),
    "median": (of_score("median_s", None), "median_s"),
    "early median": (of_score("median_s", 1.0), "median_s"),
    "wide interval": (lambda c: c["scores"][0]["spl"].update(low=0.0), "spl: the interval of"),
    "turns": (of_score("turns", 401.0), "turns: at most 400"),
}


@pytest.mark.parametrize(("change", "message"), DAMAGE.values(), ids=DAMAGE)
def test_what_is_wrong_is_named_with_the_file(file, change, message):
    path, _ = file
    changed(path, change)
    with pytest.raises(BenchmarkError, match=message) as error:
        read_scores(path, SMALL)
    assert str(path) in str(error.value)


@pytest.mark.parametrize(
    "text",
    [
        "", "[]", "3", "{", "\x00", '{"benchmark": "rssnav"}', "[" * 100_000,
        '{"benchmark": "rssnav", "version": ' + "9" * 4000 + "}",
    ],
    ids=["empty", "list", "number", "open", "zero", "nothing else", "deep", "long number"],
)  # fmt: skip
def test_no_result_is_refused(tmp_path, text):
    path = tmp_path / "results.json"
    path.write_text(text)
    with pytest.raises(BenchmarkError, match=r"results\.json"):
        read_scores(path, SMALL)
    with pytest.raises(BenchmarkError, match=r"missing\.json"):
        read_scores(tmp_path / "missing.json", SMALL)


def test_a_quick_result_is_not_mixed_with_a_full_one(file):
    with pytest.raises(BenchmarkError, match="extent"):
        read_scores(file[0], QUICK)


def test_results_of_several_are_merged_unless_they_have_the_same_name(file):
    _, found = file
    other = [replace(score, policy="other") for score in found]
    assert merged([found, other]) == [*found, *other]
    with pytest.raises(BenchmarkError, match="another name"):
        merged([found, found])
    mine = PolicySpec("a", "RSS", lambda _: RandomPolicy())
    with pytest.raises(BenchmarkError, match="policy 'a' of track 'RSS' is in two results"):
        check_names([mine], found)
    check_names([replace(mine, name="b"), replace(mine, track="plan")], found)


def test_tables_hold_all_entrants_best_first_and_names_are_escaped(file, tmp_path):
    _, found = file
    best = replace(found[0], policy="<b>|best", spl=replace(found[0].spl, value=0.9, high=0.9))
    rows = [line for line in as_markdown([*found, best]).splitlines() if line.startswith("| ")]
    assert [row.count("|") for row in rows] == [rows[0].count("|")] * len(rows)
    assert rows[2].startswith("| &lt;b&gt;/best |")
    page = as_page([*found, best], SMALL)
    assert "<b>|best" not in page
    assert "&lt;b&gt;|best" in page
    paths = write(tmp_path, found, SMALL)
    assert {path.name for path in paths} == {"results.json", "table.md", "page.html"}
    assert read_scores(tmp_path / "results.json", SMALL) == found
