"""Errors in words, for people."""


def describe(error: Exception) -> str:
    """Return an error's message on one line; of an `OSError`, the file and the reason."""
    if isinstance(error, OSError) and error.strerror:
        text = f"{error.filename}: {error.strerror}" if error.filename else error.strerror
    else:
        text = str(error)
    return " ".join(text.split())
