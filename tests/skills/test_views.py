"""Places from which something is in view: where the hand is there, and past which edges of walls it looks."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hazard_ms.skills.mitigations import views
from hazard_ms.skills.mitigations.views import facing, nearest_view, sees
from tests.worlds.two_rooms import AT, DOOR, spec, two_rooms

HELD = np.array([0.2, -0.1, 0.8])  # ahead, to the left, over the floor [m]


def test_the_hand_turns_with_the_robot() -> None:
    """It is 0.1 m to the right of who looks east, so south of it; of who looks north, so east of it."""
    here = np.array([[1.0, 2.0]])
    np.testing.assert_allclose(facing(here, np.array([5.0, 2.0, 0.0]), HELD), [[1.2, 1.9, 0.8]])
    np.testing.assert_allclose(facing(here, np.array([1.0, 3.0, 0.0]), HELD), [[1.1, 2.2, 0.8]])


def test_a_place_has_a_view_through_a_door_only_past_both_of_its_sides() -> None:
    """The door is open from y = 1.55 to 2.45 m, and the aim in its middle: a metre behind the wall.

    From 2 m before the wall, straight lines to the aim cross it at a third of their distance from the middle: from
    1.35 m off it they touch a jamb, and with the margin from 1.25 m.
    """
    aim = np.array([AT + 1.0, 2.0, 0.0])
    middle = np.array([0.0, 0.0, 0.8])
    with two_rooms(spec(door=replace(DOOR, open=1.0))) as rooms:
        places = np.array([[AT - 2.0, 2.0 + off] for off in (0.0, 1.0, 1.3, 1.6)])
        assert sees(rooms.stage, places, aim, middle).tolist() == [True, True, False, False]
        aside = middle + (0.0, 0.4, 0.0)  # from beside the northern jamb it looks into the wall
        assert sees(rooms.stage, np.array([[AT - 0.5, 2.0], [AT - 0.3, 2.3]]), aim, aside).tolist() == [True, False]


def test_the_place_with_the_shortest_way_is_on_the_side_from_which_the_robot_comes() -> None:
    """The robot stands at (1.5, 2). Around (2.5, 3.2), 1 m away, the nearest place lies towards it."""
    aim = np.array([2.5, 3.2, 0.0])
    with two_rooms(spec(door=replace(DOOR, open=1.0))) as rooms:
        place = nearest_view(rooms.stage, aim, (1.0,), HELD)
        assert place is not None
        assert np.hypot(*np.subtract(place, aim[:2])) == pytest.approx(1.0)
        assert np.hypot(*np.subtract(place, (1.5, 2.0))) < np.hypot(1.0, 1.2) - 1.0 + 0.2
        other = nearest_view(rooms.stage, aim, (1.0,), HELD, {place})
        assert other is not None and other != place


def test_places_are_on_floor_that_was_seen_and_there_are_none_without_it() -> None:
    """Beyond a shut door the way leads round the house, over what was never seen, but no place is there."""
    aim = np.array([AT + 2.0, 1.0, 0.0])
    with two_rooms(spec()) as rooms:
        place = nearest_view(rooms.stage, aim, (1.0, 2.4), HELD)
        assert place is not None and AT < place[0] < 7.0 and 0.0 < place[1] < 4.0
        x, _ = np.meshgrid(np.arange(rooms.stage.seen.explored.shape[1]), np.arange(len(rooms.stage.seen.explored)))
        rooms.stage.seen.explored &= rooms.stage.seen.origin[0] + (x + 0.5) * rooms.stage.seen.cell < AT
        assert nearest_view(rooms.stage, aim, (1.0, 2.4), HELD) is None


def test_margins_are_narrower_than_doors() -> None:
    assert 2.0 * views.MARGIN < DOOR.width
