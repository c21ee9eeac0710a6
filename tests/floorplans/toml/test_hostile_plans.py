"""Whatever a plan's file holds, reading it gives a plan or one `PlanError` of a sensible length."""

from __future__ import annotations

import re
from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from small_plans import ROOM, edited

import floorplans
from floorplans import PlanError
from floorplans.checks.inspection import inspect
from floorplans.loading import MAX_CHARACTERS, loads_unchecked

NUMBER = re.compile(r"-?\d+(?:\.\d+)?")
VALUES = (
    "nan", "-inf", "1e308", "-1e308", "1e-308", "0", "-1", "1e999", "1e6", "1e-9", "9" * 400,
    "9" * 5000, "0x" + "f" * 5000, "true", "2026-01-31", "07:32:00", '""', '"\\u0000"',
    '"\\u202e"', "[]", "[[]]", "[[], [], [], []]", "[1, 2, 3]", "[[0, 0], [0, 0]]", "{}",
    "{ a = 1 }", "[[1e308, 4], [10, 4]]", "[" * 60 + "]" * 60,
)  # fmt: skip
"""Values of wrong types, out of range, or too long."""


def fault(text: str) -> str:
    """Read a plan with all its findings; return the message of a `PlanError`, if there is one."""
    try:
        inspect(loads_unchecked(text))
        floorplans.loads(text, origin="room.toml")
    except PlanError as error:
        return str(error)
    return ""


def mutated(random: Random) -> str:
    """Return ROOM with values replaced, characters changed, and lines repeated or left out."""
    text = ROOM
    for _ in range(random.randint(1, 4)):
        kind = random.random()
        if kind < 0.5 and (found := list(NUMBER.finditer(text))):
            number = random.choice(found)
            text = text[: number.start()] + random.choice(VALUES) + text[number.end() :]
        elif kind < 0.8:
            place = random.randrange(len(text) + 1)
            new = chr(random.choice((random.randrange(128), random.randrange(0x3000))))
            text = text[:place] + new + text[place + random.randint(0, 20) :]
        else:
            lines = text.splitlines()
            line = random.randrange(len(lines))
            lines[line : line + random.randint(0, 1)] = [random.choice(lines)]
            text = "\n".join(lines)
    return text


@pytest.mark.parametrize("seed", range(20))
def test_mutated_plans(seed: int) -> None:
    random = Random(seed)
    for _ in range(50):
        assert len(fault(mutated(random))) < 2000


JSON_LIKE = st.recursive(
    st.sampled_from(VALUES) | st.floats().map(repr) | st.integers().map(str),
    lambda inner: (
        st.lists(inner, max_size=4).map(lambda items: f"[{', '.join(items)}]")
        | inner.map(lambda item: f"{{ points = {item} }}")
    ),
    max_leaves=6,
)
KEYS = (
    "height_m = 3", "source = [1, 1, 1.5]", "start = [4.5, 2.5]", "points = [[3, 0], [3, 4]]",
    'name = "room"', "format = 1", 'material = "plasterboard"',
)  # fmt: skip


@settings(max_examples=300, deadline=None)
@given(st.sampled_from(KEYS), JSON_LIKE)
def test_any_value_of_any_key(line: str, value: str) -> None:
    assert len(fault(edited(line, f"{line.split(' = ')[0]} = {value}"))) < 2000


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("x = " + "[" * 3000 + "]" * 3000, "nested too deeply"),
        ("x = " + "{ x = " * 3000, "nested too deeply"),
        (".".join("x" * 200_000) + " = 1", "a key of 100 parts"),
        ("x = " + "9" * 5000, "a number is too long"),
        (" " * (MAX_CHARACTERS + 1), f"at most {MAX_CHARACTERS} characters"),
        ('name = "a"\nname = "b"', "not valid TOML"),
        ("a\0 = 1", "not valid TOML"),
        (edited("height_m = 3", "height_m = 1" + "0" * 400), "height_m = 1000"),
        (edited("height_m = 3", "height_m = 0x" + "f" * 5000), "height_m = <int>"),
        (edited("height_m = 3", "height_m = 1001"), "finite number from 1e-09 to 1000 [m]"),
        (edited("start = [4.5, 2.5]", "start = [1e308, 2.5]"), "from -1e+06 to 1e+06 [m]"),
        (edited("height_m = 3", '"\\u001b[31m" = 3\nheight_m = 3'), r'"\u001b[31m": unknown key'),
    ],
)
def test_limits_of_a_file(text: str, problem: str) -> None:
    with pytest.raises(PlanError) as caught:
        floorplans.loads(text, origin="room.toml")
    assert str(caught.value).startswith("room.toml: ")
    assert problem in str(caught.value)
    assert len(str(caught.value)) < 1000


@pytest.mark.parametrize("content", [b"\xff\xfe", b"name = '\xe4'", b""])
def test_bytes_that_are_no_plan(tmp_path, content: bytes) -> None:
    path = tmp_path / "room.toml"
    path.write_bytes(content)
    with pytest.raises(PlanError, match=r"room\.toml: "):
        floorplans.load(path)


def test_a_path_that_no_system_knows() -> None:
    with pytest.raises(PlanError, match="cannot be read: embedded null byte"):
        floorplans.load("a\0b.toml")


def test_a_byte_order_mark_as_some_editors_write_it_is_no_content(tmp_path) -> None:
    plan = floorplans.load("flat")
    (tmp_path / "flat.toml").write_text(floorplans.dumps(plan), encoding="utf-8-sig")
    assert floorplans.load(tmp_path / "flat.toml") == plan
