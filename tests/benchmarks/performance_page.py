"""What the benchmarks write into docs/performance.md: a part between two marks each."""

import os
import platform
from pathlib import Path

PAGE = Path(__file__).parents[2] / "docs" / "performance.md"


def write_part(name: str, text: str, page: Path = PAGE) -> None:
    """Put a text between the marks of a part, at the end of the page where there are none yet."""
    begin, end = f"<!-- {name}: written by make bench-{name} -->", f"<!-- end of {name} -->"
    content = page.read_text()
    if begin not in content:
        content = f"{content.rstrip()}\n\n{begin}\n{end}\n"
    before, rest = content.split(begin)
    replaced, after = rest.split(end)
    if "written by make" in replaced:
        raise ValueError(f"{page.name}: part {name} holds another part, which would be lost")
    page.write_text(f"{before}{begin}\n\n{text.strip()}\n\n{end}{after}")


def machine() -> str:
    """Say on what machine this runs."""
    threads = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    return f"{platform.machine()}, {threads} threads, Python {platform.python_version()}"


def table(head: list[str], rows: list[list[str]]) -> str:
    """Return a Markdown table, all columns but the first two right-aligned."""
    marks = ["---" if k < 2 else "---:" for k in range(len(head))]
    return "\n".join(f"| {' | '.join(cells)} |" for cells in (head, marks, *rows))
