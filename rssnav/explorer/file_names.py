"""Names of files that come from the browser or go there."""

_LENGTH = 80


def shown_name(name: str) -> str:
    """File name for messages: printable, without folders, and not too long."""
    last = name.replace("\\", "/").rsplit("/", 1)[-1]
    return "".join(c for c in last if c.isprintable())[-_LENGTH:] or "upload"


def file_name(plan_name: str, suffix: str) -> str:
    """File name made from the plan's name: letters, digits and dashes only."""
    kept = "".join(c if c.isascii() and c.isalnum() else "-" for c in plan_name)
    return f"{'-'.join(filter(None, kept.split('-'))) or 'plan'}{suffix}"
