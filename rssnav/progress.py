"""How long work reports what it has done."""

from collections.abc import Callable

Progress = Callable[[int, int], None]
"""Called with the number of finished parts and of all parts."""
