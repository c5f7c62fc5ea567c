"""The planner in a room without physics: what it puts first, and why."""

from __future__ import annotations

from dataclasses import replace

import pytest

from hazard_ms.agents.base import agent
from hazard_ms.agents.greedy import Greedy
from hazard_ms.agents.planner import Planner
from hazard_ms.sensing.sighting import Sighting
from hazard_ms.skills.decision import DROP, EXPLORE, PICK_UP, WALK_ONE_STEP, WALK_TO, Action, Result
from hazard_ms.skills.failures import MAX_FRAMES
from tests.worlds.playground import Playground, brief, play


def begun(ground: Playground) -> Planner:
    """A planner that has looked around, in the task with fire."""
    player = Planner()
    player.reset(brief())
    ground.do(player.act(ground.decision()))
    return player


def heated(sighting: Sighting, early: float, late: float) -> Sighting:
    """The sighting of a thing around which it had the temperatures `early` and `late` [C], at frames 0 and 100."""
    return replace(sighting, levels=(late,), history=((0, (early,)), (100, (late,))))


def test_it_fetches_first_what_will_burn_before_it_could_be_second() -> None:
    """Greedy takes the nearer one, and the other burns: from 80 C by 0.8 C a frame, 300 C are reached at 375."""
    ground = Playground({"cool": (1.2, 0.0), "hot": (-1.9, 0.0)}, {"cool": 5.0, "hot": 5.0})
    player = begun(ground)
    cool, hot = ground.map.objects[0], ground.map.objects[1]
    ground.remember(0, heated(cool, 20.0, 20.0))
    ground.remember(1, heated(hot, 0.0, 80.0))
    seen = replace(ground.decision(), frame=100)
    assert player.act(seen) == Action(WALK_TO, "hot")
    greedy = Greedy()
    greedy.reset(brief())
    greedy.act(replace(ground.decision(), last_action=None, last_result=None))
    assert greedy.act(seen) == Action(WALK_TO, "cool")
    ground.remember(1, heated(hot, 20.0, 20.0))
    fresh = begun(Playground(ground.places, ground.values))
    assert fresh.act(replace(ground.decision(), frame=100)) == Action(WALK_TO, "cool"), "in no danger: the nearer one"


def test_what_burns_whatever_it_does_can_wait() -> None:
    """3 C a frame: it burns long before it can be reached, and is worth half, now as later."""
    ground = Playground({"cool": (1.2, 0.0), "lost": (-1.0, 0.0)}, {"cool": 5.0, "lost": 5.0})
    player = begun(ground)
    ground.remember(0, heated(ground.map.objects[0], 20.0, 20.0))
    ground.remember(1, heated(ground.map.objects[1], 0.0, 290.0))
    assert player.act(replace(ground.decision(), frame=100)) == Action(WALK_TO, "cool")


def test_it_knows_how_long_the_way_around_a_wall_is() -> None:
    """1.9 m behind a wall of 4 m are farther than 2.8 m in the open. Greedy measures straight lines."""
    ground = Playground({"behind": (1.9, 0.0), "open": (-2.8, 0.0)}, {"behind": 5.0, "open": 5.0})
    ground.map._firm[108:148, 133:136] = 1.0  # from y = -2 to 2 m at x = 0.5 to 0.8 m
    player = begun(ground)
    assert player.act(ground.decision()) == Action(WALK_TO, "open")


def test_it_does_not_search_for_what_it_knows() -> None:
    ground = Playground({"table": (2.8, 0.0), "near": (-1.0, 0.0)}, {"near": 1.0})
    taken = play(Planner(), ground)
    assert Action(WALK_TO, "table") not in taken and ground.rescued == {"near"}


def test_the_more_is_unseen_the_sooner_it_searches() -> None:
    """One known target of value 1 a good way off, and a landmark by unseen floor: five unseen of 5 are worth more."""
    far = {f"unseen_{n}": (8.0 + n, 8.0) for n in range(5)}
    places = {"table": (2.5, 0.0), "known": (-2.8, 0.0), **far}
    for unseen, first in ((5.0, "table"), (0.01, "known")):
        player = begun(ground := Playground(places, {"known": 1.0, **dict.fromkeys(far, unseen)}))
        assert player.act(ground.decision()) == Action(WALK_TO, first)


def test_with_something_in_the_hand_it_searches_for_a_cart() -> None:
    places = {"a": (1.0, 0.0), "table": (-2.8, 0.0), "cart": (-5.0, 0.0)}
    ground = Playground(places, {"a": 1.0}, carts=("cart",))
    play(Planner(), ground)
    assert ground.rescued == {"a"}


@pytest.mark.parametrize(("away", "verb"), [(1.2, DROP), (2.0, WALK_ONE_STEP), (2.7, WALK_TO)])
def test_near_a_cart_the_drop_drives_the_rest_of_the_way(away: float, verb: str) -> None:
    """A drop drives on by up to 0.7 m, while the arm unfolds."""
    ground = Playground({"a": (0.6, 0.0), "cart": (0.0, away)}, {"a": 1.0}, carts=("cart",))
    player = begun(ground)
    ground.do(player.act(ground.decision()))
    assert ground.held == "a" and player.act(ground.decision()) == Action(verb, "cart")


def test_without_a_cart_it_looks_around_where_it_searches_even_at_a_target() -> None:
    """What it holds keeps it from taking the other: it came there to see more, and once more it would see no more."""
    ground = Playground({"a": (0.6, 0.0), "b": (2.0, 0.0), "cart": (9.0, 9.0)}, {"a": 5.0, "b": 1.0}, carts=("cart",))
    player = begun(ground)
    while ground.held is None:
        ground.do(player.act(ground.decision()))
    taken = []
    for _ in range(4):
        taken.append(player.act(ground.decision()))
        ground.do(taken[-1])
    assert ground.held == "a" and Action(WALK_TO, "b") in taken
    assert taken[taken.index(Action(WALK_TO, "b")) + 1] == Action(EXPLORE)


def test_after_a_step_that_did_not_bring_it_near_it_walks_up_to_the_cart() -> None:
    """A step that ends where it begins takes no frames: another one would follow for ever."""
    ground = Playground({"a": (0.6, 0.0), "cart": (0.0, 2.0)}, {"a": 1.0}, carts=("cart",))
    player = begun(ground)
    ground.do(player.act(ground.decision()))
    ground.last = player.act(ground.decision()), Result(True, "", 0)
    assert player.act(ground.decision()) == Action(WALK_TO, "cart")


def test_after_a_drop_that_failed_it_walks_up_to_the_cart() -> None:
    ground = Playground({"a": (0.6, 0.0), "cart": (0.0, 1.2)}, {"a": 1.0}, carts=("cart",))
    player = begun(ground)
    ground.do(player.act(ground.decision()))
    drop = player.act(ground.decision())
    ground.last = drop, Result(False, "cart_unreachable", 5)
    assert player.act(ground.decision()) == Action(WALK_TO, "cart")


def test_it_goes_on_to_what_it_walks_to_unless_another_is_clearly_better() -> None:
    """Two alike at the same distance: the one that it is on its way to."""
    for name in ("left", "right"):
        ground = Playground({"left": (0.0, 2.5), "right": (0.0, -2.5)}, {"left": 1.0, "right": 1.0})
        player = begun(ground)
        on_the_way = replace(ground.decision(), last_action=Action(WALK_TO, name))
        failed = replace(on_the_way, last_result=replace(on_the_way.last_result, ok=False))  # type: ignore[type-var]
        assert player.act(failed) == Action(WALK_TO, name)


def test_the_note_says_what_the_plan_is() -> None:
    ground = Playground({"a": (1.0, 0.0), "b": (0.0, 2.0)}, {"a": 1.0, "b": 5.0})
    player = begun(ground)
    player.act(ground.decision())
    assert player.note and player.note.index("b by ") < player.note.index("a by ")
    assert "worth" in player.note and "best of all orders" in player.note


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("planner:loyalty=1.5", "loyalty must be a share from 0 to 1, got 1.5"),
        ("planner:fading=-0.1", "fading must be a share from 0 to 1, got -0.1"),
        ("planner:caution=2", "caution must be a share from 0 to 1, got 2.0"),
        ("planner:search=nan", "search must be a share from 0 to 1, got nan"),
        ("planner:give_up=0", "give_up must be a whole number from 1 to 100, got 0"),
        ("mcts:simulations=0", "simulations must be a whole number from 1 to"),
    ],
)
def test_parameters_out_of_range_are_refused(text: str, told: str) -> None:
    with pytest.raises(ValueError, match=told):
        agent(text)


def test_with_search_off_it_fetches_what_it_knows_first() -> None:
    far = {f"unseen_{n}": (8.0 + n, 8.0) for n in range(5)}
    ground = Playground({"table": (2.5, 0.0), "known": (-2.8, 0.0), **far}, {"known": 1.0, **dict.fromkeys(far, 5.0)})
    player = agent("planner:search=0")
    player.reset(brief())
    ground.do(player.act(ground.decision()))
    assert player.act(ground.decision()) == Action(WALK_TO, "known")


def test_a_thing_within_reach_is_picked_up_without_a_walk() -> None:
    ground = Playground({"a": (0.6, 0.0), "b": (2.0, 0.0)}, {"a": 1.0, "b": 1.0})
    assert begun(ground).act(ground.decision()) == Action(PICK_UP, "a")


def test_after_a_failed_pick_up_it_looks_and_walks_up_to_the_thing_before_the_next() -> None:
    """The thing seems to be too far away, so that it may have moved."""
    ground = Playground({"a": (0.6, 0.0)}, {"a": 1.0}, slippery=frozenset({"a"}))
    taken = play(Planner(), ground, most=5)
    pick, walk = Action(PICK_UP, "a"), Action(WALK_TO, "a")
    assert taken == [Action(EXPLORE), pick, Action(EXPLORE), walk, pick]


@pytest.mark.parametrize("unsure", [{"several_rooms": True}, {"looks": True}, {}])
@pytest.mark.parametrize("late, first", [(20.0, "left"), (75.0, "right")])
def test_it_does_not_turn_round_for_a_little(late: float, first: str, unsure: dict[str, bool]) -> None:
    """In a home, or with a detector: unless what is nearer now burns before it could be second."""
    ground = Playground({"left": (-2.8, 0.0), "right": (2.8, 0.0)}, {"left": 5.2, "right": 5.0})
    told = replace(brief(), **unsure)  # type: ignore[arg-type]
    player, fresh = Planner(loyalty=0.0, fading=1.0), Planner(loyalty=0.0, fading=1.0)
    player.reset(told)
    ground.do(player.act(ground.decision()))
    assert player.act(ground.decision()) == Action(WALK_TO, "left")
    ground.places["right"] = (2.4, 0.0)
    ground.look()
    ground.remember(0, heated(ground.map.objects[0], 20.0, 20.0))
    ground.remember(1, heated(ground.map.objects[1], 20.0, late))
    cut_short = Action(WALK_TO, "left"), Result(False, MAX_FRAMES, 100)
    now = replace(ground.decision(), frame=100, last_action=cut_short[0], last_result=cut_short[1])
    assert player.act(now) == Action(WALK_TO, first if unsure else "right")
    fresh.reset(told)
    assert fresh.act(now) == Action(WALK_TO, "right")
