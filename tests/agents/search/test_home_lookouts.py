"""Where planner and mcts search a home: from doorways, on floor that was not seen, and while fires leave something."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hazard_ms.agents.search.forecast import HALF_BURNT, RISK
from hazard_ms.agents.search.lookouts import HOME, LOOKED, PASSED, Lookout, lookouts, unseen_floor
from hazard_ms.agents.search.memory import Memory
from hazard_ms.agents.search.outlook import Outlook, Weights, outlook
from hazard_ms.skills.decision import EXPLORE, WALK_TO, Action, Decision, Result
from hazard_ms.skills.failures import MAX_FRAMES, NO_PATH
from tests.agents.search.test_fire_lookouts import west
from tests.agents.search.test_floor_plan import DOOR
from tests.agents.search.test_mitigating import NAMES, begun, decision, home

CELL = 0.1  # [m]
FOUND_WHOLE = 0.8  # of its value that a target counts that must be found first


def found(given: Decision, looks: tuple = (), doors: bool = True) -> dict[str, Lookout]:
    return {mark.name: mark for mark in lookouts(given, {}, looks, [], 0.3, doors=doors)}


def test_an_unseen_room_is_searched_from_its_doorway() -> None:
    """The doorway shows all that is believed to lie behind it: its share of what of 87 m2 was not seen."""
    given = west()
    behind = unseen_floor(given.map).sum() * CELL**2
    left = HOME - given.map.explored.sum() * CELL**2
    marks = found(given)
    assert next(iter(marks)) == DOOR.name and marks[DOOR.name].place == DOOR.position[:2]
    seen = PASSED * given.map.explored.sum() * CELL**2
    assert behind / (left + seen) < marks[DOOR.name].share < (behind + seen) / (left + seen)
    assert behind > 4.0  # m2, so that the test tells
    assert DOOR.name not in found(given, doors=False)
    for shut in (replace(DOOR, open=0.0), replace(DOOR, kind="window")):
        assert DOOR.name not in found(replace(given, openings=(shut,)))


EVERYWHERE = tuple((float(x), float(y)) for x in (-3, -1, 1, 3, 5) for y in (-2, 0, 2))


@pytest.mark.parametrize(("looks", "share"), [((), PASSED), (EVERYWHERE, LOOKED)])
def test_floor_that_was_seen_hides_little(looks: tuple, share: float) -> None:
    """Both rooms are known and the rest of 87 m2 is not: to search them again promises their share of what is left."""
    given = decision()
    beyond = unseen_floor(given.map).sum() * CELL**2
    area = (given.map.explored & (given.map.height < 0.2)).sum() * CELL**2
    left = share * area + HOME - given.map.explored.sum() * CELL**2
    shares = [mark.share for mark in found(given, looks).values()]
    assert sum(shares) <= 1.05 * (share * area + beyond) / left
    assert looks or sum(shares) > 0.5 * share * area / left
    assert beyond < 2.0  # m2: hardly any


def believed(hazard: str = "fire") -> Outlook:
    """What lies ahead in the western room of a home with a `hazard`; three books of 10 were not seen."""
    given = west()
    assert [target.value for target in given.targets] == [10.0] * 3
    given.map.objects = {k: row for k, row in given.map.objects.items() if k < 2}
    told = home()
    told = replace(told, hazards=tuple(replace(each, name=hazard) for each in told.hazards))
    return outlook(told, given, Memory(0), Weights(), give_up=4)


def test_what_is_searched_for_averts_something_until_half_of_it_has_burned() -> None:
    """Of what is expected behind the door RISK is lost to fires: saved by then it counts, and a tenth after."""
    ahead = believed()
    goal = [ahead.name(k) for k in range(len(ahead.problem.values))].index(DOOR.name)
    aimed, plain = ahead.problem, ahead.plain
    assert aimed.damaged_at[goal] == HALF_BURNT and np.isinf(plain.damaged_at[goal])
    share = {mark.name: mark.share for mark in ahead.lookouts}[DOOR.name]
    whole = 2.0 * RISK["fire"] * FOUND_WHOLE * 30.0 * share  # what is damaged has lost half
    assert aimed.values[goal] == pytest.approx(whole * (0.5 + 0.1), rel=0.01)
    assert aimed.shares is not None and aimed.shares[goal] * aimed.values[goal] == pytest.approx(0.05 * whole, rel=0.01)


def test_what_floats_is_saved_whenever_it_is_found() -> None:
    """Water carries off RISK of what was not seen by the end; until then it is whole, and its rescue averts it all."""
    ahead = believed("flood")
    goal = [ahead.name(k) for k in range(len(ahead.problem.values))].index(DOOR.name)
    aimed, gone = ahead.problem, ahead.problem.gone_at
    assert np.isinf(aimed.damaged_at[goal]) and gone is not None and gone[goal] < aimed.limit <= gone[goal] + 1.0
    share = {mark.name: mark.share for mark in ahead.lookouts}[DOOR.name]
    assert aimed.values[goal] == pytest.approx(RISK["flood"] * FOUND_WHOLE * 30.0 * share * (1.0 + 0.1), rel=0.01)


def test_where_nothing_is_to_be_found_it_looks_where_no_way_led() -> None:
    """All floor is known: what is nearest to a place to which no way led comes first, else what is at hand."""
    here, there = (lookouts(decision(), {}, [*EVERYWHERE] * 3, [], 0.3, barred=at) for at in ((), ((5.2, -1.2),)))
    assert (here[0].name, there[0].name) == (NAMES[1], "book_3")


def test_ways_are_tried_again_after_a_look_at_what_barred_them() -> None:
    """No way led to the first book, and none of the three was seen since: it goes to the nearest thing to there."""
    player, walk = begun("planner", home()), Action(WALK_TO, "book_1")
    memory = player._memory  # type: ignore[attr-defined]
    memory.looks += [*EVERYWHERE] * 3
    memory.barred["book_1"], memory.failures["book_1"] = (5.0, 1.0), 1
    given = replace(decision((walk, Result(False, NO_PATH))), tools=())
    given.map.objects = {k: row for k, row in given.map.objects.items() if k < 2}
    assert player.act(given) == Action(WALK_TO, "box_1") and "what barred the way to book_1" in str(player.note)
    assert not memory.barred and not memory.failures


@pytest.mark.parametrize("reason", [NO_PATH, MAX_FRAMES])
def test_it_notes_where_barred_ways_end(reason: str) -> None:
    """Of two rooms without anything in the doorway between them the way past walls leads all the way to the book."""
    player, walk = begun("planner", home()), Action(WALK_TO, "book_1")
    player.act(decision((walk, Result(False, reason))))
    barred = player._memory.barred  # type: ignore[attr-defined]
    assert [*barred] == (["book_1"] if reason == NO_PATH else [])
    assert all(np.hypot(*np.subtract(place, (5.0, 1.0))) < 0.2 for place in barred.values())


def test_where_nothing_tells_what_a_hazard_takes_a_search_still_counts_a_tenth() -> None:
    ahead = believed("ash")
    goal = [ahead.name(k) for k in range(len(ahead.problem.values))].index(DOOR.name)
    assert ahead.problem.values[goal] == pytest.approx(0.1 * ahead.plain.values[goal])
    assert ahead.problem.values[goal] > 0.0


def test_a_planner_goes_into_the_doorway_and_looks_around_there() -> None:
    """It holds nothing, and knows of no extinguisher."""
    player, told = begun("planner", home()), home()
    assert told.several_rooms
    given = replace(west(), tools=())
    walk = Action(WALK_TO, DOOR.name)
    assert player.act(given) == walk, player.note
    there = replace(given, last_action=walk, last_result=Result(True, frames=100), agent_position=DOOR.position[:2])
    assert player.act(there) == Action(EXPLORE)
    assert "look around" in str(player.note)
