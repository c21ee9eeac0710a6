"""``python -m rssnav.explorer.import_worker FILE LIMITS``: read an upload within limits.

`rssnav.explorer.uploads` runs it in the file's folder, so that a malicious file can only exhaust
this process. LIMITS is a JSON object with the fields of `rssnav.explorer.limits.Limits`.
"""

import json
import math
import re
import sys
import tomllib
from dataclasses import replace
from pathlib import Path

import floorplans
from floorplans import PlanError
from floorplans.importers import FORMATS, import_plan
from rssnav.explorer.limits import Limits
from rssnav.explorer.plan_size import PlanSize
from rssnav.messages import describe

TOML = ".toml"
SESSION = ".rssnav"
RESULT = "result"
"""Name of the file that the plan's TOML text is written to."""
REPORT = "report"
"""Name of the file for a JSON list of lines on the import; there is none for a TOML file."""
SAVED = "saved"
"""Name of the file for what a session's file holds beside the plan."""
ENTITY_MARKS = {
    suffix: re.compile(kind.entity) for kind in FORMATS for suffix in kind.text_suffixes
}
"""What begins each entity in a file of another program, by the file's suffix."""


def main(file: str, limits: str) -> int:
    """Write the plan in a file to `RESULT`, and a report to `REPORT`; return the exit code."""
    chosen = Limits(**json.loads(limits))
    limit_process(chosen)
    path = Path(file)
    try:
        text = READERS.get(path.suffix, import_file)(path, chosen)
        Path(RESULT).write_text(text, encoding="utf-8", newline="\n")
    except RecursionError:
        return refuse(f"{file}: arrays or tables are nested too deeply")
    except UnicodeDecodeError as error:
        return refuse(f"{file}: not UTF-8 text: {error.reason}")
    except tomllib.TOMLDecodeError as error:
        return refuse(f"{file}: not valid TOML: {error}")
    except (PlanError, OSError, MemoryError, ImportError, ValueError) as error:
        return refuse(describe(error) or "not enough memory to read the file")
    return 0


def refuse(reason: str) -> int:
    """Write why a file is refused, on one line; return the exit code."""
    print(" ".join(reason.split()), file=sys.stderr)
    return 1


def read_toml(path: Path, limits: Limits) -> str:
    """TOML text of the plan in a TOML file, without comments."""
    return checked_toml(path.read_text(encoding="utf-8"), path.name, limits)


def checked_toml(text: str, origin: str, limits: Limits) -> str:
    """TOML text of the plan in a text, without comments."""
    limits.check_size(PlanSize.of_table(tomllib.loads(text)), origin)
    return floorplans.dumps(floorplans.loads(text, origin=origin))


def read_session(path: Path, limits: Limits) -> str:
    """TOML text of the plan in the file of a session; the rest is written to `SAVED`."""
    from rssnav.explorer.session_file import SavedSession  # it loads the learning rules

    if path.stat().st_size > limits.session_bytes:
        raise PlanError(
            f"{path.stat().st_size} bytes; the explorer accepts sessions of at most "
            f"{limits.session_bytes}",
            origin=path.name,
        )
    text = path.read_text(encoding="utf-8")
    try:
        saved = SavedSession.loads(text)
    except ValueError as error:
        raise PlanError(" ".join(str(error).split()), origin=path.name) from error
    Path(SAVED).write_text(replace(saved, plan="").dumps(), encoding="utf-8")
    return checked_toml(saved.plan, path.name, limits)


def import_file(path: Path, limits: Limits) -> str:
    """TOML text of the plan in a file of another program; its report is written."""
    n_entities = sum(1 for _ in ENTITY_MARKS[path.suffix].finditer(path.read_bytes()))
    if n_entities > limits.entities:
        raise PlanError(
            f"{n_entities} entities; the explorer accepts at most {limits.entities}: leave out "
            "details, or use `rssnav plan import`, which has no limit",
            origin=path.name,
        )
    imported = import_plan(path)
    limits.check_size(PlanSize.of(imported.plan), path.name)
    Path(REPORT).write_text(json.dumps(imported.report), encoding="utf-8")
    return imported.toml()


READERS = {TOML: read_toml, SESSION: read_session}
"""Readers of the files that are not of another program, by suffix."""


def limit_process(limits: Limits) -> None:
    """Limit memory, time and files of this process, where the operating system supports it."""
    try:
        import resource
    except ImportError:
        return
    for kind, most in (
        (resource.RLIMIT_AS, limits.import_bytes),
        (resource.RLIMIT_CPU, math.ceil(limits.import_s)),
        (resource.RLIMIT_FSIZE, limits.plan_bytes),
    ):
        resource.setrlimit(kind, (most, most))


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
