"""The paper's rule-based agent in a room without physics."""

from __future__ import annotations

from collections import Counter

import numpy as np

from hazard_ms.agents.paper.rule import Rule
from hazard_ms.skills.decision import DROP, EXPLORE, PICK_UP, WALK_TO, Action, Result
from tests.worlds.playground import Playground, brief, play

FAILED = Result(False, "max_frames", 100)
DRAWS = 3000


def shares(ground: Playground, seed: int = 0) -> dict[str, float]:
    """How often it chooses what at one and the same decision."""
    player = Rule()
    player.reset(brief(seed=seed))
    decision = ground.decision()
    counts = Counter(str(player.act(decision)) for _ in range(DRAWS))
    return {action: count / DRAWS for action, count in counts.items()}


def agree(found: dict[str, float], expected: dict[str, float]) -> bool:
    """Whether the shares are those expected, within four standard deviations."""
    return set(found) == set(expected) and all(
        abs(found[action] - p) <= 4 * np.sqrt(p * (1 - p) / DRAWS) for action, p in expected.items()
    )


def seen(**kwargs: object) -> Playground:
    ground = Playground({"a": (1.0, 0.0), "b": (0.0, 2.0), "c": (8.0, 0.0)}, {"a": 1.0, "b": 5.0, "c": 1.0}, sight=9.0)
    for name, value in kwargs.items():
        setattr(ground, name, value)
    ground.look()
    return ground


DROPPED = (Action(DROP), Result(True))


def test_it_looks_around_first() -> None:
    assert shares(seen()) == {"explore": 1.0}


def test_it_looks_around_twice_as_often_as_it_walks_to_a_target_and_values_nothing() -> None:
    each = {"walk_to a": 1 / 5, "walk_to b": 1 / 5, "walk_to c": 1 / 5}
    assert agree(shares(seen(last=DROPPED)), {"explore": 2 / 5, **each})


def test_it_may_look_around_twice_in_a_row() -> None:
    after = seen(last=(Action(EXPLORE), Result(True)))
    assert agree(shares(after), {"explore": 2 / 5, "walk_to a": 1 / 5, "walk_to b": 1 / 5, "walk_to c": 1 / 5})


def test_it_goes_on_with_a_walk_that_has_not_arrived() -> None:
    assert shares(seen(last=(Action(WALK_TO, "c"), FAILED))) == {"walk_to c": 1.0}


def test_what_it_walked_to_it_picks_up_or_looks_around() -> None:
    """Once it has looked around it does so twice as often."""
    ground = seen(last=(Action(WALK_TO, "b"), Result(True)))
    assert agree(shares(ground), {"pick_up b": 1 / 2, "explore": 1 / 2})
    player = Rule()
    player.reset(brief())
    player.act(ground.decision())
    ground.last = (Action(EXPLORE), Result(True))
    decision = ground.decision()
    counts = Counter(str(player.act(decision)) for _ in range(DRAWS))
    assert agree({a: n / DRAWS for a, n in counts.items()}, {"pick_up b": 1 / 3, "explore": 2 / 3})


def test_it_picks_up_until_that_works() -> None:
    assert shares(seen(last=(Action(PICK_UP, "b"), Result(False, "unreachable")))) == {"pick_up b": 1.0}


def test_with_something_in_the_hand_it_drops_it_into_the_bag_or_looks_around() -> None:
    holding = seen(held="a", last=(Action(PICK_UP, "a"), Result(True)))
    assert agree(shares(holding), {"drop": 1 / 2, "explore": 1 / 2})
    assert shares(seen(held="a", last=(Action(DROP), Result(False, "not_rescued")))) == {"drop": 1.0}


def test_it_never_brings_anything_to_a_cart() -> None:
    """b and c are carts here. Its code has no walk to a cart, so that it can drop nothing in one."""
    holding = seen(held="a", carts=("b", "c"), values={"a": 1.0}, last=(Action(PICK_UP, "a"), Result(True)))
    assert shares(holding) == {"explore": 1.0}
    holding.last = (Action(EXPLORE), Result(True))
    assert shares(holding) == {"explore": 1.0}


def test_it_rescues_what_it_sees() -> None:
    ground = Playground({"a": (1.0, 0.0), "b": (0.0, 2.0)}, {"a": 1.0, "b": 5.0})
    taken = play(Rule(), ground)
    assert ground.rescued == {"a", "b"} and {action.verb for action in taken} == {EXPLORE, WALK_TO, PICK_UP, DROP}


def test_it_is_a_function_of_its_seed() -> None:
    def episode(seed: int) -> list[Action]:
        return play(Rule(), seen(), seed)

    assert episode(3) == episode(3)
    assert episode(3) != episode(4)
    assert shares(seen(last=DROPPED), 1) != shares(seen(last=DROPPED), 2)
