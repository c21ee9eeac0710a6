"""The error this package raises for a plan that cannot be used."""

from __future__ import annotations

import json
import re
from difflib import get_close_matches

Place = tuple[str | int, ...]
"""Keys and indices that lead to a value: ("walls", 3, "openings", 0) is walls[3].openings[0]."""


_BARE_KEY = re.compile(r"[\w-]{1,60}")
_MAX_SHOWN = 200


class PlanError(ValueError):
    """A floor plan is wrong; the message names the file, the table, the key and the value.

    Parameters
    ----------
    problem : str
        What is wrong and what would be right.
    place : Place
        Where in the plan; empty for the plan as a whole.
    value : object
        The offending value, None if there is none to show.
    origin : str
        The file or the text the plan came from.
    at : (float, float) or None
        Where in the building it is wrong, (x, y) [m].
    remedy : str or None
        Key of what would help, for programs that offer it in their own words: a field of
        `floorplans.importers.ImportOptions` to set, or "install_ifc"; None where `problem` says
        all.
    """

    def __init__(
        self,
        problem: str,
        place: Place = (),
        value: object = None,
        origin: str = "",
        at: tuple[float, float] | None = None,
        remedy: str | None = None,
    ) -> None:
        self.problem = problem
        self.place = place
        self.value = value
        self.origin = origin
        self.at = at
        self.remedy = remedy
        where = format_place(place)
        if value is not None:
            where = f"{where} = {_format_value(value)}"
        super().__init__(": ".join(part for part in (origin, where, problem) if part))

    def located(
        self,
        origin: str = "",
        *,
        place: Place | None = None,
        at: tuple[float, float] | None = None,
    ) -> PlanError:
        """Return the same error with what a caller knows of where it is.

        Parameters
        ----------
        origin : str
            File or plan; the error's own one stays.
        place : tuple of str and int, optional
            Keys and numbers that lead to the value, in place of the error's own.
        at : (float, float), optional
            Point of the plan [m], if the error has none.
        """
        return PlanError(
            self.problem,
            self.place if place is None else place,
            self.value,
            self.origin or origin,
            at or self.at,
            self.remedy,
        )


def format_place(place: Place) -> str:
    """Write a place in TOML notation: ``walls[3].openings[0].width_m``."""
    text = ""
    for step in place:
        if isinstance(step, int):
            text += f"[{step}]"
        else:
            key = step if _BARE_KEY.fullmatch(step) else _shown(json.dumps(step))
            text += f".{key}" if text else key
    return text


def unknown_name(kind: str, name: str, known: tuple[str, ...], meant: str | None = None) -> str:
    """Describe an unknown name: the known one meant or a similar one, and the list of known ones.

    Examples
    --------
    >>> unknown_name("material", "glas", ("glass", "wood"))
    'unknown material; did you mean "glass"? Known: glass, wood'
    """
    near = [meant] if meant in known else get_close_matches(name.casefold(), known, n=1)
    hint = f'; did you mean "{near[0]}"?' if near else "."
    return f"unknown {kind}{hint} Known: {', '.join(known)}"


def _format_value(value: object) -> str:
    try:
        return _shown(json.dumps(value, ensure_ascii=False, default=str))
    except (ValueError, RecursionError):  # thousands of digits, or of lists in each other
        return f"<{type(value).__name__}>"


def _shown(text: str) -> str:
    """Cut a text that is too long for a message."""
    return text if len(text) <= _MAX_SHOWN else f"{text[: _MAX_SHOWN - 3]}..."
