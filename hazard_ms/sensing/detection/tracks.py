"""Tracks of things that are detected again and again, matched by category and place.

A detection goes on with a track of its category within GATE of where that was seen last, and a little farther while it
is out of sight. Where that place is in view and empty, the thing has moved, and may be as far as it can drift. Of all
ways to pair detections with tracks the one of the least summed distance is taken (Hungarian method).

With the errors of the detector known, tracks are fused: a detection of another category within CLOSE, or whose mask
covers where a thing was seen, goes on with a track, too, if none of its own does, and each track keeps the evidence of
all looks at it, those that missed it among them. Two tracks of one category that one detection covers are one thing.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from hazard_ms.sensing.detection.confusion import Confusion, Look
from hazard_ms.sensing.detection.fusion import Evidence
from hazard_ms.sensing.detection.track import Found, Track
from hazard_ms.sensing.sighting import unhidden
from hazard_ms.sensing.view import View

BEHIND = 0.15  # what is this far behind where a thing was shows that it is gone [m] [ours]
AROUND = 0.05  # by which a thing may reach beyond what was seen of it [m] [ours]
ENOUGH = 2  # frames in which a thing must be seen before it is believed [ours]
GONE = 2  # frames in which its place must be seen empty before it is forgotten [ours]
CLOSE = 0.2  # distance within which a thing of another category is the same one, told otherwise [m] [ours]
PLAIN = 0.9  # share of looks that find a thing, from which one that does not tells that it has moved [ours]
UNPAIRED = 1e6  # cost of a pair that cannot be: more than all distances of a scene together [m]


def seen_through(view: View, place: NDArray[np.floating]) -> bool:
    """Whether `view` shows what is behind `place` [m], [3], world frame: nothing is there any more."""
    pixel = view.pixel_of(place)
    if pixel is None:
        return False
    row, column, far = pixel
    return bool(view.depth[row, column] == 0.0 or view.depth[row, column] > far + BEHIND)


def surroundings(view: View, track: Track) -> tuple[tuple[slice, slice], NDArray[np.bool_]]:
    """The part of `view` around a thing where it was seen last, and which of its pixels, [R, C], may be of it."""
    pixel = view.pixel_of(track.sighting.position)
    if pixel is None:
        return (slice(0), slice(0)), np.zeros((0, 0), bool)
    row, column, far = pixel
    reach = track.radius + AROUND
    pixels = int(np.ceil(reach * max(view.intrinsic[0, 0], view.intrinsic[1, 1]) / far))
    window = slice(max(row - pixels, 0), row + pixels + 1), slice(max(column - pixels, 0), column + pixels + 1)
    return window, np.abs(view.depth[window] - far) < reach


def pairs(
    tracks: Sequence[Track],
    found: Sequence[Found],
    frame: int,
    fused: bool = False,
    covers: NDArray[np.bool_] | None = None,
) -> list[tuple[int, int]]:
    """The pairs (track, detection) of the least summed distance, as indices.

    A pair of two categories, where these are `fused`, counts as if it were farther apart than all of one. `covers`,
    [T, D]: whether the mask of a detection covers where the thing of a track was seen, which then may be it from afar.
    """
    if not tracks or not found:
        return []
    old = np.array([track.sighting.position for track in tracks], np.float64)
    new = np.array([each.sighting.position for each in found], np.float64)
    cost = np.linalg.norm(old[:, None] - new[None], axis=-1)
    same = np.array([[track.category == each.category for each in found] for track in tracks])
    reach = np.array([track.reach(frame) for track in tracks])
    covered = np.zeros_like(same) if covers is None else covers
    close = ~same & ((cost < CLOSE) | covered) & fused
    far = ~same | ((cost >= reach[:, None]) & ~covered)
    cost[close] += max(reach.max(), cost[~far].max(initial=0.0))
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
        fused = self._confusion is not None
        over = covering(view, known) if fused else {}
        covers = np.array([[over.get(track) == n for n in numbers] for track in known], bool)
        for row, column in pairs(known, [found[n] for n in numbers], frame, fused, covers):
            known[row].see(found[numbers[column]].sighting, frame)
            matched[numbers[column]] = known[row]
        for number in numbers:
            if number not in matched:
                matched[number] = Track(found[number].category, found[number].sighting)
                self.tracks.append(matched[number])
        twice: list[Track] = []
        if fused:
            self._look(view, known, {n: (found[n], track) for n, track in matched.items()})
            twice = self._join(over, matched)
        lost = [track for track in self.tracks if track in twice or (track.empty >= GONE and track.loose)]
        self.tracks = [track for track in self.tracks if track not in lost]
        return matched, lost

    def _look(
        self,
        view: View,
        known: Sequence[Track],
        told: Mapping[int, tuple[Found, Track]],
    ) -> None:
        """Enter what a `view` told of its tracks, and that it told nothing of the others whose places it shows."""
        assert self._confusion is not None
        eye = view.cam2world[:3, 3]
        for (category, seen, chances, shown), track in told.values():
            track.size = seen.pixels * float(np.sum((seen.position - eye) ** 2))
            if category not in self._confusion.classes:
                continue
            look = Look(category, seen.pixels, chances, shown)
            if track.evidence is None:
                track.evidence = Evidence(self._confusion, look, eye)
            else:
                track.evidence.look(look, eye)
        found = [track for _, track in told.values()]
        for track in known:
            if track.evidence is not None and track not in found and shows(view, track):
                pixels = track.size / float(np.sum((track.sighting.position - eye) ** 2))
                track.evidence.look(Look(None, pixels), eye)
                if self._confusion.share_found(pixels) >= PLAIN and unhidden(view, track.sighting.position):
                    track.miss(eye)

    def _join(self, over: Mapping[Track, int], matched: dict[int, Track]) -> list[Track]:
        """Make one of each two tracks of one category that a detection covers; returns those that are given up.

        The one that has an index, and was seen more often, is kept: an agent may be on its way to it. `over`: the
        detection that covers each track; `matched`: the track of each, which is changed to the one kept.
        """
        gone = []
        found = set(matched.values())
        for track, number in over.items():
            other = matched.get(number)
            if other is None or track in found or other.category != track.category:
                continue
            if any(each.evidence is None or each.refuted or each.rescued for each in (track, other)):
                continue
            kept, left = sorted((other, track), key=lambda each: (each.index < 0, -each.frames))
            assert kept.evidence is not None and left.evidence is not None
            kept.evidence.join(left.evidence)
            kept.sighting, kept.size, kept.empty = other.sighting, other.size, 0
            kept.frames, kept.score = max(track.frames, other.frames), max(track.score, other.score)
            matched[number] = kept
            gone.append(left)
        return gone


def covering(view: View, tracks: Sequence[Track]) -> dict[Track, int]:
    """The detection that covers where the thing of each of `tracks` was seen; a `view` has their numbers as labels."""
    made: dict[Track, int] = {}
    for track in tracks if view.labels is not None else ():
        assert view.labels is not None
        pixel = view.pixel_of(track.sighting.position)
        if pixel is not None and view.labels[pixel[:2]] >= 0 and shows(view, track):
            made[track] = int(view.labels[pixel[:2]])
    return made


def shows(view: View, track: Track) -> bool:
    """Whether `view` shows what is where a thing was seen last: nothing is before it, and something is there."""
    pixel = view.pixel_of(track.sighting.position)
    if pixel is None:
        return False
    row, column, far = pixel
    return bool(abs(float(view.depth[row, column]) - far) < track.radius + BEHIND)
