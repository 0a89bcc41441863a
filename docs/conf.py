"""How the pages of this folder become a site: plain Markdown in, files that need no network out."""

import re
from importlib.metadata import version as installed
from pathlib import Path

from docutils import nodes
from latex2mathml.converter import convert
from numpydoc.xref import DEFAULT_LINKS

import explorer as ex

project = "nearflat"
author = "The nearflat authors"
project_copyright = author
release = version = installed("nearflat")

extensions = ["myst_parser", "sphinx.ext.autodoc", "numpydoc", "sphinx_copybutton"]
source_suffix = {".md": "markdown"}
exclude_patterns = ["_build", "**/README.md", "**/*.json", "**/*.parquet"]
nitpicky = False

myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 3
myst_html_meta = {"description": "How a rolling disk nearly falls flat, at any distance from falling"}
autodoc_typehints = "none"  # numpydoc sections give the types, with shapes and units
numpydoc_show_class_members = False
# In the sections of docstrings, types are links to what is said of them.
numpydoc_xref_param_type = True
numpydoc_xref_ignore = "all"
DEFAULT_LINKS.clear()  # they lead to other sites
numpydoc_xref_aliases = {
    name: path
    for page in Path(__file__).parent.glob("reference/python/*.md")
    for path, name in re.findall(r"autoclass:: (\S+\.(\w+))", page.read_text("utf-8"))
}
autosummary_generate = False  # numpydoc loads autosummary, whose stubs would be reStructuredText

html_theme = "pydata_sphinx_theme"
html_title = "nearflat"
html_show_sourcelink = False
html_copy_source = False
html_math_renderer = "mathml"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_logo = html_favicon = "_static/disk.svg"
html_extra_path = ["../results"]  # pictures of the gallery and the landing page
html_context = {"default_mode": "auto"}
html_sidebars = {"index": [], "gallery": []}
html_theme_options = {
    "logo": {"text": "nearflat"},
    "navigation_depth": 3,
    "secondary_sidebar_items": [],
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
    lines[:] = [re.sub(r"\|([\w()/-]+)\|", r"\\|\1\\|", line) for line in lines]


def live_page(app, error):
    """The article in the frame of the landing page, with the laboratory at its end."""
    if error is None and app.builder.format == "html":
        ex.view().save(Path(app.outdir) / "article.html")


def setup(app):
    """Register the renderer of formulas, the reader of docstrings, and the page in its frame."""
    app.connect("build-finished", live_page)
    app.connect("autodoc-process-docstring", plain_bars)
    app.add_html_math_renderer("mathml", (inline_math, None), (displayed_math, None))
    return {"parallel_read_safe": True}
