"""Errors in words, for people."""


def describe(error: Exception) -> str:
    """Say what went wrong, on one line; for the system's errors: which file, and what of it."""
    if isinstance(error, OSError) and error.strerror:
        text = f"{error.filename}: {error.strerror}" if error.filename else error.strerror
    else:
        text = str(error)
    return " ".join(text.split())
