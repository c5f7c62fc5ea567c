"""Which doors planner shuts on water in two rooms, and which it leaves open."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from hazard_ms.agents.search.candidates import candidates
from hazard_ms.agents.search.lookouts import Lookout
from hazard_ms.agents.search.memory import Memory
from hazard_ms.agents.search.outlook import Weights, outlook
from hazard_ms.skills.decision import Action, Decision
from tests.agents.search.test_floor_plan import DOOR
from tests.agents.search.test_house_water import SLOPE, WEST
from tests.agents.search.test_mitigating import NAMES, begun, decision, home, with_more_in_the_west

SHUT = Action("shut", DOOR.name)


def wet(frame: int = 560) -> Decision:
    """Water from the west wall, which rises by 1 cm in 60 frames, has come to x = 1.3 m; the door is at x = 2 m."""
    given = decision(frame=frame)
    seen = given.map
    y, x = np.nonzero(seen.explored)
    way = seen.centre_of(y, x)[:, 0] - WEST
    seen.levels[0, y, x] = np.maximum(0.01 / 60 * frame - SLOPE * way, 0.0)
    return replace(given, available=(*given.available, SHUT), tools=())


def test_it_shuts_the_door_on_water() -> None:
    """The books are soaked from frame 1,100 on: there is time to rescue one or two of them, or to shut the door."""
    told = home("HazardHouseFlood-v1")
    player = begun("planner", told)
    assert player.act(wet()) == SHUT and "shut door_0" in str(player.note)
    assert begun("planner:mitigate=false", told).act(wet()) != SHUT


def test_it_does_not_shut_a_door_for_what_is_in_no_danger_or_too_late() -> None:
    told = home("HazardHouseFlood-v1")
    dry = wet()
    dry.map.levels[0] = np.where(np.isfinite(dry.map.levels[0]), 0.0, np.nan)
    for given in (dry, wet(2000)):
        assert begun("planner", told).act(given) != SHUT


def test_it_does_not_shut_a_door_for_a_fiftieth_of_what_it_would_lose() -> None:
    """With six books for 200 each on this side of the door it averts 607 instead of 593, if all goes as planned."""
    given = with_more_in_the_west(wet())
    dear = tuple(replace(target, value=200.0) if target.index > len(NAMES) else target for target in given.targets)
    dry = {index: replace(sighting, levels=(0.0,)) for index, sighting in given.map.objects.items()}
    given.map.objects = dry
    assert begun("planner", home("HazardHouseFlood-v1")).act(replace(given, targets=dear)) != SHUT


def test_what_can_no_longer_be_searched_behind_a_shut_door_counts() -> None:
    """All books are in the eastern room: with the door, two of three places to search are shut off, too."""
    told, given = home("HazardHouseFlood-v1"), wet()
    memory = Memory(0)
    memory.looks.append((0.0, 0.0))
    ahead = outlook(told, given, memory, Weights(), 3)
    marks = (
        Lookout("doorway_1", (5.0, 0.0), 0.3),
        Lookout("box_1", (-1.0, 0.0), 0.3),
        Lookout(DOOR.name, (2.0, 0.0), 0.3),
    )
    found = candidates(told, given, memory, replace(ahead, lookouts=marks), {})
    assert [one.closes for one in found if one.action == SHUT] == [(0, 1, 2, 3, 5)]
