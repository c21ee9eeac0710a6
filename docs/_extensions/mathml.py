"""Formulas as MathML, written when the pages are built: no network and no script is needed."""

from __future__ import annotations

import html
import re
from typing import Any

from docutils import nodes
from latex2mathml.converter import convert
from sphinx.application import Sphinx
from sphinx.writers.html5 import HTML5Translator

TAG = re.compile(r"\\tag\{([^}]*)\}")


def setup(app: Sphinx) -> dict[str, Any]:
    """Register the renderer ``mathml``; Sphinx calls this."""
    app.add_html_math_renderer(
        "mathml", inline_renderers=(inline, None), block_renderers=(block, None)
    )
    app.add_css_file("mathml.css")
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def inline(translator: HTML5Translator, node: nodes.math) -> None:
    """Write a formula within a line."""
    translator.body.append(convert(node.astext()))
    raise nodes.SkipNode


def block(translator: HTML5Translator, node: nodes.math_block) -> None:
    r"""Write a displayed formula, and to its right the number that its ``\tag`` gives."""
    number = TAG.search(node.astext())
    formula = convert(TAG.sub("", node.astext()).strip(), display="block")
    label = f'<span class="equation-number">({html.escape(number[1])})</span>' if number else ""
    translator.body.append(f'<div class="equation">{formula}{label}</div>\n')
    raise nodes.SkipNode
