"""A session as a file: plan, settings, cell, survey, and how to repeat its training.

The file is JSON. It holds no map and no trained agent: maps are traced again, and a training
with the same seed gives the same flights. Whoever opens it need not trust it: every value is
checked against the ranges of the page.
"""

from __future__ import annotations

import json
from collections.abc import Collection, Mapping
from dataclasses import asdict, dataclass
from typing import Any, NoReturn, cast, get_args

from floorplans.transmitters import ANTENNAS
from rssnav.explorer.antenna_choice import AZIMUTH, ELEVATION, AntennaChoice
from rssnav.explorer.map_settings import MapSettings
from rssnav.explorer.ranges import Range, shortened
from rssnav.explorer.setting_ranges import (
    LEARNING,
    MAP_NUMBERS,
    MOST_TRANSMISSIONS,
    PLACES,
    TRAINING,
)
from rssnav.explorer.training import AgentName, TrainingSettings
from rssnav.learning_parameters import QLearning

FORMAT, VERSION = "rssnav explorer session", 1
GIGA = 1e9
MOST_NAME = 100
"""Maximum length of a transmitter's name."""

_TRANSMISSIONS = {"max_transmissions": Range("", 0, MOST_TRANSMISSIONS, whole=True)}
_CELL = {"x_m": PLACES["start_x_m"], "y_m": PLACES["start_y_m"]}


@dataclass(frozen=True)
class SavedSession:
    """What is saved of a session.

    Attributes
    ----------
    plan : str
        TOML of the plan with its source and start.
    settings : MapSettings
    cell : (float, float) or None
        Centre of the selected cell [m].
    training : TrainingSettings or None
        Of the training that is shown; its pace is not saved.
    survey : str or None
        CSV of the open survey.
    """

    plan: str
    settings: MapSettings
    cell: tuple[float, float] | None = None
    training: TrainingSettings | None = None
    survey: str | None = None

    def dumps(self) -> str:
        """Return the content of the file."""
        cell = None if self.cell is None else dict(zip(_CELL, self.cell, strict=True))
        table = {
            "format": FORMAT,
            "version": VERSION,
            "plan": self.plan,
            "map": _map_table(self.settings),
            "cell": cell,
            "training": None if self.training is None else _training_table(self.training),
            "survey": self.survey,
        }
        return json.dumps(table, indent=1, ensure_ascii=False) + "\n"

    @classmethod
    def loads(cls, text: str) -> SavedSession:
        """Read the content of a file; the plan and the survey in it are not read yet.

        Raises
        ------
        ValueError
            For anything that the page could not have saved; the message names the key.
        RecursionError
            For one that is nested too deeply.
        """
        whole = _Table("", _parsed(text))
        whole.choice("format", [FORMAT])
        whole.choice("version", [VERSION])
        whole.has_only({"format", "version", "plan", "map", "cell", "training", "survey"})
        cell, training = whole.table_or_none("cell"), whole.table_or_none("training")
        if cell is not None:
            cell.has_only(_CELL)
        survey = whole.value("survey")
        return cls(
            whole.text("plan"),
            _map_settings(whole.table("map")),
            None if cell is None else (cell.number("x_m", _CELL), cell.number("y_m", _CELL)),
            None if training is None else _training_settings(training),
            None if survey is None else whole.text("survey"),
        )


class _Table:
    """A table of the file, which a stranger may have written.

    Parameters
    ----------
    name : str
        Of its key; empty for the whole file.
    values : object
    """

    def __init__(self, name: str, values: object) -> None:
        self._name = name
        if not isinstance(values, dict):
            raise ValueError(f"{name or 'the file'}: expected a table")
        self._values = cast("dict[str, object]", values)

    def refuse(self, key: str, expected: str) -> NoReturn:
        """Raise ValueError for the value of a key."""
        raise ValueError(f"{self._key(key)}: {shortened(self.value(key))} must be {expected}")

    def has_only(self, keys: Collection[str]) -> None:
        """Raise ValueError for a key that is none of these."""
        for key in self._values:
            if key not in keys:
                raise ValueError(
                    f"{self._key(key)[:MOST_NAME]!r}: unknown key; expected {', '.join(keys)}"
                )

    def value(self, key: str) -> object:
        """Value of a key; raise ValueError where it is missing."""
        if key not in self._values:
            raise ValueError(f"{self._key(key)}: missing")
        return self._values[key]

    def text(self, key: str, most: int | None = None) -> str:
        """Text, at most so many characters."""
        value = self.value(key)
        if not isinstance(value, str):
            self.refuse(key, "a text")
        if most is not None and len(value) > most:
            self.refuse(key, f"at most {most} characters")
        return value

    def choice(self, key: str, choices: Collection[Any]) -> Any:
        """One of several texts or numbers."""
        value = self.value(key)
        for known in choices:
            if type(value) is type(known) and value == known:
                return known
        self.refuse(key, " or ".join(map(repr, choices)))

    def number(self, key: str, ranges: Mapping[str, Range]) -> Any:
        """Return a number in its range, as a float if that need not be whole."""
        allowed, value = ranges[key], self.value(key)
        allowed.check(value, self._key(key))
        return value if allowed.whole else float(cast("float", value))

    def table(self, key: str) -> _Table:
        """Return a table within."""
        return _Table(self._key(key), self.value(key))

    def table_or_none(self, key: str) -> _Table | None:
        """Return a table within, or None for null."""
        return None if self.value(key) is None else self.table(key)

    def _key(self, key: str) -> str:
        return f"{self._name}.{key}" if self._name else key


def _parsed(text: str) -> object:
    """JSON of a text; raise ValueError where it is none."""

    def no_number(name: str) -> NoReturn:
        raise ValueError(f"{name} is no number of JSON")

    try:
        return json.loads(text, parse_constant=no_number)
    except json.JSONDecodeError as error:
        raise ValueError(f"not valid JSON: {error}") from error


def _map_table(settings: MapSettings) -> dict[str, Any]:
    numbers = {k: getattr(settings, k) for k in MAP_NUMBERS if k != "frequency_ghz"}
    return {
        "transmitter": settings.server,
        **numbers,
        "frequency_ghz": settings.frequency_hz / GIGA,
        "max_transmissions": settings.max_transmissions,
        "transmit_antenna": asdict(settings.transmit_antenna),
        "receive_antenna": asdict(settings.receive_antenna),
    }


def _map_settings(table: _Table) -> MapSettings:
    table.has_only(_map_table(MapSettings()))
    numbers = {key: table.number(key, MAP_NUMBERS) for key in MAP_NUMBERS}
    by_loss = table.value("max_transmissions") is None
    most = None if by_loss else table.number("max_transmissions", _TRANSMISSIONS)
    return MapSettings(
        server=table.text("transmitter", MOST_NAME),
        frequency_hz=numbers.pop("frequency_ghz") * GIGA,
        max_transmissions=most,
        transmit_antenna=_antenna(table.table("transmit_antenna")),
        receive_antenna=_antenna(table.table("receive_antenna")),
        **numbers,
    )


def _antenna(table: _Table) -> AntennaChoice:
    ranges = {"azimuth_deg": AZIMUTH, "elevation_deg": ELEVATION}
    table.has_only({"name", *ranges})
    angles = {key: table.number(key, ranges) for key in ranges}
    return AntennaChoice(table.choice("name", ANTENNAS), **angles)


def _training_table(training: TrainingSettings) -> dict[str, Any]:
    numbers = {key: getattr(training, key) for key in TRAINING}
    learning = {key: getattr(training.learning, key) for key in LEARNING}
    return {"agent": training.agent, **numbers, "learning": learning}


def _training_settings(table: _Table) -> TrainingSettings:
    table.has_only(_training_table(TrainingSettings()))
    learning = table.table("learning")
    learning.has_only(LEARNING)
    return TrainingSettings(
        agent=table.choice("agent", get_args(AgentName)),
        learning=QLearning(**{key: learning.number(key, LEARNING) for key in LEARNING}),
        **{key: table.number(key, TRAINING) for key in TRAINING},
    )
