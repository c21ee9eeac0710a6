"""Floor plans and sessions from uploaded files.

An upload is read alone in an empty folder, by a separate process with limited time and memory,
because even a short TOML file can be made to take hours. References in it are not followed.
Formats of several files, such as a ROS map and its picture, are not accepted.
"""

import json
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import asdict, replace
from pathlib import Path, PurePosixPath
from tempfile import TemporaryDirectory
from typing import NamedTuple

import floorplans
from floorplans import FloorPlan, PlanError
from rssnav.explorer.file_names import file_name, shown_name
from rssnav.explorer.import_worker import ENTITY_MARKS, REPORT, RESULT, SAVED, SESSION, TOML
from rssnav.explorer.limits import Limits
from rssnav.explorer.session_file import SavedSession
from rssnav.explorer.survey_layer import SurveyFile, read_survey_upload

ACCEPTED = (TOML, *ENTITY_MARKS, SESSION)

_REASON_LENGTH = 500
_MOST_LINES = 200
_POLL_S = 0.1


class Upload(NamedTuple):
    """What an uploaded file holds.

    Attributes
    ----------
    plan : FloorPlan
    report : tuple of str
        How the file was imported, a line each; empty for a plan in TOML.
    saved : SavedSession or None
        What a session's file holds beside the plan.
    survey : SurveyFile or None
        The survey in it.
    """

    plan: FloorPlan
    report: tuple[str, ...]
    saved: SavedSession | None = None
    survey: SurveyFile | None = None


def _never() -> None:
    """Check for cancellation of a read that cannot be cancelled."""


def read_upload(
    name: str,
    content: bytes,
    limits: Limits | None = None,
    check: Callable[[], None] = _never,
) -> Upload:
    """Read the plan in an uploaded file.

    Parameters
    ----------
    name : str
        File name from the browser; its suffix gives the format, the rest names a plan without name.
    content : bytes
    limits : Limits, optional
    check : callable, optional
        Called every tenth of a second; its exception ends the import.

    Raises
    ------
    PlanError
        When the file is too large, of another format, or holds no usable plan.
    """
    limits = limits or Limits()
    origin = shown_name(name)
    if len(content) > limits.upload_bytes:
        raise PlanError(
            f"{len(content)} bytes; the explorer accepts files of at most {limits.upload_bytes}",
            origin=origin,
        )
    suffix = PurePosixPath(origin).suffix.lower()
    if suffix not in ACCEPTED:
        raise PlanError(
            f"expected a plan or a session in a file that ends in {', '.join(ACCEPTED)}",
            origin=origin,
        )
    with TemporaryDirectory(prefix="rssnav-") as folder:
        file = Path(folder) / file_name(PurePosixPath(origin).stem, suffix)
        file.write_bytes(content)
        reason = _run_worker(file, limits, check)
        if reason:
            raise PlanError(_in_users_words(reason, file, origin))
        plan = floorplans.loads(file.with_name(RESULT).read_text("utf-8"), origin=origin)
        if plan.name == file.stem:
            plan = replace(plan, name=PurePosixPath(origin).stem)
        upload = Upload(plan, _report(file.with_name(REPORT)))
        if suffix != SESSION:
            return upload
        saved = SavedSession.loads(file.with_name(SAVED).read_text("utf-8"))
    survey = None
    if saved.survey is not None:
        survey = read_survey_upload(origin, saved.survey.encode(), plan, limits)
    return upload._replace(saved=saved, survey=survey)


def _report(file: Path) -> tuple[str, ...]:
    """First lines that the worker wrote on an import; none for a plan in TOML."""
    if not file.exists():
        return ()
    lines = tuple(json.loads(file.read_text("utf-8")))
    more = len(lines) - _MOST_LINES
    return lines if more <= 0 else (*lines[:_MOST_LINES], f"... and {more} more lines")


def _run_worker(file: Path, limits: Limits, check: Callable[[], None]) -> str:
    """Write the plan in a file to `RESULT` beside it; return why not, or nothing."""
    arguments = [file.name, json.dumps(asdict(limits))]
    command = [sys.executable, "-m", "rssnav.explorer.import_worker", *arguments]
    log = file.with_name("errors.txt")
    with (
        log.open("wb") as errors,
        subprocess.Popen(
            command,
            cwd=file.parent,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=errors,
        ) as worker,
    ):
        try:
            status = _wait(worker, limits.import_s, check)
        finally:
            worker.kill()
    if status == 0:
        return ""
    if status is None:
        return (
            f"{file.name}: not read within {limits.import_s:g} s: simplify the drawing, or convert "
            "it with `rssnav plan import`"
        )
    lines = [line for line in log.read_text("utf-8", "replace").splitlines() if line.strip()]
    return lines[-1] if lines else f"{file.name}: could not be read"


def _wait(worker: subprocess.Popen[bytes], seconds: float, check: Callable[[], None]) -> int | None:
    """Wait for a process; return its status, or None when its time is over."""
    ends_s = time.monotonic() + seconds
    while (left_s := ends_s - time.monotonic()) > 0.0:
        check()
        try:
            return worker.wait(min(left_s, _POLL_S))
        except subprocess.TimeoutExpired:
            continue
    return None


def _in_users_words(reason: str, file: Path, origin: str) -> str:
    """A message of the worker with the file's name as the browser gave it."""
    named = reason.replace(f"{file.parent}/", "").replace(file.name, origin)
    return named if len(named) <= _REASON_LENGTH else f"{named[:_REASON_LENGTH]} ..."
