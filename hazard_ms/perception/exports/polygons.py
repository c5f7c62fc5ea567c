"""One polygon for one mask, as YOLO's label files need it, whatever parts and holes the mask has.

Corners are the outermost pixels of each part, and those around each hole, as OpenCV's `findContours` gives them; filled
with their border, as readers do, one part without holes gives back its mask exactly. Further parts, and holes, are
joined to the largest part, nearest first, by a line there and back between the two nearest corners: the common way
(Ultralytics' `merge_multi_segment`), for holes, too. Such a line has no area, but readers draw it one pixel wide, so a
part of fewer pixels than its line would have is left out.
"""

from __future__ import annotations

from typing import NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

LEAST_PART = 4  # pixels of a further part, or of a hole, that is kept [ours]
MOST_PARTS = 64  # parts that are kept, and holes, the largest ones [ours]
WITHIN = 0.25  # place of a corner in its pixel, from its left and its top [pixels] [ours]
LEAST_CORNERS = 3  # of a row in a label file [Ultralytics]


class Ring(NamedTuple):
    """The border of a part of a mask, or of a hole in one."""

    corners: NDArray[np.int64]  # column and row [pixels], [N, 2]
    pixels: int  # of the part
    inside: int  # number of the ring of the part that a hole is in; -1 for parts


def outline(mask: NDArray[np.uint8]) -> NDArray[np.int64]:
    """The corners, column and row [pixels], [N, 2], of one polygon around a mask, [H, W], that is not empty."""
    rings = dict(enumerate(_rings(mask)))
    first = max(rings, key=lambda k: (rings[k].inside < 0, rings[k].pixels))
    path, done = rings.pop(first).corners, {first}
    while True:
        tree, best = cKDTree(path), None
        for k, ring in rings.items():
            if ring.inside >= 0 and ring.inside not in done:
                continue
            distances, places = tree.query(ring.corners)
            start = int(np.argmin(distances))
            worth = ring.inside >= 0 or distances[start] < ring.pixels
            if worth and (best is None or distances[start] < best[0]):
                best = float(distances[start]), k, start, int(places[start])
        if best is None:
            return path if len(path) >= LEAST_CORNERS else np.resize(path, (LEAST_CORNERS, 2))
        _, k, start, after = best
        ring_path = np.roll(rings.pop(k).corners, -start, axis=0)
        path = np.concatenate([path[: after + 1], ring_path, ring_path[:1], path[after:]])
        done.add(k)


def _rings(mask: NDArray[np.uint8]) -> list[Ring]:
    """The borders of the parts and holes that are kept."""
    kept = _largest(mask, 8)
    inside = _enclosed(1 - kept)
    solid = kept | (inside & (1 - _largest(inside, 4)))
    found, levels = cv2.findContours(solid, cv2.RETR_CCOMP, cv2.CHAIN_APPROX_SIMPLE)
    _, labels, stats, _ = cv2.connectedComponentsWithStats(solid, connectivity=8)
    corners = [ring[:, 0].astype(np.int64) for ring in found]
    sizes = [int(stats[labels[c[0, 1], c[0, 0]], cv2.CC_STAT_AREA]) for c in corners]
    return [Ring(c, size, int(levels[0, k, 3])) for k, (c, size) in enumerate(zip(corners, sizes, strict=True))]


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
