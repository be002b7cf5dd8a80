"""Settings of Sphinx for the guide: all pages of docs/, the guide in front."""

import costate

project = "costate"
copyright = "the authors of costate"
version = release = costate.__version__
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.mathjax", "numpydoc"]
root_doc = "guide/index"
html_theme = "furo"
html_title = f"costate {version}"
exclude_patterns = ["guide/README.md"]
myst_enable_extensions = ["dollarmath", "deflist"]
myst_heading_anchors = 4
suppress_warnings = []
