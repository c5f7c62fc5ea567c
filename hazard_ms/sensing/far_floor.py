"""The floor of a look: between pixels that see it metres apart, far off; and bare where something stood, nearby."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from hazard_ms.sensing.camera import AGENT
from hazard_ms.sensing.view import View

FLOOR = 0.1  # points below this are of the floor: higher than thresholds, lower than a thing in the way [m] [ours]
BARE_WITHIN = 2.5  # distance up to which all that stands in a cell has points in a look [m] [ours]
BESIDE = 2  # cells around one with such points that are not surely bare: it may be flat and have few [ours]
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


def bare_cells(
    view: View,
    grid: int,
    agent: tuple[float, float],
    origin: NDArray[np.floating],
    cell: float,
    cells: int,
    ceiling: float,
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """The cells (y, x), [N] each, in which a view shows floor near the `agent` [m], and nothing there or just beside.

    `grid`: see `pixels`; the map has `cells` x `cells` of edge `cell` [m], from `origin` [m] on, [2], up to `ceiling`
    [m].
    """
    row, column = pixels(*view.depth.shape, grid)
    points = view.points(row, column)
    at = np.floor((points[:, :2] - origin) / cell).astype(np.int64)
    real = (view.depth[row, column] > 0.0) & ((at >= 0) & (at < cells)).all(axis=1)
    if view.labels is not None:
        real &= view.labels[row, column] != AGENT
    real &= points[:, 2] < ceiling
    low = points[:, 2] < FLOOR
    near = np.hypot(*(points[:, :2] - agent).T) < BARE_WITHIN
    bare, taken = np.zeros((2, cells, cells), bool)
    for shown, where in ((bare, real & low & near), (taken, real & ~low)):
        x, y = at[where].T
        shown[y, x] = True
    y, x = np.nonzero(bare & ~ndimage.binary_dilation(taken, np.ones((3, 3), bool), BESIDE))
    return y, x


@lru_cache(maxsize=4)
def pixels(height: int, width: int, grid: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Rows and columns of the pixels of a picture that mark cells, [P] each; `grid`: columns, and rows up to twice."""
    rows = np.r_[0 : height // 2 : max(1, height // grid), height // 2 : height]
    columns = np.arange(0, width, max(1, width // grid))
    return np.repeat(rows, len(columns)), np.tile(columns, len(rows))
