"""The floor between the pixels of a look: far from the camera, neighbouring pixels see floor that lies metres apart."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from hazard_ms.sensing.view import View

FLOOR = 0.1  # points below this are of the floor: higher than thresholds, lower than a thing in the way [m] [ours]
WIDEST_GAP = 0.5  # between neighbouring points of the floor, up to which what lies between them is floor [m] [ours]


def floor_between(view: View, every: int, cell: float) -> NDArray[np.float64]:
    """Points of the floor [m], [P, 2], world frame, between those that are seen in each row and `every` column.

    They lie at most `cell` [m] apart, inside of each four neighbouring pixels that all see the floor, farther apart
    than `cell` and no farther than WIDEST_GAP. The upper quarter of the image, where the sky is, is not looked at.
    """
    height, width = view.depth.shape
    rows, columns = np.arange(height // 4, height), np.arange(0, width, every)
    row, column = np.repeat(rows, len(columns)), np.tile(columns, len(rows))
    points = view.points(row, column).reshape(len(rows), len(columns), 3).astype(np.float64)
    floor = (view.depth[row, column].reshape(points.shape[:2]) > 0.0) & (points[..., 2] < FLOOR)
    corners = np.stack([points[:-1, :-1, :2], points[:-1, 1:, :2], points[1:, :-1, :2], points[1:, 1:, :2]])
    widest = np.ptp(corners, axis=0).max(-1)
    wanted = floor[:-1, :-1] & floor[:-1, 1:] & floor[1:, :-1] & floor[1:, 1:]
    wanted &= (widest > cell) & (widest <= WIDEST_GAP)
    share = np.linspace(0.0, 1.0, int(np.ceil(WIDEST_GAP / cell)) + 1)
    down, across = (part.ravel() for part in np.meshgrid(share, share, indexing="ij"))
    weights = np.stack([(1 - down) * (1 - across), (1 - down) * across, down * (1 - across), down * across])
    return np.einsum("kqd,ks->qsd", corners[:, wanted], weights).reshape(-1, 2)


@lru_cache(maxsize=4)
def pixels(height: int, width: int, grid: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Rows and columns of the pixels of a picture that mark cells, [P] each; `grid`: columns, and rows up to twice."""
    rows = np.r_[0 : height // 2 : max(1, height // grid), height // 2 : height]
    columns = np.arange(0, width, max(1, width // grid))
    return np.repeat(rows, len(columns)), np.tile(columns, len(rows))
