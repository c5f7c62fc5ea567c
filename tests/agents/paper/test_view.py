"""What the paper's agents can choose from and what it costs, by hand from the description of its code."""

from __future__ import annotations

from dataclasses import replace

import pytest

from hazard_ms.agents.paper.memory import Memory
from hazard_ms.agents.paper.view import EXPLORE_COST, HERE, LOOK, Option, View, walk_cost
from hazard_ms.skills.decision import DROP, EXPLORE, PICK_UP, STOP, WALK_TO, Action, Result
from tests.worlds.playground import Playground, brief

ARRIVED, FAILED = Result(True, frames=60), Result(False, "max_frames", 100)
PLACES = {"a": (2.0, 0.0), "table": (0.0, 1.0), "b": (0.0, -4.0), "cart": (-6.0, 0.0), "trolley": (0.0, 8.0)}


def ground(carts: tuple[str, ...] = (), sight: float = 9.0) -> Playground:
    made = Playground(dict(PLACES), {"a": 1.0, "b": 5.0}, carts=carts, sight=sight)
    made.look()
    return made


def listed(memory: Memory, at: Playground) -> dict[str, float]:
    """The options at the next decision, as text, with their costs."""
    view = memory.view(at.decision())
    return {str(memory.action(view, option)): option.cost for option in memory.choices(view)}


def offered(at: Playground, last: Action | None = None, result: Result | None = None) -> dict[str, float]:
    """The options of an agent that chose `last` for nothing and sees how it ended."""
    at.last = (last, result)
    return listed(Memory(brief()), at)


@pytest.mark.parametrize(
    ("metres", "cost"), [(0.0, 0.0), (0.1, 0.05), (1.0, 0.5), (19.0, 9.5), (20.0, 10.0), (60.0, 10.0)]
)
def test_a_walk_costs_half_of_its_metres_and_at_most_ten(metres: float, cost: float) -> None:
    assert walk_cost(metres) == pytest.approx(cost)


def test_it_can_walk_to_each_known_target_or_look_around() -> None:
    """The table is not a target, and carts are for agents that hold something. 2 m cost 1, 4 m cost 2, a look 2.5."""
    assert offered(ground(("cart",))) == {"walk_to a": 1.0, "walk_to b": 2.0, "explore": 2.5}


def test_it_knows_only_what_it_has_seen() -> None:
    assert offered(ground(sight=3.0)) == {"walk_to a": 1.0, "explore": 2.5}
    assert offered(ground(sight=1.0)) == {"explore": 2.5}


def test_it_never_looks_around_twice_in_a_row_unless_nothing_else_is_left() -> None:
    assert offered(ground(), Action(EXPLORE), ARRIVED) == {"walk_to a": 1.0, "walk_to b": 2.0}
    assert offered(ground(sight=1.0), Action(EXPLORE), ARRIVED) == {"explore": 2.5}


def test_after_it_arrived_it_can_only_pick_up() -> None:
    assert offered(ground(), Action(WALK_TO, "b"), ARRIVED) == {"pick_up b": 0.0}


def test_after_a_pick_up_that_failed_everything_is_open() -> None:
    failed = offered(ground(), Action(PICK_UP, "a"), Result(False, "unreachable", 150))
    assert failed == {"walk_to a": 1.0, "walk_to b": 2.0, "explore": 2.5}


@pytest.mark.parametrize(
    ("start", "now", "cost"),
    [
        ((0.0, 0.0), (0.0, -1.0), 1.5),  # 4 m away, then 3 m
        ((0.0, 0.0), (0.0, 1.0), 7.5),  # 4 m away, then 5 m
        ((0.0, 0.0), (0.0, 0.0), 7.0),  # where it was
    ],
)
def test_after_a_walk_that_failed_it_can_only_try_again_or_look_around(
    start: tuple[float, float], now: tuple[float, float], cost: float
) -> None:
    """The walk to b at (0, -4) costs 5 more if the agent came no nearer."""
    at, memory = ground(), Memory(brief())
    at.at = start
    view = memory.view(at.decision())
    memory.action(view, next(option for option in view.options(view.start) if view.names[option.thing] == "b"))
    at.at, at.last = now, (Action(WALK_TO, "b"), FAILED)
    assert listed(memory, at) == {"walk_to b": cost, "explore": 2.5}


def test_a_walk_to_what_is_no_longer_remembered_is_not_tried_again() -> None:
    at = ground()
    at.map.forget(at.names.index("b"))
    assert offered(at, Action(WALK_TO, "b"), FAILED) == {"walk_to a": 1.0, "explore": 2.5}


def test_what_it_holds_goes_into_the_bag() -> None:
    at = ground()
    at.held = "a"
    at.map.forget(0)
    assert offered(at, Action(PICK_UP, "a"), ARRIVED) == {"drop": 0.0}
    assert offered(at, Action(DROP), Result(False, "not_rescued", 20)) == {"drop": 0.0}


def test_what_it_holds_goes_into_a_cart_that_it_has_walked_to() -> None:
    """6 m cost 3, 8 m cost 4. After a walk that failed it goes on to the same cart."""
    at = ground(("trolley", "cart"))
    at.held = "a"
    at.map.forget(0)
    walks = {"walk_to cart": 3.0, "walk_to trolley": 4.0}
    assert offered(at, Action(PICK_UP, "a"), ARRIVED) == walks
    assert offered(at, Action(WALK_TO, "cart"), FAILED) == {"walk_to cart": 3.0}
    at.map.forget(at.names.index("cart"))
    assert offered(at, Action(WALK_TO, "cart"), FAILED) == {"explore": 2.5}
    at.look()
    assert offered(at, Action(WALK_TO, "cart"), ARRIVED) == {"drop cart": 0.0}
    assert offered(at, Action(DROP, "cart"), Result(False, "cart_unreachable", 20)) == walks


def test_without_a_known_cart_it_looks_for_one() -> None:
    at = ground(("cart",), sight=5.0)
    at.held = "a"
    at.map.forget(0)
    assert offered(at, Action(EXPLORE), ARRIVED) == {"explore": 2.5}


def test_it_never_stops_and_never_fetches_what_is_safe() -> None:
    at = ground()
    at.rescued = {"a"}
    assert offered(at, Action(DROP), ARRIVED) == {"walk_to b": 2.0, "explore": 2.5}
    at.rescued = {"a", "b"}
    assert offered(at, Action(DROP), ARRIVED) == {"explore": 2.5}
    assert str(Action(STOP)) not in offered(at)


def rescue(view: View, *things: str) -> list[str]:
    """The verbs of a predicted rescue of `things`, each of whose options is offered when it is chosen."""
    state, done = view.start, []
    for thing in things:
        for verb in (WALK_TO, PICK_UP, *([] if view.in_bag else [WALK_TO]), DROP):
            name = thing if not state.holding else "cart"
            chosen = [o for o in view.options(state) if o.verb == verb and view.names[o.thing] in (name, "")]
            assert len(chosen) == 1, (verb, view.options(state))
            state = view.after(state, chosen[0])
            done.append(verb)
    assert not state.holding and view.options(state) == (LOOK,)
    assert view.options(view.after(state, LOOK)) == ()
    return done


def test_a_rescue_is_predicted_to_the_end() -> None:
    in_bag = Memory(brief()).view(ground().decision())
    assert rescue(in_bag, "b", "a") == [WALK_TO, PICK_UP, DROP] * 2
    to_cart = Memory(brief("HazardWind-v1")).view(ground(("cart",)).decision())
    assert rescue(to_cart, "a", "b") == [WALK_TO, PICK_UP, WALK_TO, DROP] * 2


def test_a_predicted_walk_begins_where_the_last_one_ended() -> None:
    """From a at (2, 0) to b at (0, -4): half the square root of 20."""
    view = Memory(brief()).view(ground().decision())
    walk = next(o for o in view.options(view.start) if view.names[o.thing] == "a")
    state = view.after(view.start, walk)
    state = view.after(view.after(state, view.options(state)[0]), Option(DROP, HERE, 0.0))
    assert [o.cost for o in view.options(state)] == [pytest.approx(5**0.5), EXPLORE_COST]


def test_the_view_of_a_decision_is_not_changed_by_time_alone() -> None:
    at, memory = ground(), Memory(brief())
    assert memory.view(at.decision()) == memory.view(replace(at.decision(), frame=700))
