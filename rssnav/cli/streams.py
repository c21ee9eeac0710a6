"""Standard output and standard error on terminals of any encoding, full disks and closed pipes."""

import io
import os
import sys
from collections.abc import Generator
from contextlib import contextmanager

from rssnav.cli.failures import EXIT_FAILURE, print_error
from rssnav.messages import describe

OUTPUT = "standard output"


class NamedOutput(io.TextIOWrapper):
    """Standard output whose errors name it, as those of files do.

    Attributes
    ----------
    failed : bool
        Whether a write has failed; its error is on its way to the user.
    """

    failed = False

    def write(self, text: str, /) -> int:
        """Write a text, or raise an `OSError` with the name."""
        with self._named():
            return super().write(text)

    def flush(self) -> None:
        """Write out what is held, or raise an `OSError` with the name."""
        with self._named():
            super().flush()

    @contextmanager
    def _named(self) -> Generator[None]:
        try:
            yield
        except OSError as error:
            self.failed, error.filename = True, OUTPUT
            raise

    @classmethod
    def over(cls, stream: io.TextIOWrapper) -> "NamedOutput":
        """Return the same stream, with the name."""
        stream.flush()
        return cls(
            stream.buffer,
            stream.encoding,
            "backslashreplace",
            line_buffering=stream.line_buffering,
            write_through=stream.write_through,
        )


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
    with _named_output():
        try:
            yield
        finally:
            _write_out()


@contextmanager
def _named_output() -> Generator[None]:
    """Let standard output be named in errors; a program of tests may have put another there."""
    before = sys.stdout
    if not isinstance(before, io.TextIOWrapper):
        yield
        return
    sys.stdout = named = NamedOutput.over(before)
    try:
        yield
    finally:
        sys.stdout = before
        named.detach()


def _write_out() -> None:
    if sys.stdout is None:  # closed by whoever started the program
        return
    reported = isinstance(sys.stdout, NamedOutput) and sys.stdout.failed
    try:
        sys.stdout.flush()
    except OSError as error:
        _drop_output()
        if not reported and not isinstance(error, BrokenPipeError):
            print_error(describe(error))
        raise SystemExit(EXIT_FAILURE) from None


def _drop_output() -> None:
    """Send what standard output still holds nowhere, so that Python does not write it at exit."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, sys.stdout.fileno())
    os.close(nowhere)
