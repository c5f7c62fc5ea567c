"""Agents whose skills fail where they stand: they go on from elsewhere after a few failures, of any skill."""

from __future__ import annotations

from dataclasses import dataclass, replace
from unittest.mock import patch

import pytest

from hazard_ms.agents.attempts import FEW, MANY, Enclosure, Repeats
from hazard_ms.agents.base import agent
from hazard_ms.agents.search.memory import Memory
from hazard_ms.agents.search.searcher import MOST_WAITS
from hazard_ms.skills.decision import DROP, EXPLORE, STOP, WALK_ONE_STEP, WALK_TO, Action, Decision, Result
from hazard_ms.skills.failures import BLOCKED, MAX_FRAMES, NO_PATH
from tests.worlds import playground
from tests.worlds.playground import Playground, play

SHUT = Action("shut", "door_0")  # its target is no thing of the map
JAM = 1.0  # distance from the origin within which nothing can be let go [m]


@dataclass
class Jammed(Playground):
    """A playground in which what is in the hand cannot be let go near the origin, where something jams the arm."""

    blocked: int = 0  # drops that failed

    def _drop(self, cart: str | None) -> Result:
        if self.at[0] ** 2 + self.at[1] ** 2 < JAM**2:
            self.blocked += 1
            return Result(False, BLOCKED, 100)
        return super()._drop(cart)


@pytest.mark.parametrize("who", ["greedy", "rule", "planner", "mcts:simulations=50"])
@pytest.mark.parametrize(("verbs", "most"), [(("open",), FEW), ((), MANY)], ids=["mitigations", "published"])
def test_a_hand_that_cannot_let_go_here_lets_go_elsewhere(who: str, verbs: tuple[str, ...], most: int) -> None:
    """The target lies at hand, so the pick-up and the first drops are where the arm is jammed."""
    ground = Jammed({"a": (0.4, 0.0), "lamp": (2.8, 0.0)}, {"a": 5.0})
    told = replace(playground.brief(), mitigations=verbs)
    with patch.object(playground, "brief", lambda seed=0: told):
        taken = play(agent(who), ground, most=40)
    assert ground.rescued == {"a"} and ground.blocked == most
    begun = [str(action) for action in taken]
    first = begun.index("drop")
    assert begun[first : first + most + 1] == ["drop"] * most + ["walk_one_step lamp"]


def looked(**carts: tuple[float, float]) -> Playground:
    places = {"a": (0.5, 0.0), "beside": (-0.3, 0.9), "near": (1.5, 0.0), "far": (0.0, 2.5), **carts}
    ground = Playground(places, {"a": 1.0}, carts=tuple(carts), held="a")
    ground.look()
    return ground


def asked(repeats: Repeats, ground: Playground, last: Action, ok: bool, wish: Action, reason: str = BLOCKED) -> str:
    """What is done instead of `wish` after `last`; the wish where it is done."""
    decision: Decision = replace(ground.decision(), last_action=last, last_result=Result(ok, "" if ok else reason, 9))
    return str(repeats.instead(decision, wish) or wish)


def test_it_goes_towards_the_nearest_thing_that_is_not_at_hand_and_another_each_time() -> None:
    ground, repeats, drop = looked(), Repeats(True), Action(DROP)
    assert asked(repeats, ground, Action(EXPLORE), True, drop) == "drop"
    assert asked(repeats, ground, drop, False, drop) == "drop"
    walk = asked(repeats, ground, drop, False, drop)
    assert walk == "walk_one_step near" and repeats.note == "drop failed 2 times from here: go on from elsewhere"
    blocked = Action(WALK_ONE_STEP, "near")
    assert asked(repeats, ground, blocked, False, drop) == "walk_one_step far"
    assert asked(repeats, ground, Action(WALK_ONE_STEP, "far"), False, drop) == "explore"
    assert asked(repeats, ground, Action(EXPLORE), True, drop) == "walk_one_step near", "from the beginning again"


def test_from_elsewhere_an_action_is_as_good_as_new_and_so_it_is_once_it_worked() -> None:
    ground, repeats, drop = looked(), Repeats(True), Action(DROP)
    for _ in range(3):
        asked(repeats, ground, drop, False, drop)
    ground.at, walk = (0.0, 0.6), Action(WALK_ONE_STEP, "near")
    for last, said in ((walk, "drop"), (drop, "drop"), (drop, "walk_one_step far")):
        assert asked(repeats, ground, last, False, drop) == said
    repeats = Repeats(True)
    for ok in (False, False, True, False):
        said = asked(repeats, ground, drop, ok, drop)
    assert said == "drop"


def test_what_belongs_in_a_cart_goes_to_another_one() -> None:
    ground = looked(cart_1=(-0.8, 0.0), cart_2=(-2.0, 0.0))
    repeats, drop = Repeats(True), Action(DROP, "cart_1")
    for _ in range(3):
        said = asked(repeats, ground, drop, False, drop)
    assert said == str(Action(WALK_TO, "cart_2"))


@pytest.mark.parametrize(
    ("reason", "moved", "said"),
    [(BLOCKED, 0.0, "walk_one_step near"), (MAX_FRAMES, 0.0, "walk_one_step near"), (MAX_FRAMES, 0.3, "shut door_0")],
)
def test_a_door_that_does_not_shut_has_failed_unless_it_was_still_on_its_way(
    reason: str, moved: float, said: str
) -> None:
    ground, repeats = looked(), Repeats(True)
    repeats.instead(ground.decision(), SHUT)
    for _ in range(2):
        x, y = ground.at
        ground.at = (x, y + moved)
        found = asked(repeats, ground, SHUT, False, SHUT, reason)
    assert found == said


def test_the_memory_counts_what_ended_unfinished_where_it_began() -> None:
    ground, memory = looked(), Memory(0)
    for place, failures in (((0.0, 0.3), 0), ((0.0, 0.1), 1)):
        memory.chose(ground.decision(), SHUT)
        last = {"last_action": SHUT, "last_result": Result(False, MAX_FRAMES, 100)}
        memory.note(replace(ground.decision(), agent_position=place, **last))
        assert memory.failures.get("shut door_0", 0) == failures


@dataclass
class Barred(Playground):
    """A playground in which no way leads anywhere until a frame: what the robot ran into seems to be around it."""

    until: int = 300

    def _walk(self, name: str) -> Result:
        return Result(False, NO_PATH, 0) if self.frame < self.until else super()._walk(name)


THREE = {"a": (2.0, 0.0), "b": (0.0, 2.0), "c": (-2.0, 0.0)}


@pytest.mark.parametrize("who", ["planner", "mcts:simulations=50"])
def test_who_cannot_get_away_does_not_give_up_what_it_cannot_get_to(who: str) -> None:
    ground = Barred(dict(THREE), {"a": 5.0, "b": 5.0, "c": 5.0})
    taken = play(agent(who), ground, most=60)
    assert ground.rescued == {"a", "b", "c"}
    assert 3 <= sum(action.verb == EXPLORE for action in taken) <= 6  # of 60 frames each, and the first


def test_it_waits_so_long_only_once() -> None:
    """Where no way leads anywhere for good, it ends."""
    ground = Barred(dict(THREE), {"a": 5.0, "b": 5.0, "c": 5.0}, until=10_000)
    taken = play(agent("planner"), ground, most=80)
    assert taken[-1].verb == STOP and sum(action.verb == EXPLORE for action in taken) <= 1 + MOST_WAITS + 2


def test_enclosed_is_who_has_no_way_to_one_thing_after_another() -> None:
    ground = looked()
    walk = {name: Action(WALK_TO, name) for name in ("beside", "near")}

    def told(made: Enclosure, last: Action, reason: str, frames: int) -> dict[str, int]:
        return made.noticed(replace(ground.decision(), last_action=last, last_result=Result(False, reason, frames)))

    made = Enclosure()
    assert told(made, walk["near"], NO_PATH, 0) == {} == told(made, walk["near"], NO_PATH, 1)  # it may be walled in
    assert told(made, walk["beside"], NO_PATH, 0) == {"near": 2, "beside": 1}
    assert told(made, walk["near"], NO_PATH, 0) == {} == told(made, walk["beside"], NO_PATH, 40)  # it came away
    assert told(made, walk["beside"], NO_PATH, 0) == {} == told(made, walk["near"], BLOCKED, 0)
