"""The memory of one thing: which of two views counts, and how much of the past is kept."""

from __future__ import annotations

import numpy as np
import pytest

from hazard_ms.sensing.sighting import REMEMBERED, Sighting, merged


def seen(x: float, pixels: int, frame: int, level: float = 20.0) -> Sighting:
    place = np.array([x, 0.0, 0.5], np.float32)
    return Sighting(place, 0.2, 0.6, frame, pixels, (level,), history=((frame, (level,)),))


def test_a_glimpse_does_not_replace_a_good_view_but_its_frame_and_levels_count() -> None:
    after = merged(seen(1.0, 1000, 1), seen(1.15, 10, 2, level=90.0))
    assert float(after.position[0]) == pytest.approx(1.0) and after.pixels == 1000
    assert after.frame == 2 and after.levels == (90.0,)


def test_a_view_that_is_about_as_good_replaces_an_older_one() -> None:
    after = merged(seen(1.0, 1000, 1), seen(1.15, 600, 2))
    assert float(after.position[0]) == pytest.approx(1.15) and after.pixels == 600


def test_what_has_moved_is_where_it_was_seen_last_however_badly() -> None:
    after = merged(seen(1.0, 1000, 1), seen(1.5, 10, 2))
    assert float(after.position[0]) == pytest.approx(1.5) and after.pixels == 10


def test_the_newest_levels_are_kept_and_no_more_than_a_fixed_number() -> None:
    memory = None
    for frame in range(2 * REMEMBERED):
        memory = merged(memory, seen(1.0, 100, frame, level=float(frame)))
    assert memory is not None and len(memory.history) == REMEMBERED
    assert memory.history[-1] == (2 * REMEMBERED - 1, (2.0 * REMEMBERED - 1,))
    assert [frame for frame, _ in memory.history] == list(range(REMEMBERED, 2 * REMEMBERED))
