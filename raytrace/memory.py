"""How much memory a trace may take."""

import os
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

from raytrace.errors import MemoryLimitError

UNKNOWN_BYTES = 8 << 30
"""Assumed to be free where the system does not report it."""

_CGROUPS = Path("/sys/fs/cgroup")


def memory_limit(max_memory_bytes: int | None = None) -> int:
    """Most memory that a trace may take [bytes].

    Parameters
    ----------
    max_memory_bytes
        As the caller asks for; by default half of what is free.

    Raises
    ------
    ValueError
        For less than one byte.
    """
    if max_memory_bytes is None:
        return free_bytes() // 2
    if max_memory_bytes < 1:
        raise ValueError(f"max_memory_bytes = {max_memory_bytes!r}: expected at least 1")
    return int(max_memory_bytes)


def check_size(what: str, needed_bytes: int) -> None:
    """Raise `MemoryLimitError` for arrays that take more than half of the free memory."""
    left_bytes = memory_limit()
    if needed_bytes > left_bytes:
        raise MemoryLimitError(what, needed_bytes, left_bytes)


def free_bytes() -> int:
    """Memory that this process may still take: of the machine, and of its control group."""
    return max(min([_of_machine(), *_of_control_groups()]), 0)


def _of_machine() -> int:
    with suppress(OSError, ValueError):
        for line in Path("/proc/meminfo").read_text().splitlines():
            if line.startswith("MemAvailable:"):
                return int(line.split()[1]) << 10
    try:
        return os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    except (AttributeError, ValueError, OSError):
        return UNKNOWN_BYTES


def _of_control_groups() -> Iterator[int]:
    """What limits of control groups, version 2 or 1, leave to this process."""
    try:
        groups = [line.split(":", 2) for line in Path("/proc/self/cgroup").read_text().splitlines()]
    except OSError:
        return
    for _, controllers, name in groups:
        if not controllers:
            yield from _left_in(_CGROUPS, name, "memory.max", "memory.current")
        elif "memory" in controllers.split(","):
            files = "memory.limit_in_bytes", "memory.usage_in_bytes"
            yield from _left_in(_CGROUPS / "memory", name, *files)


def _left_in(root: Path, name: str, limit: str, usage: str) -> Iterator[int]:
    """What the limits of a group and of those around it leave."""
    inner = root / name.strip("/")
    for group in (inner, *inner.parents):
        with suppress(OSError, ValueError):  # none, or "max"
            yield int((group / limit).read_text()) - int((group / usage).read_text())
        if group == root:
            return
