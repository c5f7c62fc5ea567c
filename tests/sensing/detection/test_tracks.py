"""Tracks: which detections are of the same thing, and when a thing is believed and given up."""

from __future__ import annotations

from itertools import permutations

import numpy as np
import pytest

from hazard_ms.sensing.detection.track import DRIFT, GATE, Found, Track
from hazard_ms.sensing.detection.tracks import Tracker, pairs, seen_through
from hazard_ms.sensing.sighting import Sighting
from tests.worlds.wall import view


def seen(x: float, y: float, frame: int, z: float = 1.0, radius: float = 0.1) -> Sighting:
    return Sighting(np.array([x, y, z], np.float32), radius, z, frame, 50)


def test_pixels_and_points_by_hand() -> None:
    """2 m ahead, 1 m to the left and 0.5 m up: 25 columns left of the middle, 12.5 rows above it."""
    row, column, far = view().pixel_of(np.array([2.0, 1.0, 1.5])) or (0, 0, 0.0)
    assert (row, column) == (37, 25) and far == pytest.approx(2.0)
    assert view().pixel_of(np.array([-2.0, 0.0, 1.0])) is None  # behind
    assert view().pixel_of(np.array([2.0, 3.0, 1.0])) is None  # beside
    point = view(2.0).points(np.array([37]), np.array([25]))[0]  # the middle of that pixel
    assert point.tolist() == pytest.approx([2.0, 0.98, 1.5], abs=1e-5)


@pytest.mark.parametrize(("wall", "empty"), [(4.0, True), (2.1, False), (2.0, False), (1.0, False), (0.0, True)])
def test_a_place_is_empty_if_what_is_behind_it_is_seen(wall: float, empty: bool) -> None:
    assert seen_through(view(wall), np.array([2.0, 0.0, 1.0])) is empty


def test_the_pairs_are_those_of_the_least_sum() -> None:
    """Two tracks are nearest to the same detection, and two detections to the same track."""
    tracks = [Track("mug", seen(2.0, y, 0)) for y in (0.0, 0.2, 0.5)]
    found = [Found("mug", seen(2.0, y, 1)) for y in (0.29, 0.6, 0.12)]
    made = sorted(pairs(tracks, found, 1))

    def far(track: int, detection: int) -> float:
        return abs(float(tracks[track].sighting.position[1] - found[detection][1].position[1]))

    orders = [list(enumerate(order)) for order in permutations(range(3))]
    allowed = [order for order in orders if all(far(t, d) < GATE for t, d in order)]
    assert made == min(allowed, key=lambda order: sum(far(t, d) for t, d in order)) == [(0, 2), (1, 0), (2, 1)]


def test_a_pair_has_one_category_and_is_near() -> None:
    tracks = [Track("mug", seen(2.0, 0.0, 0))]
    assert pairs(tracks, [Found("bowl", seen(2.0, 0.0, 1))], 1) == []
    assert pairs(tracks, [Found("mug", seen(2.0, GATE + 0.01, 1))], 1) == []
    assert pairs(tracks, [Found("mug", seen(2.0, GATE - 0.01, 1))], 1) == [(0, 0)]


def test_of_furniture_any_part_may_be_seen() -> None:
    tracks = [Track("table", seen(2.0, 0.0, 0, radius=0.8))]
    assert pairs(tracks, [Found("table", seen(2.0, 1.0, 1))], 1) == [(0, 0)]
    assert pairs(tracks, [Found("table", seen(2.0, 1.2, 1))], 1) == []


def test_a_thing_whose_place_is_empty_may_have_drifted() -> None:
    """Another one at the same distance is another one as long as the first one's place was not seen empty."""
    for wall, same in ((4.0, True), (1.0, False)):
        tracker = Tracker()
        (first,) = tracker.update(view(4.0), 0, {0: Found("mug", seen(2.0, 0.0, 0))})[0].values()
        frames = 50
        moved = GATE + DRIFT * frames - 0.01
        (later,) = tracker.update(view(wall), frames, {0: Found("mug", seen(2.0, moved, frames))})[0].values()
        assert (later is first) is same
        if same:
            assert first.sighting.position[1] == pytest.approx(moved) and first.frames == 2 and first.empty == 0


def test_two_looks_in_one_frame_count_once() -> None:
    tracker = Tracker()
    for frame, frames in ((0, 1), (0, 1), (1, 2)):
        (track,) = tracker.update(view(), frame, {7: Found("mug", seen(2.0, 0.0, frame))})[0].values()
        assert track.frames == frames


def test_what_is_gone_is_given_up_but_not_what_is_hidden_or_held() -> None:
    tracker = Tracker()
    made, _ = tracker.update(view(), 0, {0: Found("mug", seen(2.0, 0.0, 0)), 1: Found("mug", seen(2.0, 1.0, 0))})
    gone, held = made[0], made[1]
    for frame, wall, lost in ((1, 1.0, []), (2, 4.0, []), (3, 1.0, []), (4, 4.0, [gone])):
        assert tracker.update(view(wall), frame, {}, [held])[1] == lost
    assert tracker.tracks == [held]


def test_furniture_is_not_given_up() -> None:
    tracker = Tracker()
    tracker.update(view(), 0, {0: Found("table", seen(2.0, 0.0, 0))})
    for frame in range(1, 9):
        assert tracker.update(view(4.0), frame, {})[1] == []
