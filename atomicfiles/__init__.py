"""Files that are replaced whole or not at all.

>>> from atomicfiles import atomic_write
>>> with atomic_write("report.txt") as temporary:  # doctest: +SKIP
...     temporary.write_text("complete")

The content goes to a temporary file in the same folder, is flushed to disk, and is then renamed
over the old file. An exception leaves the old file as it was and removes the temporary one. A
process that is killed leaves its temporary file behind; the next write to the same file on the same
machine removes it. All packages of this project write their files this way.
"""

from atomicfiles.writing import atomic_write, atomic_write_all, temporaries

__all__ = ["atomic_write", "atomic_write_all", "temporaries"]
