"""How the pages of this folder become a site: plain Markdown in, files that need no network out."""

import re
from importlib.metadata import version as installed

from docutils import nodes
from latex2mathml.converter import convert

project = "nearflat"
author = "The nearflat authors"
project_copyright = author
release = version = installed("nearflat")

extensions = ["myst_parser", "sphinx.ext.autodoc", "numpydoc", "sphinx_copybutton"]
source_suffix = {".md": "markdown"}
exclude_patterns = ["_build"]
nitpicky = False

myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 3
autodoc_typehints = "none"  # numpydoc sections give the types, with shapes and units
numpydoc_show_class_members = False
autosummary_generate = False  # numpydoc loads autosummary, whose stubs would be reStructuredText

html_theme = "pydata_sphinx_theme"
html_title = "nearflat"
html_show_sourcelink = False
html_copy_source = False
html_math_renderer = "mathml"
html_theme_options = {
    "navigation_depth": 2,
    "show_toc_level": 2,
    "header_links_before_dropdown": 6,
    "footer_start": ["copyright"],
    "footer_end": [],
}


def inline_math(translator, node):
    """Formulas are MathML, which browsers draw by themselves: no script, no fonts, no network."""
    translator.body.append(convert(node.astext()))
    raise nodes.SkipNode


def displayed_math(translator, node):
    """A formula on its own line."""
    translator.body.append(f'<div class="formula">{convert(node.astext(), display="block")}</div>')
    raise nodes.SkipNode


def plain_bars(app, what, name, obj, options, lines):
    """|eta_hat| in a docstring is an absolute value, and nothing to be replaced."""
    lines[:] = [re.sub(r"\|([\w-]+)\|", r"\\|\1\\|", line) for line in lines]


def setup(app):
    """Register the renderer of formulas, and the reader of docstrings."""
    app.connect("autodoc-process-docstring", plain_bars)
    app.add_html_math_renderer("mathml", (inline_math, None), (displayed_math, None))
    return {"parallel_read_safe": True}
