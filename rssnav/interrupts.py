"""Ctrl-C and SIGTERM end the program within a second, with one line and no traceback.

The first signal raises KeyboardInterrupt on the main thread, so that files are closed and finished
work is kept. Where the main thread is inside a library that does not return in time (a compiler,
say), or where a library drops the interrupt, a second thread ends the process: files are written
whole or not at all, so this is safe at any moment. It uses the standard library alone, because
importing others may take a while.
"""

import atexit
import os
import signal
import socket
import sys
import threading
import time
from collections.abc import Generator
from contextlib import contextmanager, suppress
from types import FrameType
from typing import Any

INTERRUPTED_TEXT = "interrupted; no incomplete file was written"

LONGEST_END_S = 0.7
"""Time from the signal after which the process is ended, except while finished work is kept [s]."""

_SIGNALS = (signal.SIGINT, signal.SIGTERM)
_CLEAR_LINE, _SHOW_CURSOR = b"\r\x1b[2K", b"\x1b[?25h"


class Interrupts:
    """Handles the signals of a process; made on its main thread."""

    def __init__(self) -> None:
        self._signal = 0
        self._is_reported = False
        self._n_keeping = 0
        self._ends_s = 0.0

    @property
    def exit_code(self) -> int:
        """128 and the number of the first signal, as shells count; 0 before it."""
        return 128 + self._signal if self._signal else 0

    def install(self) -> None:
        """Handle signals from now on, except those that the process was started to ignore."""
        reader, writer = socket.socketpair()
        writer.setblocking(False)
        signal.set_wakeup_fd(writer.fileno(), warn_on_full_buffer=False)
        threading.Thread(
            target=self._watch, args=(reader, writer), name="signals", daemon=True
        ).start()
        for number in _SIGNALS:
            if signal.getsignal(number) is not signal.SIG_IGN:
                signal.signal(number, self._interrupt)
        sys.unraisablehook = _report_unraisable
        atexit.register(_ignore_signals)

    @contextmanager
    def keeping(self) -> Generator[None]:
        """Let finished work be kept, however long that takes."""
        self._n_keeping += 1
        try:
            yield
        finally:
            self._ends_s = time.monotonic() + LONGEST_END_S
            self._n_keeping -= 1

    def reported(self) -> None:
        """Note that the user has been told."""
        self._is_reported = True

    def end(self) -> None:
        """End the process if it was interrupted, without waiting for other threads."""
        if not self._signal:
            return
        for stream in (sys.stdout, sys.stderr):
            with suppress(OSError, ValueError, AttributeError):
                stream.flush()
        self._end()

    def _interrupt(self, number: int, _frame: FrameType | None) -> None:
        """Raise KeyboardInterrupt for the first signal; the end is under way at later ones."""
        if not self._signal:
            self._signal = number
            raise KeyboardInterrupt

    def _watch(self, reader: socket.socket, _writer: socket.socket) -> None:
        """Wait for a signal, then end the process if it does not end by itself."""
        while (number := reader.recv(1)[0]) not in _SIGNALS:
            pass
        self._ends_s = time.monotonic() + LONGEST_END_S
        while time.monotonic() < self._ends_s or self._n_keeping:
            time.sleep(0.02)
        self._signal = self._signal or number
        self._end()

    def _end(self) -> None:
        if not self._is_reported:
            self._is_reported = True
            line = f"rssnav: {INTERRUPTED_TEXT}\n".encode()
            with suppress(OSError):
                is_terminal = os.isatty(2)
                os.write(2, _CLEAR_LINE + _SHOW_CURSOR + line if is_terminal else line)
        os._exit(self.exit_code)


def _ignore_signals() -> None:
    """Ignore signals once all is done: Python would restore their defaults, which kill it."""
    for number in _SIGNALS:
        signal.signal(number, signal.SIG_IGN)


def _report_unraisable(unraisable: Any) -> None:
    """Report an error that Python cannot raise, unless it is an interrupt: that has its line."""
    if not isinstance(unraisable.exc_value, KeyboardInterrupt):
        sys.__unraisablehook__(unraisable)


INTERRUPTS = Interrupts()
