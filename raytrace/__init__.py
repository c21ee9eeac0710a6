"""Exact indoor ray tracing: every path of a bounded order, no sampling.

A `Scene` is made from a triangle mesh of vertical wall sheets, a floor and a ceiling. From it
`trace_paths` finds the paths to given receivers, `received_power` sums them at points, and
`compute_radio_map` over a grid. Lengths are in metres, heights above the floor, angles in radians,
gains linear unless a name ends in ``_db`` or ``_dbm``.

The names are listed in `__init__.pyi`. Each is imported when it is first used, so that programs
which use few of them start quickly.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
