"""Plans written in other programs' formats.

>>> import floorplans
>>> from floorplans.exporters import export
>>> export(floorplans.load("flat"), "flat.geojson")  # doctest: +SKIP
(PosixPath('flat.geojson'),)

Each format has a function that renders a plan as the bytes of one or more files; `export` selects
it by the file's suffix and writes all of its files or none.
"""

from floorplans.exporters.formats import FORMATS, ExportOptions, Format, export, format_of, render

__all__ = ["FORMATS", "ExportOptions", "Format", "export", "format_of", "render"]
