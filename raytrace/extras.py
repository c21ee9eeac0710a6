"""Optional dependencies: what to install if one is missing."""

from collections.abc import Generator
from contextlib import contextmanager


@contextmanager
def needs_extra(extra: str) -> Generator[None]:
    """Say how to install an extra when an import inside the block fails.

    Raises
    ------
    ImportError
        With the command.
    """
    try:
        yield
    except ImportError as error:
        raise ImportError(
            f'{error.name} is not installed: pip install "rssnav[{extra}]"', name=error.name
        ) from error
