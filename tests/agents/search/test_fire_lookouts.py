"""Where fires may burn that nobody saw: in rooms behind doorways, not near floor that is cold, one in a room."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from hazard_ms.agents.search.lookouts import HERE, Lookout, fire_lookouts
from hazard_ms.skills.decision import Decision
from tests.agents.search.test_floor_plan import DOOR
from tests.agents.search.test_mitigating import decision

CORNER = (-3.0, 2.5)  # of the western room, from which nothing of the eastern one is in sight [m]


def west() -> Decision:
    """The western room as one sees it who never came near the door: nothing is known of the eastern one."""
    given = decision()
    seen = given.map
    y, x = np.nonzero(seen.explored)
    seen.explored[y, x] &= seen.centre_of(y, x)[:, 0] < 2.1
    seen.objects = {index: row for index, row in seen.objects.items() if row.position[0] < 2.0}
    return replace(given, agent_position=CORNER)


def found(given: Decision, looks: Sequence = (), fires: Sequence = (), visits: Sequence = ()) -> dict[str, Lookout]:
    made = fire_lookouts(given, dict.fromkeys(visits, 1), looks, [], 0.3, fires)
    return {mark.name: mark for mark in made}


def test_an_unseen_room_is_looked_into_from_its_doorway() -> None:
    """Of 3.7 m squared behind the door a circle of 1.2 m around it is cold; 51 of 87 m2 were not seen: 0.22 of all."""
    marks = found(west())
    assert next(iter(marks)) == DOOR.name and HERE not in marks
    assert marks[DOOR.name].share == pytest.approx((3.7**2 - 0.5 * np.pi * 1.2**2) / 51, abs=0.03)
    assert marks[DOOR.name].place == DOOR.position[:2]


def test_a_shut_door_a_window_and_one_that_was_looked_through_are_no_places_to_look_from() -> None:
    for door in (replace(DOOR, open=0.0), replace(DOOR, kind="window")):
        assert DOOR.name not in found(replace(west(), openings=(door,)))
    assert DOOR.name not in found(west(), visits=[DOOR.name])


@pytest.mark.parametrize("what", ["looks", "fires"])
def test_a_look_in_vain_and_a_fire_leave_little_hope_around_them(what: str) -> None:
    """Within 3 m of (3.5, 0) there is all of the square: a tenth of its share is left."""
    before, after = found(west())[DOOR.name].share, found(west(), **{what: [(3.7, 0.0)]})
    assert after[DOOR.name].share == pytest.approx(0.1 * before, rel=0.2)


def test_where_all_floor_is_cold_there_is_nothing_to_look_for() -> None:
    assert not found(decision())
