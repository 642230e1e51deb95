"""Settings of Sphinx for the site, which `make site` builds."""

from typing import Any

import tline

project = "tline"
author = "The tline developers"
version = release = tline.__version__
extensions = ["myst_parser", "numpydoc", "sphinx.ext.autodoc", "sphinx.ext.autosummary"]
root_doc = "index"
templates_path = ["templates"]
myst_heading_anchors = 4
suppress_warnings = [
    "myst.xref_missing",  # links to folders and to files that are no pages
    "myst.header",
    "toc.not_included",  # tables of measurements, which pages lead to
]
autosummary_generate = True
autodoc_typehints = "none"  # docstrings have types in words
numpydoc_show_class_members = False
html_theme = "pydata_sphinx_theme"
html_title = "tline"
html_theme_options = {"show_prev_next": False, "navigation_with_keys": False, "header_links_before_dropdown": 3}
html_static_path = ["style"]
html_css_files = ["site.css"]
html_sidebars = {"docs/*": ["globaltoc.html"], "*": [], "gallery": ["sidebar-nav-bs"], "reference": ["sidebar-nav-bs"]}
html_show_sourcelink = False


def characters_mean_themselves(_: Any, kind: str, name: str, *rest: Any) -> None:
    """Neither |H| nor "*" in a docstring is reStructuredText; `rest` ends with the lines, changed in place."""
    lines: list[str] = rest[-1]
    for k, line in enumerate(lines):
        if not line.lstrip().startswith(">>>"):
            lines[k] = line.replace("|", "\\|").replace('"*', '"\\*')


def setup(app: Any) -> None:
    """Called by Sphinx."""
    app.connect("autodoc-process-docstring", characters_mean_themselves, priority=900)
