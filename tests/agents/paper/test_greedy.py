"""The paper's greedy agent in a room without physics: as the paper's code has it, and as its text describes it."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace

import pytest

from hazard_ms.agents.paper.greedy import Greedy
from hazard_ms.skills.decision import DROP, EXPLORE, PICK_UP, WALK_TO, Action, Result
from tests.worlds.playground import Playground, brief, play

LOOKED = (Action(EXPLORE), Result(True))  # after this it can only walk
FAILED = Result(False, "max_frames", 100)

Places = dict[str, tuple[float, float]]


def chosen(
    places: Places,
    values: dict[str, float],
    last: tuple[Action | None, Result | None] = LOOKED,
    lowest: bool = False,
    seed: int = 0,
) -> Action:
    """The choice of an agent that has seen all."""
    ground = Playground(places, values, sight=50.0, last=last)
    ground.look()
    player = Greedy(lowest)
    player.reset(brief(seed=seed))
    return player.act(ground.decision())


def test_of_two_equal_targets_it_takes_the_farther() -> None:
    assert chosen({"far": (3.0, 0.0), "near": (0.0, 1.0)}, {"far": 1.0, "near": 1.0}) == Action(WALK_TO, "far")


def test_it_takes_the_highest_cost_over_value() -> None:
    """1 * 0.5 / 1 = 0.5 against 4 * 0.5 / 5 = 0.4; at 6 m it would be 0.6."""
    values = {"cheap": 1.0, "dear": 5.0}
    assert chosen({"cheap": (1.0, 0.0), "dear": (0.0, 4.0)}, values) == Action(WALK_TO, "cheap")
    assert chosen({"cheap": (1.0, 0.0), "dear": (0.0, 6.0)}, values) == Action(WALK_TO, "dear")


@pytest.mark.parametrize(
    ("metres", "value", "walks"), [(4.9, 1.0, False), (5.1, 1.0, True), (20.0, 5.0, False), (60.0, 5.0, False)]
)
def test_it_looks_around_unless_a_walk_costs_more(metres: float, value: float, walks: bool) -> None:
    """A look costs 2.5, a walk 0.5 per metre and at most 10, over the value: never so much for what is worth 5."""
    action = chosen({"a": (metres, 0.0)}, {"a": value}, last=(None, None))
    assert action == (Action(WALK_TO, "a") if walks else Action(EXPLORE))


def test_after_a_walk_that_failed_it_looks_around_unless_the_rest_costs_more() -> None:
    """It never pays for a walk that came no nearer: 4 m cost 2, not 7."""
    last = (Action(WALK_TO, "a"), FAILED)
    assert chosen({"a": (4.0, 0.0)}, {"a": 1.0}, last) == Action(EXPLORE)
    assert chosen({"a": (6.0, 0.0), "b": (9.0, 0.0)}, {"a": 1.0, "b": 1.0}, last) == Action(WALK_TO, "a")


def test_of_options_that_cost_the_same_it_takes_any() -> None:
    places, values = {"a": (3.0, 0.0), "b": (0.0, 3.0), "c": (1.0, 0.0)}, {"a": 1.0, "b": 1.0, "c": 1.0}
    counts = Counter(chosen(places, values, seed=seed).target for seed in range(200))
    assert set(counts) == {"a", "b"} and abs(counts["a"] - 100) <= 4 * (200 / 4) ** 0.5
    assert chosen(places, values, seed=7) == chosen(places, values, seed=7)


@pytest.mark.parametrize(("task", "first"), [("HazardFlood-v1", "soaked"), ("HazardFire-v1", "far")])
def test_it_halves_what_gets_wet_and_nothing_that_burns(task: str, first: str) -> None:
    """5 at 3 m costs 0.3, 5 at 2 m 0.2, and 0.4 if it gets wet. 400 is deep water, and hotter than what ignites."""
    ground = Playground({"far": (3.0, 0.0), "soaked": (0.0, 2.0)}, {"far": 5.0, "soaked": 5.0}, sight=50.0, last=LOOKED)
    ground.look()
    ground.remember(1, replace(ground.map.objects[1], levels=(400.0,)))
    player = Greedy()
    player.reset(brief(task))
    assert player.act(ground.decision()) == Action(WALK_TO, first)


def test_it_looks_around_between_rescues_and_takes_the_farthest_first() -> None:
    ground = Playground({"a": (1.0, 0.0), "b": (0.0, 2.0), "c": (-1.5, 0.0)}, {"a": 1.0, "b": 5.0, "c": 1.0})
    taken = play(Greedy(), ground, most=60)
    assert ground.rescued == {"a", "b", "c"}
    assert [action.target for action in taken if action.verb == PICK_UP] == ["c", "a", "b"]
    assert [action.verb for action in taken[:6]] == [EXPLORE, WALK_TO, PICK_UP, DROP, EXPLORE, WALK_TO]


def test_it_brings_things_to_the_farthest_cart_and_stays_with_it() -> None:
    places = {"a": (1.0, 0.0), "east": (3.0, 0.0), "west": (-4.0, 0.0)}
    ground = Playground(places, {"a": 5.0}, carts=("west", "east"), sight=9.0)
    taken = play(Greedy(), ground, most=14)
    assert ground.rescued == {"a"} and Action(DROP, "west") in taken and Action(WALK_TO, "east") not in taken


def test_it_never_gives_up() -> None:
    """A way that is barred, to something far away."""
    ground = Playground({"a": (6.0, 0.0)}, {"a": 1.0}, broken=frozenset({"a"}), sight=9.0)
    taken = play(Greedy(), ground, most=12)
    assert Action(WALK_TO, "a") in taken[6:] and not ground.rescued


def test_it_says_what_it_weighed() -> None:
    ground = Playground({"a": (1.0, 0.0)}, {"a": 5.0}, sight=9.0)
    ground.look()
    player = Greedy()
    player.reset(brief())
    player.act(ground.decision())
    assert player.note == "cost 2.50, the highest of 2"


# With the lowest cost, as the paper's text says.


def lowest(places: Places, values: dict[str, float]) -> Action:
    """The first choice of the paper's text."""
    return chosen(places, values, (None, None), lowest=True)


def test_of_two_equal_targets_the_lowest_is_the_nearer() -> None:
    assert lowest({"far": (3.0, 0.0), "near": (0.0, 1.0)}, {"far": 1.0, "near": 1.0}) == Action(WALK_TO, "near")


def test_the_lowest_cost_is_over_value() -> None:
    """4 * 0.5 / 5 = 0.4 against 1 * 0.5 / 1 = 0.5; at 6 m it would be 0.6."""
    values = {"cheap": 1.0, "dear": 5.0}
    assert lowest({"cheap": (1.0, 0.0), "dear": (0.0, 4.0)}, values) == Action(WALK_TO, "dear")
    assert lowest({"cheap": (1.0, 0.0), "dear": (0.0, 6.0)}, values) == Action(WALK_TO, "cheap")


def test_the_lowest_is_to_look_around_rather_than_walk_far_for_little() -> None:
    """A look costs 2.5: as much as 5 m for value 1 or 25 m, were they counted, for value 5."""
    assert lowest({"a": (5.1, 0.0)}, {"a": 1.0}) == Action(EXPLORE)
    assert lowest({"a": (4.9, 0.0)}, {"a": 1.0}) == Action(WALK_TO, "a")
    assert lowest({"a": (40.0, 0.0)}, {"a": 5.0}) == Action(WALK_TO, "a")


def test_the_text_halves_what_will_burn() -> None:
    """5 at 3 m costs 0.3, 5 at 2 m 0.2, and 0.4 if it ignites at 300 C; after 200, 250 and 280 C come 310."""
    ground = Playground({"cool": (3.0, 0.0), "hot": (0.0, 2.0)}, {"cool": 5.0, "hot": 5.0}, sight=50.0)
    ground.look()
    player = Greedy(lowest=True)
    player.reset(brief())
    chosen = []
    for frame, level in ((0, 200.0), (60, 250.0), (120, 280.0)):
        ground.remember(1, replace(ground.map.objects[1], frame=frame, levels=(level,)))
        chosen.append(player.act(ground.decision()).target)
    assert chosen == ["hot", "hot", "cool"]


def test_with_the_lowest_cost_it_changes_its_mind_on_the_way() -> None:
    """It has no loyalty: after a look shows something better it goes there instead."""
    ground = Playground({"a": (2.0, 0.0), "b": (0.0, 3.0)}, {"a": 1.0, "b": 5.0}, sight=2.5)
    ground.look()
    player = Greedy(lowest=True)
    player.reset(brief())
    assert player.act(ground.decision()) == Action(WALK_TO, "a")
    ground.sight = 5.0
    ground.do(Action(EXPLORE))
    assert player.act(ground.decision()) == Action(WALK_TO, "b")


def test_with_the_lowest_cost_it_rescues_in_the_order_of_cost() -> None:
    ground = Playground({"a": (1.0, 0.0), "b": (0.0, 2.0), "c": (-2.0, 0.0)}, {"a": 1.0, "b": 5.0, "c": 1.0})
    taken = play(Greedy(lowest=True), ground, most=14)
    assert [action.target for action in taken if action.verb == PICK_UP] == ["b", "a", "c"]
    assert ground.rescued == {"a", "b", "c"}
    assert [action.verb for action in taken[:5]] == [EXPLORE, WALK_TO, PICK_UP, DROP, WALK_TO]


def test_with_the_lowest_cost_it_brings_things_to_the_nearest_cart() -> None:
    places = {"a": (1.0, 0.0), "east": (3.0, 0.0), "west": (-4.0, 0.0)}
    ground = Playground(places, {"a": 5.0}, carts=("west", "east"), sight=9.0)
    taken = play(Greedy(lowest=True), ground, most=8)
    assert ground.rescued == {"a"} and Action(DROP, "east") in taken


def test_with_the_lowest_cost_it_never_gives_up() -> None:
    """A way that is barred, to something dear: it tries for ever, 0.5 / 5 being less than 2.5."""
    ground = Playground({"a": (1.0, 0.0), "b": (0.0, 1.5)}, {"a": 5.0, "b": 1.0}, broken=frozenset({"a"}))
    taken = play(Greedy(lowest=True), ground, most=50)
    assert set(taken[1:]) == {Action(WALK_TO, "a")} and not ground.rescued


def test_it_searches_only_by_looking_around() -> None:
    ground = Playground({"table": (2.0, 0.0), "far": (5.0, 0.0)}, {"far": 5.0})
    assert set(play(Greedy(lowest=True), ground, most=20)) == {Action(EXPLORE)}


def test_with_the_lowest_cost_it_says_what_it_weighed() -> None:
    ground = Playground({"a": (1.0, 0.0)}, {"a": 5.0}, sight=9.0)
    ground.do(Action(EXPLORE))
    player = Greedy(lowest=True)
    player.reset(brief())
    player.act(ground.decision())
    assert player.note == "cost 0.10, the lowest of 1"
    ground.last = (Action(WALK_TO, "a"), Result(True))
    player.act(ground.decision())
    assert player.note == "cost 0.00, the lowest of 1"
