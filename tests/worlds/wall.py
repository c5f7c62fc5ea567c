"""A view of a wall, from a camera whose pixels and points are easily worked out by hand."""

from __future__ import annotations

import numpy as np

from hazard_ms.sensing.view import View

FOCAL, SIDE = 50.0, 100  # [pixels]
# a camera 1 m above the floor that looks along +x, with +y to its left
LEVEL = np.array([[0, 0, -1, 0], [-1, 0, 0, 0], [0, 1, 0, 1], [0, 0, 0, 1]], np.float32)


def view(depth: float = 4.0) -> View:
    """A wall at a distance [m]."""
    intrinsic = np.array([[FOCAL, 0, SIDE / 2], [0, FOCAL, SIDE / 2], [0, 0, 1]], np.float32)
    return View(np.full((SIDE, SIDE), depth, np.float32), intrinsic, LEVEL)
