"""Tracks of things that have moved away: looks that plainly show their places, and not the things."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hazard_ms.sensing.detection.track import Found
from hazard_ms.sensing.detection.tracks import PLAIN, Tracker
from hazard_ms.sensing.view import View
from tests.sensing.detection.test_confusion import TABLE
from tests.sensing.detection.test_tracks import seen
from tests.worlds.wall import view

SURE = replace(TABLE, found=(0.5, 0.95), clutter={"mug": 1e-3})  # finds nearly all things of 100 pixels or more
FAR = Found("mug", replace(seen(2.0, 0.0, 0), pixels=100))


def ahead(way: float, depth: float = 0.1) -> View:
    """A wall `depth` behind the place 2 m ahead of where the camera was, seen from so much farther on [m]."""
    made = view(2.0 + depth - way)
    pose = made.cam2world.copy()
    pose[0, 3] = way
    return replace(made, cam2world=pose)


def tracker(found: Found = FAR) -> Tracker:
    made = Tracker(SURE)
    made.update(view(2.1), 0, {0: found})
    return made


def test_two_looks_from_two_places_that_should_show_it_are_enough() -> None:
    made = tracker()
    (track,) = made.tracks
    assert made.update(ahead(0.5), 1, {})[1] == [] and track.empty == 1
    assert made.update(ahead(1.0), 2, {})[1] == [track] and made.tracks == []


@pytest.mark.parametrize(
    ("looks", "why"),
    [
        ([ahead(0.5), ahead(0.6), ahead(0.9)], "looks from about one place err alike"),
        ([ahead(0.5, -0.1), ahead(1.0, -0.1)], "something is before it"),
    ],
)
def test_other_looks_tell_too_little(looks: list[View], why: str) -> None:
    made = tracker()
    for frame, look in enumerate(looks, start=1):
        assert made.update(look, frame, {})[1] == [], why


def test_what_a_look_may_well_overlook_is_not_given_up() -> None:
    """Of few pixels, half are found; 30 pixels at 2 m are 53 at 1.5 m and 120 at 1 m."""
    assert SURE.found[0] < PLAIN <= SURE.found[1]
    made = tracker(Found("mug", replace(seen(2.0, 0.0, 0), pixels=30)))
    assert made.update(ahead(0.5), 1, {})[1] == [] and made.tracks[0].empty == 0
    assert made.update(ahead(1.0), 2, {})[1] == [] and made.tracks[0].empty == 1


def test_once_it_is_seen_again_older_looks_do_not_count() -> None:
    made = tracker()
    (track,) = made.tracks
    made.update(ahead(0.5), 1, {})
    made.update(ahead(0.5), 2, {0: Found("mug", replace(seen(2.0, 0.0, 2), pixels=200))})
    assert made.update(ahead(0.5), 3, {})[1] == [] and made.tracks == [track] and track.empty == 1


def test_what_is_safe_stays_and_carts_do_not_move() -> None:
    made = tracker()
    made.tracks[0].rescued = True
    table = replace(SURE, classes=("cart", "mug", "bowl"))
    other = Tracker(table)
    other.update(view(2.1), 0, {0: Found("cart", replace(seen(2.0, 0.0, 0), pixels=200))})
    for each in (made, other):
        for frame, way in ((1, 0.4), (2, 0.8), (3, 1.2)):
            assert each.update(ahead(way), frame, {})[1] == []


def test_it_may_have_gone_as_far_as_a_robot_walks_since() -> None:
    """0.016 m a frame beyond 0.3 m, once a look has missed it; else 0.004 m a frame."""
    made = tracker()
    made.update(ahead(0.5), 50, {})
    gone = Found("mug", replace(seen(2.0, 0.9, 51), pixels=100))
    assert np.linalg.norm(gone.sighting.position - FAR.sighting.position) > 0.3 + 0.004 * 51
    matched, _ = made.update(replace(view(9.0)), 51, {0: gone})
    assert matched == {0: made.tracks[0]}
