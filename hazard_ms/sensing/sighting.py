"""Things as an agent has seen them: their place, the levels of hazards there, and whether they were damaged."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from hazard_ms.sensing.view import View

SEEN_PIXELS = 3  # pixels from which a thing counts as seen: a key at 2 m has about as many in an image of 256 x 256
MEDIAN_PIXELS = 400  # least number of a thing's pixels that give its position: as good as all 20,000 [ours]
VIEW_ERROR = 0.1  # a median can move by this much because the angle of view changed [m]
PLAIN_PIXELS = 12.0  # pixels from which a thing would surely be seen where it lay: four times SEEN_PIXELS [ours]
IN_FRONT = 0.05  # what is this much nearer than a thing may hide it [m] [ours]
REMEMBERED = 256  # number of the newest levels of hazards that are kept for each thing


@dataclass(frozen=True)
class Sighting:
    """The memory of one thing. Levels are those of the task's hazards, in their order and units."""

    position: NDArray[np.float32]  # median of the points that were seen of it, [3] [m]
    radius: float  # horizontal distance of the farthest of these points from the median [m]
    top: float  # height of the highest of them [m]
    frame: int  # frame in which it was last seen
    pixels: int  # number of its pixels in the view that gave its position
    levels: tuple[float, ...] = ()  # mean level of each hazard over it when last seen; empty without a hazard image
    damaged: bool = False  # whether it was damaged when last seen
    history: tuple[tuple[int, tuple[float, ...]], ...] = ()  # (frame, levels), oldest first
    size: float = 0.0  # its pixels 1 m before the middle of the picture, by the view that gave its position; 0: unknown
    missing: bool = False  # whether a look since then has shown the place without it: it has moved, nobody knows where

    @property
    def hazard(self) -> float:
        """Level of the task's first hazard over the thing when it was last seen; NaN if unknown."""
        return self.levels[0] if self.levels else float("nan")


def sightings(
    view: View, frame: int, things: int, ignore: frozenset[int], damaged: NDArray[np.bool_] | None
) -> dict[int, Sighting]:
    """The sightings in `view` of B = `things` things, by index; those in `ignore` are left out.

    `damaged` [B]: which of them are damaged. The view must have labels.
    """
    assert view.labels is not None
    labels = view.labels.ravel()
    flat = np.flatnonzero((labels >= 0) & (view.depth.ravel() > 0.0))
    counts = np.bincount(labels[flat], minlength=things)
    order = np.argsort(labels[flat], kind="stable")
    ends = np.cumsum(counts)
    made = {}
    for index in np.flatnonzero(counts >= SEEN_PIXELS).tolist():
        if index not in ignore:
            pixels = flat[order[ends[index] - counts[index] : ends[index]]]
            made[index] = _sighting(view, frame, pixels, damaged is not None and bool(damaged[index]))
    return made


def _sighting(view: View, frame: int, pixels: NDArray[np.int64], damaged: bool) -> Sighting:
    some = pixels[:: max(1, len(pixels) // MEDIAN_PIXELS)]
    row, column = np.divmod(some, view.depth.shape[1])
    points = view.points(row, column)
    middle = np.median(points, axis=0)
    middle.flags.writeable = False
    radius = float(np.hypot(*(points[:, :2] - middle[:2]).T).max())
    levels = view.level_at(row, column)
    means = () if levels is None else tuple(float(level.mean()) for level in levels)
    history, size = ((frame, means),), len(pixels) * _of_one_metre(view, middle)
    return Sighting(middle, radius, float(points[:, 2].max()), frame, len(pixels), means, damaged, history, size)


def _of_one_metre(view: View, point: NDArray[np.float32]) -> float:
    """Factor by which a small thing at `point` [m], [3], has more pixels 1 m before the middle of the `view`."""
    away = point - view.cam2world[:3, 3]
    depth = float(-away @ view.cam2world[:3, 2])
    return depth**3 / float(np.linalg.norm(away))


def merged(known: Sighting | None, seen: Sighting) -> Sighting:
    """The memory of a thing after `seen`: the better of two views where it stayed, the new one where it moved."""
    if known is None:
        return seen
    moved = float(np.linalg.norm(seen.position - known.position)) > known.radius + VIEW_ERROR
    history = (*known.history, *seen.history)[-REMEMBERED:]
    if not moved and seen.pixels < known.pixels // 2:
        seen = replace(known, frame=seen.frame, levels=seen.levels, damaged=seen.damaged, missing=False)
    return replace(seen, history=history)


def with_missing(
    objects: Mapping[int, Sighting], view: View, frame: int, unmapped: Collection[int]
) -> dict[int, Sighting]:
    """The sightings `objects`, by index, in which those are marked as missing whose places the `view` shows empty.

    `frame`: of the view, whose labels are sure; things in `unmapped` are in the hand or rescued.
    """
    made = dict(objects)
    for index, seen in objects.items():
        if seen.frame < frame and not seen.missing and index not in unmapped and _shows_place_of(seen, view):
            made[index] = replace(seen, missing=True)
    return made


def _shows_place_of(seen: Sighting, view: View) -> bool:
    """Whether a thing would be seen in a `view` if it were still where it was `seen`: nothing is in front of it."""
    return seen.size >= PLAIN_PIXELS * _of_one_metre(view, seen.position) and unhidden(view, seen.position)


def unhidden(view: View, place: NDArray[np.floating]) -> bool:
    """Whether `view` shows what is at `place` [m], [3], or behind it: nothing is in front of it."""
    pixel = view.pixel_of(place)
    if pixel is None:
        return False
    row, column, far = pixel
    around = view.depth[max(row - 1, 0) : row + 2, max(column - 1, 0) : column + 2]
    return around.shape == (3, 3) and bool((around > far - IN_FRONT).all())
