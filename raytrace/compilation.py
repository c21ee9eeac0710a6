"""Which kernels numba compiles while work runs, and how long that takes.

Kernels are compiled when they are first called, and loaded from a cache afterwards. Those who wait
should be told, and the time of a trace should not contain it.
"""

import time
from collections.abc import Callable, Generator
from contextlib import contextmanager

from numba.core import event

Compiled = Callable[[int], None]
"""Called with the number of functions compiled so far: 0 when the first compilation begins."""


class Compilation(event.Listener):
    """Counts the functions that are compiled; numba compiles one at a time, in any thread.

    Attributes
    ----------
    n_compiled : int
        Functions compiled so far.
    seconds : float
        Wall time of their compilation [s].
    """

    def __init__(self, report: Compiled | None = None) -> None:
        self.n_compiled = 0
        self.seconds = 0.0
        self._report = report
        self._depth = 0
        self._started = 0.0

    def on_start(self, event: event.Event) -> None:
        """Note that a function, or one that it calls, begins to be compiled."""
        if self._depth == 0:
            self._started = time.perf_counter()
            if self._report is not None:
                self._report(self.n_compiled)
        self._depth += 1

    def on_end(self, event: event.Event) -> None:
        """Note that a function is compiled, unless that began before the watch."""
        if self._depth == 0:
            return
        self._depth -= 1
        self.n_compiled += 1
        if self._report is not None:
            self._report(self.n_compiled)
        if self._depth == 0:
            self.seconds += time.perf_counter() - self._started


@contextmanager
def watched_compilation(report: Compiled | None = None) -> Generator[Compilation]:
    """Watch what is compiled in a ``with`` block.

    Parameters
    ----------
    report
        Called when the first compilation begins, and after each function.
    """
    compilation = Compilation(report)
    with event.install_listener("numba:compile", compilation):
        yield compilation
