"""The page's third part: results of folders beside one another."""

from __future__ import annotations

from hazard_ms.cli.web.compare.answers import routes

__all__ = ["routes"]
