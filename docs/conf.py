"""Settings of the documentation: ``python -m sphinx -W docs site``."""

import sys
from pathlib import Path

from pygments.lexers.special import TextLexer
from sphinx.highlighting import lexers

import puma_septic

# Pygments has no lexer for tables.
lexers["csv"] = TextLexer()
sys.path.insert(0, str(Path(__file__).parent / "_ext"))

project = "puma_septic"
author = "The puma-septic authors"
copyright = "2026, " + author
version = release = puma_septic.__version__

extensions = [
    "sphinx.ext.autodoc", "sphinx.ext.autosummary", "sphinx.ext.napoleon", "myst_parser", "computed", "mathml",
    "samples",
]  # fmt: skip
autosummary_generate = False
exclude_patterns = ["images", "_ext", "_static"]
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_extra_path = ["schemas.json"]
myst_enable_extensions = ["amsmath", "dollarmath"]
myst_heading_anchors = 3

html_math_renderer = "mathml"
html_theme = "furo"
html_title = f"puma_septic {release}"
html_show_sourcelink = False
html_copy_source = False

autodoc_member_order = "bysource"
autodoc_typehints = "none"  # types and shapes stand in the docstrings
autodoc_class_signature = "separated"
napoleon_google_docstring = False
napoleon_use_ivar = True
# Else every word of "shape (n_joints,)" would be looked up as a class.
napoleon_use_param = False
napoleon_use_rtype = False
# The same in the attributes of values: "n_joints" in a shape is no reference.
suppress_warnings = ["ref.python"]
