"""The paper's greedy agent in a room without physics."""

from __future__ import annotations

from dataclasses import replace

from hazard_ms.agents.paper.greedy import Greedy
from hazard_ms.skills.decision import DROP, EXPLORE, PICK_UP, WALK_TO, Action, Result
from tests.worlds.playground import Playground, brief, play


def first(places: dict[str, tuple[float, float]], values: dict[str, float]) -> Action:
    """The first choice of an agent that has seen all."""
    ground = Playground(places, values, sight=50.0)
    ground.look()
    player = Greedy()
    player.reset(brief())
    return player.act(ground.decision())


def test_of_two_equal_targets_it_takes_the_nearer() -> None:
    assert first({"far": (3.0, 0.0), "near": (0.0, 1.0)}, {"far": 1.0, "near": 1.0}) == Action(WALK_TO, "near")


def test_it_takes_the_lowest_cost_over_value() -> None:
    """4 * 0.5 / 5 = 0.4 against 1 * 0.5 / 1 = 0.5; at 6 m it would be 0.6."""
    values = {"cheap": 1.0, "dear": 5.0}
    assert first({"cheap": (1.0, 0.0), "dear": (0.0, 4.0)}, values) == Action(WALK_TO, "dear")
    assert first({"cheap": (1.0, 0.0), "dear": (0.0, 6.0)}, values) == Action(WALK_TO, "cheap")


def test_it_rather_looks_around_than_walks_far_for_little() -> None:
    """A look costs 2.5: as much as 5 m for value 1 or 25 m, were they counted, for value 5."""
    assert first({"a": (5.1, 0.0)}, {"a": 1.0}) == Action(EXPLORE)
    assert first({"a": (4.9, 0.0)}, {"a": 1.0}) == Action(WALK_TO, "a")
    assert first({"a": (40.0, 0.0)}, {"a": 5.0}) == Action(WALK_TO, "a")


def test_it_halves_what_will_burn() -> None:
    """5 at 3 m costs 0.3, 5 at 2 m 0.2, and 0.4 if it ignites at 300 C; after 200, 250 and 280 C come 310."""
    ground = Playground({"cool": (3.0, 0.0), "hot": (0.0, 2.0)}, {"cool": 5.0, "hot": 5.0}, sight=50.0)
    ground.look()
    player = Greedy()
    player.reset(brief())
    chosen = []
    for frame, level in ((0, 200.0), (60, 250.0), (120, 280.0)):
        ground.remember(1, replace(ground.map.objects[1], frame=frame, levels=(level,)))
        chosen.append(player.act(ground.decision()).target)
    assert chosen == ["hot", "hot", "cool"]


def test_it_changes_its_mind_on_the_way() -> None:
    """It has no loyalty: after a look shows something better it goes there instead."""
    ground = Playground({"a": (2.0, 0.0), "b": (0.0, 3.0)}, {"a": 1.0, "b": 5.0}, sight=2.5)
    ground.look()
    player = Greedy()
    player.reset(brief())
    assert player.act(ground.decision()) == Action(WALK_TO, "a")
    ground.sight = 5.0
    ground.do(Action(EXPLORE))
    assert player.act(ground.decision()) == Action(WALK_TO, "b")


def test_it_rescues_what_is_near_in_the_order_of_cost() -> None:
    ground = Playground({"a": (1.0, 0.0), "b": (0.0, 2.0), "c": (-2.0, 0.0)}, {"a": 1.0, "b": 5.0, "c": 1.0})
    taken = play(Greedy(), ground, most=14)
    assert [action.target for action in taken if action.verb == PICK_UP] == ["b", "a", "c"]
    assert ground.rescued == {"a", "b", "c"}
    assert [action.verb for action in taken[:5]] == [EXPLORE, WALK_TO, PICK_UP, DROP, WALK_TO]


def test_it_brings_things_to_the_nearest_cart() -> None:
    places = {"a": (1.0, 0.0), "east": (3.0, 0.0), "west": (-4.0, 0.0)}
    ground = Playground(places, {"a": 5.0}, carts=("west", "east"), sight=9.0)
    taken = play(Greedy(), ground, most=8)
    assert ground.rescued == {"a"} and Action(DROP, "east") in taken


def test_it_never_gives_up() -> None:
    """A way that is barred, to something dear: it tries for ever, (0.5 + 5) / 5 being less than 2.5."""
    ground = Playground({"a": (1.0, 0.0), "b": (0.0, 1.5)}, {"a": 5.0, "b": 1.0}, broken=frozenset({"a"}))
    taken = play(Greedy(), ground, most=50)
    assert set(taken[1:]) == {Action(WALK_TO, "a")} and not ground.rescued


def test_it_searches_only_by_looking_around() -> None:
    ground = Playground({"table": (2.0, 0.0), "far": (5.0, 0.0)}, {"far": 5.0})
    assert set(play(Greedy(), ground, most=20)) == {Action(EXPLORE)}


def test_it_says_what_it_weighed() -> None:
    ground = Playground({"a": (1.0, 0.0)}, {"a": 5.0}, sight=9.0)
    ground.do(Action(EXPLORE))
    player = Greedy()
    player.reset(brief())
    player.act(ground.decision())
    assert player.note == "cost 0.10, the lowest of 1"
    ground.last = (Action(WALK_TO, "a"), Result(True))
    player.act(ground.decision())
    assert player.note == "cost 0.00, the lowest of 1"
