"""Numbers and texts as TOML writes them."""

import json


def toml_number(number: float) -> str:
    """Write the shortest number that reads back exactly."""
    shortest = repr(float(number) + 0.0)  # adding 0 turns -0.0 into 0.0, which equals it
    return shortest.removesuffix(".0")


def toml_text(text: str) -> str:
    """Write a string in quotes."""
    return json.dumps(text, ensure_ascii=False)
