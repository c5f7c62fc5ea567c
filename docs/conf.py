"""How Sphinx builds the documentation: `./run docs`."""

from hazard_ms import __version__

project = "hazard_ms"
author = "the authors of hazard_ms"
release = version = __version__
extensions = ["myst_parser"]
exclude_patterns = ["Thumbs.db"]
myst_heading_anchors = 4  # headings down to this level can be linked to, as on GitHub
nitpicky = True
html_theme = "furo"
html_title = f"hazard_ms {__version__}"
html_show_copyright = False
html_show_sphinx = False
html_copy_source = False
