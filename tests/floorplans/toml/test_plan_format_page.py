"""What docs/plan_format.md says is true."""

import re
import tomllib

import pytest
from documents import ROOT

import floorplans
from floorplans.loading import (
    DEFAULTS_KEYS,
    FRAME_KEYS,
    OPENING_KEYS,
    ORIGIN_KEYS,
    PLAN_KEYS,
    WALL_KEYS,
)
from floorplans.toml.transmitters import TRANSMITTER_KEYS

PAGE = (ROOT / "docs" / "plan_format.md").read_text(encoding="utf-8")


def block(language: str) -> str:
    (text,) = re.findall(rf"```{language}\n(.*?)```", PAGE, flags=re.DOTALL)
    return text


def test_example_is_a_plan_that_uses_every_key() -> None:
    plan = floorplans.loads(block("toml"))
    assert plan.name == "workshop"
    assert len(plan.outline.interiors) == 1
    table = tomllib.loads(block("toml"))
    openings = [o for wall in table["walls"] for o in wall.get("openings", [])]
    assert set(PLAN_KEYS) - set(table) == {"floor_thickness_m"}
    assert set(table["defaults"]) == set(DEFAULTS_KEYS)
    assert set(table["origin"]) == set(ORIGIN_KEYS)
    assert set(table["frame"]) == set(FRAME_KEYS)
    assert {key for row in table["transmitters"] for key in row} == set(TRANSMITTER_KEYS)
    assert {key for wall in table["walls"] for key in wall} == set(WALL_KEYS)
    assert {key for opening in openings for key in opening} == set(OPENING_KEYS)


def test_offsets_of_the_example_lie_where_its_comment_says() -> None:
    _, east, north, _ = floorplans.loads(block("toml")).walls[:4]
    assert (east.start[0], east.end[0]) == (12, 12)
    assert [o.kind for o in east.openings] == ["door"]
    assert (north.start[1], north.end[1]) == (8, 8)
    assert [o.kind for o in north.openings] == ["window"]


KEYS = (*PLAN_KEYS, *ORIGIN_KEYS, *FRAME_KEYS, *TRANSMITTER_KEYS, *WALL_KEYS, *OPENING_KEYS)


@pytest.mark.parametrize("word", [*KEYS, *floorplans.MATERIALS])
def test_page_explains_every_key_and_material(word: str) -> None:
    prose = re.sub(r"```.*?```", "", PAGE, flags=re.DOTALL)
    assert f"`{word}`" in prose


def test_python_example_runs(tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    exec(block("python"), {})
    assert floorplans.load("copy.toml") == floorplans.load("scenario1")
    assert (tmp_path / "plan.glb").stat().st_size > 0
