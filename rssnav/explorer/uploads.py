"""Floor plans from uploaded files.

References in an upload are not followed: TOML is parsed as text, and a file of another program is
imported alone in an empty folder, by a separate process with limited time and memory. Formats of
several files, such as a ROS map and its picture, are not accepted.
"""

import subprocess
import sys
import tomllib
from pathlib import Path, PurePosixPath
from tempfile import TemporaryDirectory
from typing import Any

import floorplans
from floorplans import FloorPlan, PlanError
from rssnav.explorer.limits import Limits

IMPORTED = (".dxf", ".geojson", ".ifc")
ACCEPTED = (".toml", *IMPORTED)

_NAME_LENGTH = 80


def read_upload(name: str, content: bytes, limits: Limits | None = None) -> FloorPlan:
    """Read the plan in an uploaded file.

    Parameters
    ----------
    name : str
        File name from the browser; only its suffix matters.
    content : bytes
    limits : Limits, optional

    Raises
    ------
    PlanError
        When the file is too large, of another format, or holds no usable plan.
    """
    limits = limits or Limits()
    origin = _origin_of(name)
    if len(content) > limits.upload_bytes:
        raise PlanError(
            f"{len(content)} bytes; the explorer accepts files of at most {limits.upload_bytes}",
            origin=origin,
        )
    suffix = PurePosixPath(origin).suffix.lower()
    if suffix not in ACCEPTED:
        raise PlanError(
            f"expected a plan in a file that ends in {', '.join(ACCEPTED)}", origin=origin
        )
    text = _decoded(content, origin) if suffix == ".toml" else _imported(suffix, content, limits)
    return _read_toml(text, origin, limits)


def _origin_of(name: str) -> str:
    """File name for messages: printable, without folders, and not too long."""
    last = name.replace("\\", "/").rsplit("/", 1)[-1]
    return "".join(c for c in last if c.isprintable())[-_NAME_LENGTH:] or "upload"


def _decoded(content: bytes, origin: str) -> str:
    try:
        return content.decode("utf-8")
    except UnicodeDecodeError as error:
        raise PlanError(f"not UTF-8 text: {error.reason}", origin=origin) from error


def _read_toml(text: str, origin: str, limits: Limits) -> FloorPlan:
    """Read a plan; count its walls first, because checking them takes time."""
    try:
        limits.check_walls(_n_walls(tomllib.loads(text)), origin)
        return floorplans.loads(text, origin=origin)
    except tomllib.TOMLDecodeError as error:
        raise PlanError(f"not valid TOML: {error}", origin=origin) from error
    except RecursionError as error:
        raise PlanError("arrays or tables are nested too deeply", origin=origin) from error


def _n_walls(table: dict[str, Any]) -> int:
    """Number of straight walls in a plan's table, which may be malformed."""
    walls = table.get("walls")
    rows = [row for row in walls if isinstance(row, dict)] if isinstance(walls, list) else []
    points = [row.get("points") for row in rows]
    return sum(len(line) - 1 for line in points if isinstance(line, list))


def _imported(suffix: str, content: bytes, limits: Limits) -> str:
    """TOML text of the plan in a file of another program."""
    with TemporaryDirectory(prefix="rssnav-") as folder:
        file, plan = Path(folder) / f"plan{suffix}", Path(folder) / "plan.toml"
        file.write_bytes(content)
        command = [sys.executable, "-m", "rssnav.explorer.import_worker"]
        try:
            done = subprocess.run(
                [*command, str(file), str(plan), str(limits.import_bytes)],
                cwd=folder,
                capture_output=True,
                stdin=subprocess.DEVNULL,
                timeout=limits.import_s,
                check=False,
            )
        except subprocess.TimeoutExpired as error:
            raise PlanError(
                f"not imported within {limits.import_s:g} s: simplify the drawing, or convert it "
                "with `rssnav plan import`",
                origin=file.name,
            ) from error
        if done.returncode != 0:
            raise PlanError(_reason(done.stderr.decode(errors="replace"), folder))
        return plan.read_text(encoding="utf-8")


def _reason(stderr: str, folder: str) -> str:
    """Last line that the import worker wrote, without the temporary folder."""
    lines = [line for line in stderr.splitlines() if line.strip()]
    return lines[-1].replace(f"{folder}/", "") if lines else "the file could not be read"
