"""Sphinx: Markdown pages, every example run as a doctest."""

from importlib import metadata

project = "crashkit"
author = "crashkit developers"
copyright = author
release = metadata.version("crashkit")
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.doctest"]
exclude_patterns = ["_build"]
myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 3
autodoc_typehints = "description"
html_theme = "alabaster"
