"""Settings of Sphinx for the guide: all pages of docs/, the guide in front."""

import importlib.util
from pathlib import Path

import costate
from docutils import nodes
from sphinx import addnodes

project = "costate"
copyright = "the authors of costate"
version = release = costate.__version__
extensions = ["myst_parser", "sphinx.ext.autodoc", "numpydoc"]
root_doc = "guide/index"
html_theme = "furo"
html_title = f"costate {version}"
# Lines of code have up to 96 columns.
code = {"code-font-size": "var(--font-size--small--3)"}
html_theme_options = {"light_css_variables": code, "dark_css_variables": code}
exclude_patterns = ["guide/README.md", "guide/notebooks"]
myst_heading_anchors = 4
autodoc_member_order = "bysource"
# Names in single backticks are links.
default_role = "py:obj"
numpydoc_show_class_members = False
# The reference of their modules does not need them.
friends = ("casadi", "crocoddyl", "jax", "scipy", "torch")
autodoc_mock_imports = [name for name in friends if importlib.util.find_spec(name) is None]

DOCS = Path(__file__).parents[1]


def plain_links(app, doctree):
    """Links to files of the repository that are no pages become their words; `.ci/documents` checks the files."""
    for link in list(doctree.findall(addnodes.pending_xref)):
        target = link.get("reftarget", "").split("#")[0]
        suffix = ".md" if link.get("refdomain") == "doc" else ""
        file = ((DOCS / app.env.docname).parent / f"{target}{suffix}").resolve()
        if target and DOCS not in file.parents and file.exists():
            link.replace_self(nodes.inline("", "", *link.children))


def setup(app):
    app.connect("doctree-read", plain_links)
