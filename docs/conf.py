"""Sphinx configuration."""

from importlib.metadata import version as installed_version

project = "rssnav"
author = "The rssnav developers"
version = release = installed_version("rssnav")
extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx.ext.viewcode",
]
myst_enable_extensions = ["dollarmath", "amsmath"]
myst_heading_anchors = 3
html_theme = "furo"
html_title = "rssnav"
exclude_patterns = ["_build"]
autodoc_typehints = "none"
autodoc_member_order = "bysource"
napoleon_numpy_docstring = True
napoleon_use_ivar = True
suppress_warnings = ["ref.python"]  # fields of one name in two classes
