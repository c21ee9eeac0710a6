"""A page that shows a drawing and the plan made from it, one over the other."""

from floorplans.importers.page.page import import_page

__all__ = ["import_page"]
