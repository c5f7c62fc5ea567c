"""Tracks of things that are detected again and again, matched by category and place.

A detection goes on with a track of its category within GATE of where that was seen last, and a little farther while it
is out of sight. Where that place is in view and empty, the thing has moved, and may be as far as it can drift. Of all
ways to pair detections with tracks the one of the least summed distance is taken (Hungarian method).

With the errors of the detector known, tracks are fused: a detection of another category within CLOSE goes on with a
track, too, if none of its own does, and each track keeps the evidence of all looks at it, those that missed it among
them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from hazard_ms.sensing.detection.confusion import Confusion, Look
from hazard_ms.sensing.detection.fusion import Evidence
from hazard_ms.sensing.sighting import Sighting, merged
from hazard_ms.sensing.view import View
from hazard_ms.spec.catalogue import CATEGORIES

GATE = 0.3  # distance within which a thing of the same category is the same one [m] [ours]
DRIFT = 0.016  # by which that grows for a thing that has moved: what a robot walks in a frame [m/frame] [ours]
UNSEEN_DRIFT, UNSEEN_MOST = 0.004, 1.0  # the same for one out of sight [m/frame], and at most [m] [ours]
BEHIND = 0.15  # what is this far behind where a thing was shows that it is gone [m] [ours]
AROUND = 0.05  # by which a thing may reach beyond what was seen of it [m] [ours]
ENOUGH = 2  # frames in which a thing must be seen before it is believed [ours]
GONE = 2  # frames in which its place must be seen empty before it is forgotten [ours]
CLOSE = 0.2  # distance within which a thing of another category is the same one, told otherwise [m] [ours]
UNPAIRED = 1e6  # cost of a pair that cannot be: more than all distances of a scene together [m]


class Found(NamedTuple):
    """A detection as tracks take it: its category, where it is, and the chances that the detector told, if it did."""

    category: str
    sighting: Sighting
    chances: tuple[float, ...] | None = None


@dataclass(eq=False)
class Track:
    """One thing that was detected, perhaps more than once."""

    category: str
    sighting: Sighting
    frames: int = 1  # in which it was seen
    empty: int = 0  # frames since then in which its place was seen empty
    index: int = -1  # by which the agent knows it; -1: not yet
    score: float = 0.0  # of its surest detection
    refuted: bool = False  # whether it turned out not to be there, so that it is never believed again
    rescued: bool = False
    evidence: Evidence | None = None  # of all looks; None where they are not fused
    size: float = 0.0  # its pixels at 1 m, by the last sighting
    belief: float = 1.0  # the chance that it is there and of its category

    @property
    def loose(self) -> bool:
        """Whether it can move."""
        return CATEGORIES[self.category].kind == "object"

    def reach(self, frame: int) -> float:
        """Distance from where it was seen last within which it may be at `frame` [m]."""
        age = frame - self.sighting.frame
        if not self.loose:
            return GATE + self.sighting.radius
        return GATE + (DRIFT * age if self.empty else min(UNSEEN_DRIFT * age, UNSEEN_MOST))


def seen_through(view: View, place: NDArray[np.floating]) -> bool:
    """Whether `view` shows what is behind `place` [m], [3], world frame: nothing is there any more."""
    pixel = view.pixel_of(place)
    if pixel is None:
        return False
    row, column, far = pixel
    return bool(view.depth[row, column] == 0.0 or view.depth[row, column] > far + BEHIND)


def surroundings(view: View, sighting: Sighting) -> tuple[tuple[slice, slice], NDArray[np.bool_]]:
    """The part of `view` around a thing where it was seen last, and which of its pixels, [R, C], may be of it."""
    pixel = view.pixel_of(sighting.position)
    if pixel is None:
        return (slice(0), slice(0)), np.zeros((0, 0), bool)
    row, column, far = pixel
    reach = sighting.radius + AROUND
    pixels = int(np.ceil(reach * max(view.intrinsic[0, 0], view.intrinsic[1, 1]) / far))
    window = slice(max(row - pixels, 0), row + pixels + 1), slice(max(column - pixels, 0), column + pixels + 1)
    return window, np.abs(view.depth[window] - far) < reach


def pairs(tracks: Sequence[Track], found: Sequence[Found], frame: int, fused: bool = False) -> list[tuple[int, int]]:
    """The pairs (track, detection) of the least summed distance, as indices.

    A pair of two categories, where these are `fused`, counts as if it were farther apart than all of one.
    """
    if not tracks or not found:
        return []
    old = np.array([track.sighting.position for track in tracks], np.float64)
    new = np.array([each.sighting.position for each in found], np.float64)
    cost = np.linalg.norm(old[:, None] - new[None], axis=-1)
    same = np.array([[track.category == each.category for each in found] for track in tracks])
    reach = np.array([track.reach(frame) for track in tracks])
    close = ~same & (cost < CLOSE) & fused
    far = ~same | (cost >= reach[:, None])
    cost[close] += reach.max()
    cost[far & ~close] = UNPAIRED
    rows, columns = linear_sum_assignment(cost)
    return [(int(r), int(c)) for r, c in zip(rows, columns, strict=True) if cost[r, c] < UNPAIRED]


class Tracker:
    """The tracks of an episode."""

    def __init__(self, confusion: Confusion | None = None) -> None:
        """Begin without any; `confusion`: the errors of the detector by which looks are fused."""
        self.tracks: list[Track] = []
        self._confusion = confusion

    def update(
        self, view: View, frame: int, found: Mapping[int, Found], still: Sequence[Track] = ()
    ) -> tuple[dict[int, Track], list[Track]]:
        """Enter what was `found` in a `view`: by number of a detection.

        Returns the track of each detection, and the tracks that are given up because their places are empty, which
        rescued ones never are. Those in `still` are left alone: the hand has them, or they are in the bag.
        """
        known = [track for track in self.tracks if track not in still]
        for track in known:
            looked_for = track.sighting.frame < frame and not track.rescued  # what is safe stays so
            if looked_for and seen_through(view, track.sighting.position):
                track.empty += 1
        numbers = list(found)
        matched: dict[int, Track] = {}
        for row, column in pairs(known, [found[n] for n in numbers], frame, self._confusion is not None):
            track, seen = known[row], found[numbers[column]].sighting
            track.frames += track.sighting.frame < frame
            track.sighting, track.empty = merged(track.sighting, seen), 0
            matched[numbers[column]] = track
        for number in numbers:
            if number not in matched:
                matched[number] = Track(found[number].category, found[number].sighting)
                self.tracks.append(matched[number])
        if self._confusion is not None:
            self._look(view, frame, known, {n: (found[n], track) for n, track in matched.items()})
        lost = [track for track in known if track.empty >= GONE and track.loose]
        self.tracks = [track for track in self.tracks if track not in lost]
        return matched, lost

    def _look(
        self,
        view: View,
        frame: int,
        known: Sequence[Track],
        told: Mapping[int, tuple[Found, Track]],
    ) -> None:
        """Enter what a `view` told of its tracks, and that it told nothing of the others whose places it shows."""
        assert self._confusion is not None
        eye = view.cam2world[:3, 3]
        for (category, seen, chances), track in told.values():
            track.size = seen.pixels * float(np.sum((seen.position - eye) ** 2))
            if category not in self._confusion.classes:
                continue
            look = Look(category, seen.pixels, chances)
            if track.evidence is None:
                track.evidence = Evidence(self._confusion, look, eye)
            else:
                track.evidence.look(look, eye)
        found = [track for _, track in told.values()]
        for track in known:
            if track.evidence is not None and track not in found and shows(view, track.sighting):
                pixels = track.size / float(np.sum((track.sighting.position - eye) ** 2))
                track.evidence.look(Look(None, pixels), eye)


def shows(view: View, sighting: Sighting) -> bool:
    """Whether `view` shows what is where a thing was seen last: nothing is before it, and something is there."""
    pixel = view.pixel_of(sighting.position)
    if pixel is None:
        return False
    row, column, far = pixel
    return bool(abs(float(view.depth[row, column]) - far) < sighting.radius + BEHIND)
