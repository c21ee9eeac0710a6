"""How many threads work is spread over."""

import os


def n_threads(threads: int | None = None) -> int:
    """Number of threads to use.

    Parameters
    ----------
    threads
        As many as the caller asks for; by default one for each processor this process may use.

    Raises
    ------
    ValueError
        For less than one.
    """
    if threads is None:
        if hasattr(os, "sched_getaffinity"):
            return len(os.sched_getaffinity(0))
        return os.cpu_count() or 1
    if threads < 1:
        raise ValueError(f"threads = {threads!r}: expected at least 1")
    return threads
