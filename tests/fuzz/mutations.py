"""Hypothesis strategies that damage a valid input: bytes, lines of text, trees of values."""

from __future__ import annotations

import datetime
import math
from collections.abc import Iterator, MutableMapping, MutableSequence
from copy import deepcopy
from typing import Any

from hypothesis import strategies as st

Place = tuple[Any, Any]
"""A container and the key or index of a value in it."""

TEXTS = ("", "a", "\x00", "[/]", "[bold]", "$x^", "é", "😀", "../../x", "\x1b[31m", "x" * 5000)
NUMBERS = (
    0, 1, -1, 2**31, 2**63, 2**64, 10**400, -(10**400), 0.0, -0.0, 1e-300, 1e-9, 1e6, 1e18, 1e308,
    -1e308, math.nan, math.inf, -math.inf,
)  # fmt: skip
TOKENS = tuple(
    text.encode()
    for text in (*TEXTS, *map(str, NUMBERS[:6]), "nan", "inf", "1e308", "1e999", "9" * 5000, "-0")
)
VALUES = (
    *TEXTS, *NUMBERS, None, True, [], [[]], {}, [[0, 0]], [0, 0], [0, 0, 0], {"a": 1},
    [math.nan, 0], [1e308, 1e308], datetime.date(2020, 1, 1), datetime.time(1),
)  # fmt: skip


class Nested(int):
    """Stands for a list in a list in a list ..., this deep."""


@st.composite
def mutated_bytes(draw: st.DrawFn, sample: bytes, most: int = 4) -> bytes:
    """Damage a file at up to `most` places: flip, insert, delete, repeat, cut, overwrite."""
    content = bytearray(sample)
    for _ in range(draw(st.integers(1, most))):
        at = draw(st.integers(0, max(len(content) - 1, 0)))
        length = draw(st.sampled_from((1, 2, 4, 8, 64, 1024)))
        match draw(st.integers(0, 5)):
            case 0:
                content[at : at + 1] = bytes([draw(st.integers(0, 255))])
            case 1:
                content[at:at] = draw(st.sampled_from(TOKENS))
            case 2:
                del content[at : at + length]
            case 3:
                content[at:at] = content[at : at + length] * draw(st.sampled_from((1, 2, 50)))
            case 4:
                del content[at:]
            case _:
                fill = draw(st.sampled_from((b"\x00", b"\xff", b"\x7f", b"\x80")))
                content[at : at + length] = fill * min(length, 8)
    return bytes(content)


@st.composite
def mutated_lines(draw: st.DrawFn, sample: bytes, most: int = 4) -> bytes:
    """Damage a text: lines deleted, repeated, exchanged; words replaced."""
    lines = sample.split(b"\n")
    for _ in range(draw(st.integers(1, most))):
        at, other = (draw(st.integers(0, len(lines) - 1)) for _ in range(2))
        match draw(st.integers(0, 4)):
            case 0:
                lines[at] = draw(st.sampled_from(TOKENS))
            case 1:
                lines[at], lines[other] = lines[other], lines[at]
            case 2:
                lines[at:at] = lines[at : at + draw(st.sampled_from((1, 2, 20)))]
            case 3:
                lines[at : at + draw(st.sampled_from((1, 2, 20)))] = [b""]
            case _:
                lines[at] = draw(_with_another_word(lines[at]))
    return b"\n".join(lines)


@st.composite
def _with_another_word(draw: st.DrawFn, line: bytes) -> bytes:
    """Replace a run between separators of IFC, TOML, YAML and DXF."""
    words = _words(line)
    if words:
        words[draw(st.integers(0, len(words) - 1))] = draw(st.sampled_from(TOKENS))
    return b"".join(words)


def _words(line: bytes) -> list[bytes]:
    words: list[bytes] = [b""]
    for byte in line:
        if byte in b" ,()[]{}=;:#":
            words += [bytes([byte]), b""]
        else:
            words[-1] += bytes([byte])
    return words


@st.composite
def mutated_tree(draw: st.DrawFn, sample: Any, most: int = 3) -> Any:
    """Damage nested mappings and sequences: values replaced, removed, repeated, moved."""
    tree = deepcopy(sample)
    for _ in range(draw(st.integers(1, most))):
        places = list(_places(tree))
        if places:
            _damage(draw, places)
    return tree


def _places(tree: Any) -> Iterator[Place]:
    items: Any = ()
    if isinstance(tree, MutableMapping):
        items = list(tree.items())
    elif isinstance(tree, MutableSequence):
        items = list(enumerate(tree))
    for key, value in items:
        yield tree, key
        yield from _places(value)


def _damage(draw: st.DrawFn, places: list[Place]) -> None:
    container, key = places[draw(st.integers(0, len(places) - 1))]
    value = container[key]
    match draw(st.integers(0, 5)):
        case 0:
            container[key] = deepcopy(draw(st.sampled_from(VALUES)))
        case 1:
            del container[key]
        case 2:
            other, place = places[draw(st.integers(0, len(places) - 1))]
            container[key] = deepcopy(other[place])
        case 3 if isinstance(container, MutableSequence):
            container[key:key] = [deepcopy(value)] * draw(st.sampled_from((1, 2, 30)))
        case 3:
            container[draw(st.sampled_from(TEXTS))] = deepcopy(value)
        case 4:
            container[key] = Nested(draw(st.sampled_from((1, 50, 2000, 100_000))))
        case _:
            container[key] = draw(_nearby(value))


def _nearby(value: Any) -> st.SearchStrategy[Any]:
    """A number that is almost, or a power of ten from, another one."""
    if isinstance(value, bool) or not isinstance(value, int | float) or abs(value) > 10**300:
        return st.sampled_from(VALUES)
    steps = (1e-12, 1e-9, 1e-6, 1e-3, 0.1, 1.0, 3.0, -1e-9, -1e-6, -1e-3, -0.1, -1.0, -3.0)
    factors = (-1.0, 0.5, 2.0, 10.0, 1e3, 1e6, 1e-3, 1e-6)
    return st.sampled_from(steps).map(lambda s: value + s) | st.sampled_from(factors).map(
        lambda f: value * f
    )
