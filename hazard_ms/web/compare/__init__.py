"""The page's third part: results of folders beside one another."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from starlette.routing import Route


def routes(folders: Sequence[Path]) -> list[Route]:
    """The routes below /api/compare about the results in `folders`."""
    return []
