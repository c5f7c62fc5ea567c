"""Pictures whose labels are numbers of detections: what tracks take of them, and what an agent is told they show."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from hazard_ms.sensing.camera import STRUCTURE
from hazard_ms.sensing.detection.detector import Detection
from hazard_ms.sensing.detection.labeller import blank
from hazard_ms.sensing.detection.odds import in_front, shown, shown_of_thing
from hazard_ms.sensing.detection.track import Found, Track
from hazard_ms.sensing.detection.tracks import surroundings
from hazard_ms.sensing.sighting import Sighting
from hazard_ms.sensing.view import View


def numbered(true: View, found: Sequence[Detection], own: NDArray[np.bool_], carts: Collection[int]) -> View:
    """The `true` view with numbers of `found` detections as labels.

    `own`: pixels of the robot, [H, W]; `carts`: numbers of detections of carts, whose masks end behind these.
    """
    labels = blank(own, true.depth)
    for number, detection in enumerate(found):
        mask = detection.mask & ~own
        labels[in_front(mask, true.depth) if number in carts else mask] = number
    return replace(true, labels=labels)


def found_in(view: View, number: int, detection: Detection, seen: Sighting, cart: bool) -> Found:
    """The detection with a `number` in a `view` as tracks take it, that was `seen`; `cart`: whether it tells of one."""
    assert view.labels is not None
    chances, tells = detection.chances, None
    if chances is not None:
        tells = (shown if cart else shown_of_thing)(view, view.labels == number, seen, max(chances))
    return Found(detection.category, seen, chances, tells)


def labels_of(
    view: View, tracks: Mapping[int, Track], near: Sequence[Track], frame: int, unsure: int
) -> NDArray[np.int64]:
    """The agent's labels, [H, W], of a `view` at a `frame` whose labels are numbers of detections, those of `tracks`.

    What may be a thing that can move, but is not believed or was not detected, is `unsure` and not mapped: else it
    would be an obstacle for ever. `near`: all tracks but those in the hand and in the bag.
    """
    assert view.labels is not None
    index = np.full(int(view.labels.max(initial=0)) + 1, unsure)
    for number, track in tracks.items():
        index[number] = track.index if track.index >= 0 else unsure if track.loose else STRUCTURE
    labels = np.where(view.labels >= 0, index[np.maximum(view.labels, 0)], view.labels)
    for track in near:
        if track.loose and track.sighting.frame < frame:
            window, about = surroundings(view, track)
            labels[window] = np.where(about & (labels[window] == STRUCTURE), unsure, labels[window])
    return labels
