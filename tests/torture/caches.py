"""Caches of compiled kernels that are damaged, missing, read-only or somebody else's."""

from __future__ import annotations

import os
import random
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import raytrace.kernels
import rssnav.kernels
from raytrace.kernels.cache import cache_folder
from torture.attacks import Attacked
from torture.jobs import LIMIT_S, QUICK, Workshop, command, environment

STRANGER = 54321
"""A user without an entry in the user database."""
SOURCES = tuple(Path(package.__path__[0]) for package in (raytrace.kernels, rssnav.kernels))

MAP = ("map", "room.toml", "-o", "room.h5", "--force", *QUICK)
CURRENT = ("map", "room.toml", "-o", "room.h5", *QUICK)
"""A map that is up to date: kernels are loaded and not called."""


@dataclass(frozen=True)
class Setting:
    """The environment in which a command runs.

    Attributes
    ----------
    variables
        Environment variables; None removes one.
    arguments
        The command.
    lines
        How many lines on the cache there must be.
    as_stranger
        Whether another user runs it, who may read everything and write nothing of this one's.
    """

    variables: dict[str, str | None]
    arguments: Sequence[str] = CURRENT
    lines: int = 0
    as_stranger: bool = False


def attacks(workshop: Workshop) -> Iterator[Attacked]:
    """Run a command with each kind of cache."""
    for name, setting_in in SETTINGS.items():
        folder = workshop.before("map over an old one")
        with tempfile.TemporaryDirectory() as place:
            os.chmod(place, 0o777)
            setting = setting_in(Path(place))
            if setting.as_stranger and not _can_be_stranger():
                continue
            yield Attacked(f"cache {name}", 1, 0.0, tuple(_faults(setting, folder)))


def damaged(place: Path) -> Setting:
    """A copy of the cache in which some files are cut, changed or empty."""
    generator = random.Random(0)
    for path in sorted(_copy(place).rglob("*.nb?")):
        if generator.random() < 0.2:
            content = path.read_bytes()
            at = generator.randrange(len(content))
            path.write_bytes(generator.choice((b"", content[:at], content[:at] + b"?" + content)))
    return Setting({"XDG_CACHE_HOME": str(place)}, MAP, lines=1)


def blocked(place: Path) -> Setting:
    """A copy of the cache with a folder in the place of each file of code.

    Such files count as missing; that what is compiled instead cannot be kept is one line.
    """
    for path in _copy(place).rglob("*.nbc"):
        path.unlink()
        path.mkdir()
    return Setting({"XDG_CACHE_HOME": str(place)}, MAP, lines=1)


def read_only(place: Path) -> Setting:
    """A whole cache that belongs to somebody else."""
    _copy(place)
    return Setting({"XDG_CACHE_HOME": str(place)}, MAP, as_stranger=True)


def unwritable(place: Path) -> Setting:
    """A folder for caches in which nothing can be created: a private folder takes its place."""
    closed = place / "closed"
    closed.mkdir(mode=0o755)
    return Setting({"XDG_CACHE_HOME": str(closed), "TMPDIR": str(place)}, lines=1, as_stranger=True)


def no_folder(place: Path) -> Setting:
    """No folder at all: kernels are compiled, and nothing is kept."""
    closed = place / "closed"
    closed.mkdir(mode=0o755)
    variables = {"XDG_CACHE_HOME": str(closed), "TMPDIR": str(place)}
    (place / f"rssnav-{STRANGER}").mkdir(mode=0o777)  # of another user
    return Setting(variables, lines=1, as_stranger=True)


def homeless(place: Path) -> Setting:
    """Neither HOME nor an entry in the user database."""
    variables = {"HOME": None, "XDG_CACHE_HOME": None, "TMPDIR": str(place)}
    return Setting(variables, as_stranger=True)


def empty_variable(place: Path) -> Setting:
    """An empty XDG_CACHE_HOME, which names no folder."""
    return Setting({"XDG_CACHE_HOME": "", "HOME": str(place)})


SETTINGS: dict[str, Callable[[Path], Setting]] = {
    "damaged": damaged,
    "with folders for files": blocked,
    "read-only": read_only,
    "in an unwritable folder": unwritable,
    "without a folder": no_folder,
    "without a home": homeless,
    "with an empty variable": empty_variable,
}


def _copy(place: Path) -> Path:
    """Copy the caches of this machine below a folder for caches."""
    copied = place / "rssnav" / "kernels"
    for sources in SOURCES:
        folder = cache_folder(sources)
        assert folder is not None
        shutil.copytree(folder, copied / folder.name)
    return copied


def _can_be_stranger() -> bool:
    """Whether this process may become another user: it is root and has util-linux's setpriv."""
    return os.getuid() == 0 and shutil.which("setpriv") is not None


def _as_stranger(words: list[str]) -> list[str]:
    """Run a command as a stranger who may read everything, also an interpreter below /root."""
    return [
        "setpriv", f"--reuid={STRANGER}", f"--regid={STRANGER}", "--clear-groups",
        "--inh-caps=+dac_read_search", "--ambient-caps=+dac_read_search", *words,
    ]  # fmt: skip


def _faults(setting: Setting, folder: Path) -> Iterator[str]:
    variables = environment() | {k: v for k, v in setting.variables.items() if v is not None}
    for name in (name for name, value in setting.variables.items() if value is None):
        variables.pop(name, None)
    words = command(setting.arguments)
    if setting.as_stranger:
        words = _as_stranger(words)
        for path in (folder, *folder.rglob("*")):
            shutil.chown(path, STRANGER)
        folder.chmod(0o755)
    before = _beside_sources()
    done = subprocess.run(
        words, cwd=folder, env=variables, capture_output=True, text=True, timeout=LIMIT_S
    )
    if done.returncode:
        yield f"exit code {done.returncode}: {done.stderr[-1500:]}"
    yield from _line_faults(done.stderr, setting.lines)
    if _beside_sources() - before:
        yield f"files beside the sources: {sorted(_beside_sources() - before)}"


def _line_faults(errors: str, expected: int) -> Iterator[str]:
    lines = [line for line in errors.splitlines() if "kernels" in line and "first use" not in line]
    if "Traceback" in errors or "Warning" in errors:
        yield f"not a plain line: {errors[-1500:]}"
    if len(lines) != expected:
        yield f"{len(lines)} lines on the cache, expected {expected}: {lines}"


def _beside_sources() -> set[str]:
    return {
        str(path)
        for sources in SOURCES
        for path in sources.rglob("*")
        if path.suffix in (".nbi", ".nbc") or sys.implementation.name in path.suffix
    }
