"""Fires in two rooms: walls hold heat, time has passed since they were seen, and what was put out stays out."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from hazard_ms.agents.search.house_fire import HouseFire
from hazard_ms.sensing.sighting import Sighting
from hazard_ms.skills.decision import Decision
from tests.agents.search.test_floor_plan import two_rooms
from tests.worlds.playground import Playground

FLAME = (3.0, 2.0)  # [m], in the eastern room
THINGS = {"book_1": (3.5, 2.0), "book_2": (1.0, 2.0), "book_3": (5.0, 2.0)}  # the second is behind the wall


def burning(seen_at: int = 0, frame: int = 0, wall: bool = True) -> Decision:
    """What is known when FLAME was seen at `seen_at`, at the later `frame`; nothing else is warm."""
    ground = Playground(THINGS, dict.fromkeys(THINGS, 5.0))
    ground.map = two_rooms(tall=1.93 if wall else 0.1)
    ground.map.loose = np.ones(3, bool)
    y, x = np.nonzero(ground.map.explored)
    points = ground.map.centre_of(y, x)
    weight = (0.5 / np.maximum(np.hypot(*(points - FLAME).T), 0.5)) ** 2
    weight[points[:, 0] < 2.0] *= not wall
    ground.map.levels[0, y, x] = (20.0 + 600.0 * weight) / (1.0 + weight)
    ground.map.told_at[y, x] = seen_at
    for index, place in enumerate(THINGS.values()):
        row = Sighting(np.array([*place, 0.02], np.float32), 0.1, 0.04, seen_at, 50, (20.0,))
        ground.remember(index, row)
    return replace(ground.decision(), frame=frame, max_frames=3000)


def whole(decision: Decision) -> dict[int, float]:
    fire = HouseFire(0)
    fire.look(decision, 0)
    return fire.whole_until()


def test_walls_hold_heat() -> None:
    """A book 0.5 m from the flame burns soon; one 2 m away behind the wall never does, although it would without it."""
    behind, free = whole(burning()), whole(burning(wall=False))
    assert 50 < behind[0] < 500 and behind[0] < behind[2] < 2000
    assert behind[1] == math.inf and free[1] < 2000


def test_a_fire_that_was_seen_long_ago_has_gone_on() -> None:
    """What is foreseen does not move with the clock: it hangs on what was seen, and when."""
    early, late = whole(burning()), whole(burning(frame=300))
    assert late == early
    assert whole(burning(seen_at=300, frame=300))[0] == pytest.approx(early[0] + 300, abs=60)


def test_a_fire_is_found_where_it_is() -> None:
    fire = HouseFire(0)
    fire.look(burning(), 0)
    (seat,) = fire.seats
    assert np.hypot(seat.place[0] - FLAME[0], seat.place[1] - FLAME[1]) < 0.25 and 0.5 < seat.flames < 2.0


def test_without_its_only_fire_nothing_burns_and_what_was_put_out_is_out_until_it_is_seen_again() -> None:
    fire = HouseFire(0)
    fire.look(burning(), 0)
    assert set(fire.whole_until((0,)).values()) == {math.inf}
    fire.put_out(FLAME, 100)
    fire.look(burning(frame=120), 0)
    assert fire.seats == ()
    fire.look(burning(seen_at=150, frame=150), 0)
    assert len(fire.seats) == 1


def test_where_a_fire_was_put_out_the_warmth_of_its_room_is_old_but_not_that_of_others() -> None:
    """A flame 2 m from a fire that was put out was warmth of that, unless a wall stands between, or nothing burned."""
    put_out = {"same room": ((3.0, 0.0), True), "behind the wall": ((1.0, 2.0), True), "none": ((3.0, 0.0), False)}
    left = {}
    for name, (place, burned) in put_out.items():
        fire = HouseFire(0)
        fire.put_out(place, 100, burned)
        fire.look(burning(frame=120), 0)
        left[name] = len(fire.seats)
    assert left == {"same room": 0, "behind the wall": 1, "none": 1}


def test_a_fire_is_fought_from_where_it_is_in_sight() -> None:
    """From the western room the way leads to the doorway, not to the wall, from which it is nearer to the flame."""
    fire, free = HouseFire(0), HouseFire(0)
    fire.look(burning(), 0)
    free.look(burning(wall=False), 0)
    behind, beside = (h.stand(h.seats[0], (0.5, 2.0), 2.5) for h in (fire, free))
    assert behind is not None and beside is not None
    assert beside[0] < 1.0 and abs(beside[1] - 2.0) < 0.5
    assert behind[0] > 1.9 and np.hypot(behind[0] - FLAME[0], behind[1] - FLAME[1]) <= 2.5
