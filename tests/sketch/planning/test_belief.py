"""Beliefs against worlds of which the law is known: straight drift, a plane of water, lines, and the onset of harm."""

from __future__ import annotations

import math

import numpy as np
import pytest

from hazard_ms.sketch.planning.belief import (
    CAP,
    LONGEST_DRIFT,
    RISE,
    WaterPlane,
    drifted,
    extended,
    last_whole,
    speed_of,
)


def test_a_thing_drifts_on_as_it_was_seen_to() -> None:
    """0.5 m in 100 frames, 40 frames later: 0.2 m further."""
    place = drifted([0, 100], [(1.0, 2.0), (1.3, 2.4)], fastest=1.0, at=140)
    assert place == pytest.approx([1.42, 2.56])


def test_a_thing_at_rest_is_believed_to_stay() -> None:
    """It seems to move by 0.1 m, which is the error of a position."""
    assert drifted([0, 100], [(1.0, 2.0), (1.1, 2.0)], fastest=1.0, at=900) == pytest.approx([1.1, 2.0])
    assert drifted([50], [(1.0, 2.0)], fastest=1.0, at=900) == pytest.approx([1.0, 2.0])


def test_sightings_in_quick_succession_tell_no_speed() -> None:
    """Those 5 frames apart are passed over for an older one: 0.6 m in 105 frames."""
    velocity = speed_of([0, 100, 105], [(0.0, 0.0), (0.5, 0.0), (0.6, 0.0)])
    assert velocity == pytest.approx([0.6 / 105, 0.0])


def test_no_drift_is_faster_than_what_was_seen_or_lasts_for_ever() -> None:
    """2 m in 100 frames, where nothing was seen to exceed 0.01 m a frame: 0.015 m a frame, for LONGEST_DRIFT."""
    sightings = ([0, 100], [(0.0, 0.0), (2.0, 0.0)])
    assert drifted(*sightings, fastest=0.01, at=110) == pytest.approx([2.15, 0.0])
    assert drifted(*sightings, fastest=0.01, at=9000) == pytest.approx([2.0 + 0.015 * LONGEST_DRIFT, 0.0])
    assert drifted(*sightings, fastest=0.01, at=50) == pytest.approx([2.0, 0.0])


def rising(x: np.ndarray, y: np.ndarray, frame: np.ndarray) -> np.ndarray:
    """The water of the challenge, from the wall at x = 0: 0.001 m a frame, 3 degrees of slope, dry at 0 [m]."""
    return np.maximum(0.001 * frame - math.tan(math.radians(3.0)) * x, 0.0)


def test_the_water_is_found_from_what_stands_in_it() -> None:
    """40 sightings, a third of them dry: levels anywhere at any later time are right within 0.03 m."""
    draw = np.random.default_rng(1)
    x, y, frame = draw.uniform(0, 8, 40), draw.uniform(0, 6, 40), draw.uniform(100, 500, 40)
    seen = rising(x, y, frame)
    assert 5 < (seen == 0).sum() < 35
    water = WaterPlane.fitted(np.column_stack([x, y]), frame, seen + draw.normal(0, 0.005, 40) * (seen > 0))
    assert water.rise == pytest.approx(0.001, rel=0.05)
    later = np.array([600.0, 900.0, 1200.0])
    places = draw.uniform(0, 8, (20, 2))
    truth = rising(places[None, :, 0], places[None, :, 1], later[:, None])
    assert np.abs(water.at(places, later) - truth).max() < 0.03


def test_before_any_water_was_seen_it_is_believed_to_rise_everywhere() -> None:
    dry = WaterPlane.fitted([(1.0, 1.0), (4.0, 2.0)], [100, 100], [0.0, 0.0])
    assert dry.rise == pytest.approx(RISE)
    assert dry.at([(3.0, 3.0)], [0.0, 500.0, 1e5])[:, 0] == pytest.approx([0.0, 0.5, CAP])
    assert WaterPlane.fitted([], [], []) == dry


def test_one_sighting_of_water_moves_the_level_and_little_else() -> None:
    """0.3 m at frame 200, where 0.2 m were believed: the level comes up there, and neither slope nor rise runs wild."""
    water = WaterPlane.fitted([(2.0, 0.0)], [200], [0.3])
    assert water.at([(2.0, 0.0)], [200.0])[0, 0] == pytest.approx(0.3, abs=0.02)
    assert abs(water.slope[0]) < 0.06 and abs(water.rise - RISE) < 0.0005


def test_levels_go_on_along_the_line_through_the_last_two() -> None:
    assert extended([0, 10, 20], [7.0, 1.0, 2.0], [20, 30, 50]) == pytest.approx([2.0, 3.0, 5.0])
    assert extended([20], [2.0], [20, 90]) == pytest.approx([2.0, 2.0])
    assert extended([20, 20], [1.0, 2.0], [90]) == pytest.approx([2.0]), "two sightings in one frame tell no slope"


def test_harm_begins_with_the_first_frame_that_harms() -> None:
    """Harmed from 3 on; what falls below later was harmed all the same."""
    frames, levels = [0, 10, 20, 30], [1.0, 2.0, 3.0, 1.0]
    assert last_whole(lambda level: level >= 3, frames, levels) == 10
    assert last_whole(lambda level: level >= 1, frames, levels) == 0
    assert last_whole(lambda level: level > 9, frames, levels) == math.inf
