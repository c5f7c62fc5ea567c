"""One polygon for one mask, as YOLO's label files need it, whatever parts and holes the mask has.

Corners are the outermost pixels of each part, and those around each hole, as OpenCV's `findContours` gives them; filled
with their border, as readers do, one part without holes gives back its mask exactly. Further parts, and holes, are
joined to the largest part, nearest first, by a line there and back between the two nearest corners: the common way
(Ultralytics' `merge_multi_segment`), for holes, too. Such a line has no area, but readers draw it one pixel wide.
"""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

LEAST_PART = 4  # pixels of a further part, or of a hole, that is kept [ours]
MOST_PARTS = 64  # parts that are kept, and holes, the largest ones [ours]
WITHIN = 0.25  # place of a corner in its pixel, from its left and its top [pixels] [ours]
LEAST_CORNERS = 3  # of a row in a label file [Ultralytics]


def outline(mask: NDArray[np.uint8]) -> NDArray[np.int64]:
    """The corners, column and row [pixels], [N, 2], of one polygon around a mask, [H, W], that is not empty."""
    rings = _rings(mask)
    path = rings.pop(0)
    while rings:
        tree = cKDTree(path)
        near = [tree.query(ring) for ring in rings]
        k = int(np.argmin([distance.min() for distance, _ in near]))
        distance, place = near[k]
        start = int(np.argmin(distance))
        after = int(place[start])
        ring = np.roll(rings.pop(k), -start, axis=0)
        path = np.concatenate([path[: after + 1], ring, ring[:1], path[after:]])
    return path if len(path) >= LEAST_CORNERS else np.resize(path, (LEAST_CORNERS, 2))


def _rings(mask: NDArray[np.uint8]) -> list[NDArray[np.int64]]:
    """The borders of the parts and holes that are kept, [N, 2] each, the largest part first."""
    kept = _largest(mask, 8)
    inside = _enclosed(1 - kept)
    solid = kept | (inside & (1 - _largest(inside, 4)))
    found, levels = cv2.findContours(solid, cv2.RETR_CCOMP, cv2.CHAIN_APPROX_SIMPLE)
    outer = [k for k in range(len(found)) if levels[0, k, 3] < 0]
    first = max(outer, key=lambda k: float(cv2.contourArea(found[k]) + len(found[k])))
    return [found[k][:, 0].astype(np.int64) for k in [first, *(k for k in range(len(found)) if k != first)]]


def _largest(mask: NDArray[np.uint8], neighbours: int) -> NDArray[np.uint8]:
    """The MOST_PARTS largest parts of a `mask`, [H, W], with LEAST_PART pixels each.

    Pixels of a part are joined by 4 or 8 `neighbours`; with 8, for things, the largest part is kept whatever its size.
    """
    _, labels, stats, _ = cv2.connectedComponentsWithStats(mask, connectivity=neighbours)
    area = stats[:, cv2.CC_STAT_AREA].copy()
    area[0] = -1  # all that is not in the mask
    order = np.argsort(-area, kind="stable")
    kept = area >= LEAST_PART
    kept[order[MOST_PARTS:]] = False
    kept[order[0]] = neighbours == 8 or kept[order[0]]
    kept[0] = False
    return kept[labels].astype(np.uint8)


def _enclosed(background: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """The part of a `background`, [H, W], that no way over neighbouring pixels joins to the picture's border."""
    _, labels = cv2.connectedComponents(background, connectivity=4)
    outside = np.zeros(int(labels.max()) + 1, bool)
    outside[np.concatenate([labels[0], labels[-1], labels[:, 0], labels[:, -1]])] = True
    outside[0] = True
    return (~outside)[labels].astype(np.uint8)


def text(number: int, mask: NDArray[np.uint8]) -> str:
    """The row of a label file for the `mask`, [H, W], of a thing of class `number`: `number x1 y1 x2 y2 ...`.

    Numbers are shares of width and height. Each corner is WITHIN its pixel, so it stays that pixel whether a reader
    rounds down or to the nearest number.
    """
    height, width = mask.shape
    shares = (outline(mask) + WITHIN) / (width, height)
    return " ".join([str(number), *(f"{value:.7g}" for value in shares.ravel().tolist())])
