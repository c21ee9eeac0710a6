"""Standard output and standard error on terminals of any encoding, full disks and closed pipes."""

import io
import os
import sys
from collections.abc import Generator
from contextlib import contextmanager

from rssnav.cli.failures import EXIT_FAILURE, print_error
from rssnav.messages import describe


@contextmanager
def tolerant_streams() -> Generator[None]:
    """Escape characters that a stream cannot encode, and write out what it still holds at the end.

    Raises
    ------
    SystemExit
        With 1 where the output cannot be written; silently if its reader has closed the pipe.
    """
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")
    try:
        yield
    finally:
        _write_out()


def _write_out() -> None:
    if sys.stdout is None:  # closed by whoever started the program
        return
    try:
        sys.stdout.flush()
    except OSError as error:
        _drop_output()
        if not isinstance(error, BrokenPipeError):
            print_error(f"standard output: {describe(error)}")
        raise SystemExit(EXIT_FAILURE) from None


def _drop_output() -> None:
    """Send what standard output still holds nowhere, so that Python does not write it at exit."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, sys.stdout.fileno())
    os.close(nowhere)
