"""Sphinx configuration."""

import sys
from importlib.metadata import version as installed_version
from importlib.resources import files
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent / "_extensions"))

from docstrings import properties_of

project = "rssnav"
author = "The rssnav developers"
project_copyright = f"2026, {author}"
version = release = installed_version("rssnav")
extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx.ext.napoleon",
    "sphinx.ext.viewcode",
    "sphinx_gallery.gen_gallery",
    "docstrings",
    "mathml",
    "repairs",
]
html_math_renderer = "mathml"
html_static_path = ["_static", str(files("ziamath") / "fonts" / "STIXTwoMath-Regular.ttf")]
myst_enable_extensions = ["dollarmath", "amsmath"]
myst_heading_anchors = 3
html_css_files = ["pages.css"]
html_theme = "furo"
html_title = "rssnav"
exclude_patterns = ["_build", "_extensions", "_templates", "gallery"]
autodoc_default_options = {"members": True}
autodoc_typehints = "none"
autodoc_member_order = "bysource"
napoleon_numpy_docstring = True
napoleon_use_param = False  # names that share a line and a description stay together
napoleon_attr_annotations = False
napoleon_custom_sections = [("Attributes", "params_style")]
autosummary_context = {"properties_of": properties_of}
templates_path = ["_templates"]
suppress_warnings = [
    "config.cache",  # of the function in autosummary_context
    "ref.python",  # fields of one name in two classes
]
sphinx_gallery_conf = {
    "examples_dirs": "gallery",
    "gallery_dirs": "examples",
    "filename_pattern": r"\.py$",
    "within_subsection_order": "FileNameSortKey",
    "matplotlib_animations": (True, "jshtml"),
    "abort_on_example_error": True,
    "remove_config_comments": True,
    "show_signature": False,
    "write_computation_times": False,
    "image_srcset": ["2x"],
}
