"""Trees of any values as TOML and JSON text, however absurd the values are."""

from __future__ import annotations

import json
from datetime import date, time
from typing import Any

from fuzz.mutations import Nested


def toml_text(data: Any) -> bytes:
    """Write the keys and values of a mapping as inline TOML."""
    if not isinstance(data, dict):
        return _value(data).encode("utf-8", "replace")
    lines = [f"{_text(str(key))} = {_value(value)}" for key, value in data.items()]
    return "\n".join(lines).encode("utf-8", "replace")


def json_text(data: Any) -> bytes:
    """Write JSON, with NaN and infinities as Python does, and numbers of any length."""
    return _json(data).encode("utf-8", "replace")


def _value(root: Any) -> str:
    return _joined(root, _toml_scalar, lambda key: f"{_text(key)} = ")


def _json(root: Any) -> str:
    return _joined(root, _json_scalar, lambda key: f"{_text(key)}: ")


def _joined(root: Any, scalar: Any, label: Any) -> str:
    """Write a tree of any depth, without recursion."""
    pieces: list[str] = []
    stack: list[Any] = [(root, False)]
    while stack:
        item, is_text = stack.pop()
        if isinstance(item, Nested):
            pieces.append("[" * item + "]" * item)
        elif is_text:
            pieces.append(item)
        elif isinstance(item, dict):
            parts: list[Any] = [("{", True)]
            for index, (key, value) in enumerate(item.items()):
                parts += [((", " if index else "") + label(str(key)), True), (value, False)]
            stack += reversed([*parts, ("}", True)])
        elif isinstance(item, list | tuple):
            parts = [("[", True)]
            for index, value in enumerate(item):
                parts += [(", " if index else "", True), (value, False)]
            stack += reversed([*parts, ("]", True)])
        else:
            pieces.append(scalar(item))
    return "".join(pieces)


def _toml_scalar(value: Any) -> str:
    if value is None:
        return '"none"'
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, date | time):
        return value.isoformat()
    return _text(value) if isinstance(value, str) else _number(value)


def _json_scalar(value: Any) -> str:
    if value is None:
        return "null"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, int | float):
        return json.dumps(value) if isinstance(value, float) else _number(value)
    return _text(str(value))


def _number(value: Any) -> str:
    if isinstance(value, int) and abs(value) > 10**100:
        return ("-" if value < 0 else "") + "1" + "0" * 4999
    return repr(value)


def _text(value: str) -> str:
    return json.dumps(value, ensure_ascii="\x00" not in value)
