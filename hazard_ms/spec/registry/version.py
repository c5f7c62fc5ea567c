"""The version of hazard_ms: setup.py reads it from here, results and commands show it."""

__version__ = "0.1.0"
