"""Plans written in the formats of other programs.

>>> import floorplans
>>> from floorplans.exporters import export
>>> export(floorplans.load("flat"), "flat.geojson")  # doctest: +SKIP
(PosixPath('flat.geojson'),)

Each format has one function that renders a plan as the bytes of one or more files; `export` finds
it by the file's ending and writes all of its files or none.
"""

from floorplans.exporters.formats import FORMATS, ExportOptions, Format, export, format_of, render

__all__ = ["FORMATS", "ExportOptions", "Format", "export", "format_of", "render"]
