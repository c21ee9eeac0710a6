"""Children that tests interrupt, also where the tests run in the background of a script.

A shell without job control starts background commands with SIGINT ignored, and a program that was
started to ignore a signal goes on doing so, as do its children.
"""

import signal


def accept_interrupts() -> None:
    """Handle SIGINT as a program in the foreground does; processes that are started do so too."""
    signal.signal(signal.SIGINT, signal.default_int_handler)
