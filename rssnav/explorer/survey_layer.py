"""A survey over the map of a session: its readings, and how far traced RSS is off."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from importlib.resources import files
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

import floorplans
from floorplans import FloorPlan, PlanError
from rssnav.explorer.background import NewestOnly, Ticket
from rssnav.explorer.fair_turns import TabTurns
from rssnav.explorer.file_names import shown_name
from rssnav.explorer.limits import Limits
from rssnav.explorer.map_settings import MapSettings
from rssnav.explorer.tracing import LatestScene, attempted, end_of_time
from rssnav.explorer.transmitters import without_pattern_files
from rssnav.measurements.survey import Survey, SurveyError
from rssnav.measurements.survey_csv import read_survey, transmitters_of
from rssnav.measurements.traced import TraceSettings, traced_dbm

EXAMPLE = "measured flat"
"""Name of the plan with a survey that comes with the package."""

CSV = ".csv"


class SurveyFile(NamedTuple):
    """A survey as it was read.

    Attributes
    ----------
    survey : Survey
    text : str
        CSV that it was read from.
    """

    survey: Survey
    text: str


@dataclass(frozen=True, eq=False)
class Residuals:
    """A survey beside what is traced.

    Attributes
    ----------
    survey
        The readings, n of them.
    predicted_dbm
        (n,) traced RSS with the offset that fits best [dBm]; -inf without a path.
    sigma_db
        Root mean square of measured minus predicted [dB]; 0 where no path reaches a reading.
    """

    survey: Survey
    predicted_dbm: NDArray[np.float64]
    sigma_db: float

    @classmethod
    def of(cls, survey: Survey, traced: NDArray[np.float64]) -> "Residuals":
        """Fit one offset to all readings above the sensitivity."""
        used = np.isfinite(traced) & ~survey.is_censored
        off = survey.rss_dbm[used] - traced[used]
        if not used.any():
            return cls(survey, traced, 0.0)
        return cls(survey, traced + off.mean(), float(off.std()))

    @property
    def residual_db(self) -> NDArray[np.float64]:
        """(n,) measured minus predicted [dB]; inf without a path."""
        return self.survey.rss_dbm - self.predicted_dbm


class SurveyTracer:
    """Traces the survey of a session in a thread.

    Attributes
    ----------
    file : SurveyFile or None
        The open survey.
    latest : Residuals or None
        It beside what is traced; None until that is known.
    problem : str
        Why it could not be traced; empty if it could.
    """

    def __init__(self, limits: Limits, scenes: LatestScene, turns: TabTurns) -> None:
        self.file: SurveyFile | None = None
        self.latest: Residuals | None = None
        self.problem = ""
        self._limits = limits
        self._scenes = scenes
        self._thread = NewestOnly("survey", turns)

    @property
    def survey(self) -> Survey | None:
        """The open survey."""
        return None if self.file is None else self.file.survey

    def open(self, file: SurveyFile, plan: FloorPlan, settings: MapSettings) -> None:
        """Open another survey, and trace it."""
        self.file = file
        self.request(plan, settings)

    def request(self, plan: FloorPlan, settings: MapSettings) -> None:
        """Trace the open survey, if there is one, with other settings."""
        self.latest, self.problem = None, ""
        if self.survey is not None:
            self._thread.submit(partial(self._trace, self.survey, plan, settings))

    def forget(self) -> None:
        """Close the survey."""
        self._thread.cancel()
        self.file, self.latest, self.problem = None, None, ""

    def close(self) -> None:
        """End the thread."""
        self._thread.close()

    def _trace(
        self, survey: Survey, plan: FloorPlan, settings: MapSettings, ticket: Ticket
    ) -> None:
        traced_with = TraceSettings(
            settings.config(complete=True),
            survey.frequency_hz or settings.frequency_hz,
            settings.transmit_antenna.antenna,
            settings.receive_antenna.antenna,
            max_memory_bytes=self._limits.trace_bytes,
        )

        def compare() -> Residuals:
            stop = end_of_time(ticket, self._limits.map_s)
            traced = traced_dbm(self._scenes.of(plan), survey, traced_with, stop=stop)
            return Residuals.of(survey, traced)

        found, problem = attempted(compare)
        ticket.check()
        self.latest, self.problem = found, problem


def read_survey_upload(name: str, content: bytes, plan: FloorPlan, limits: Limits) -> SurveyFile:
    """Read an uploaded survey of a plan with transmitters.

    Raises
    ------
    PlanError
        Where it is too large, or wrong; the message names row and column.
    """
    origin = shown_name(name)
    if len(content) > limits.survey_bytes:
        raise PlanError(
            f"{len(content)} bytes; the explorer accepts surveys of at most {limits.survey_bytes}",
            origin=origin,
        )
    if not plan.transmitters:
        raise PlanError(
            f"plan {plan.name!r} has no [[transmitters]], which a survey refers to: open a plan "
            "with transmitters first",
            origin=origin,
        )
    with TemporaryDirectory(prefix="rssnav-") as folder:
        path = Path(folder) / "survey.csv"
        path.write_bytes(content)
        survey = _in_users_words(lambda: _read(path, plan), path, origin)
        return SurveyFile(survey, content.decode("utf-8", "replace"))


def example() -> tuple[FloorPlan, SurveyFile]:
    """Return the measured flat and its survey."""
    folder = Path(str(files("rssnav.measurements") / "measured_flat"))
    plan = floorplans.load(str(folder / "flat.toml"))
    path = folder / "survey.csv"
    return plan, SurveyFile(_read(path, plan), path.read_text("utf-8"))


def _read(path: Path, plan: FloorPlan) -> Survey:
    known = transmitters_of(without_pattern_files(plan), path.parent)
    return replace(read_survey(path, plan, known), path=None)


def _in_users_words(read: Callable[[], Survey], path: Path, origin: str) -> Survey:
    """Read a file; name it in messages as the browser gave it."""
    try:
        return read()
    except (SurveyError, ValueError, OSError) as error:
        reason = str(error).removeprefix(f"{path}: ").replace(str(path), origin)
        raise PlanError(reason, origin=origin) from error
