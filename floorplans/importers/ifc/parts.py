"""The parts of a building element or storey, also in models whose relations run in circles."""

from typing import Any


def parts_of(element: Any) -> tuple[Any, ...]:
    """List all that an element contains, directly or not, in the order of the file.

    `ifcopenshell.util.element.get_decomposition` never ends where an element is a part of itself.
    """
    from ifcopenshell.util.element import get_decomposition

    found: dict[int, Any] = {}
    waiting = [element]
    while waiting:
        for part in get_decomposition(waiting.pop(), is_recursive=False):
            if part.id() not in found:
                found[part.id()] = part
                waiting.append(part)
    found.pop(element.id(), None)
    return tuple(found[number] for number in sorted(found))
