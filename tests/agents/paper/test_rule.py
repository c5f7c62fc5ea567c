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


def test_it_looks_around_twice_as_often_as_it_walks_and_values_nothing() -> None:
    assert agree(shares(seen()), {"explore": 2 / 3, "walk_to a": 1 / 9, "walk_to b": 1 / 9, "walk_to c": 1 / 9})


def test_it_never_looks_around_twice_in_a_row() -> None:
    after = seen(last=(Action(EXPLORE), Result(True)))
    assert agree(shares(after), {"walk_to a": 1 / 3, "walk_to b": 1 / 3, "walk_to c": 1 / 3})


def test_it_goes_on_with_a_walk_that_has_not_arrived() -> None:
    assert shares(seen(last=(Action(WALK_TO, "c"), FAILED))) == {"walk_to c": 1.0}


def test_it_picks_up_what_it_walked_to() -> None:
    assert shares(seen(last=(Action(WALK_TO, "b"), Result(True)))) == {"pick_up b": 1.0}


def test_after_a_pick_up_that_failed_it_draws_again() -> None:
    failed = seen(last=(Action(PICK_UP, "b"), Result(False, "unreachable")))
    assert agree(shares(failed), {"explore": 2 / 3, "walk_to a": 1 / 9, "walk_to b": 1 / 9, "walk_to c": 1 / 9})


def test_it_drops_into_the_bag_until_that_works() -> None:
    holding = seen(held="a", last=(Action(PICK_UP, "a"), Result(True)))
    assert shares(holding) == {"drop": 1.0}
    assert shares(seen(held="a", last=(Action(DROP), Result(False, "not_rescued")))) == {"drop": 1.0}


def test_it_brings_things_to_a_random_cart_and_stays_with_it() -> None:
    """b and c are carts here."""
    carts = ("b", "c")
    holding = seen(held="a", carts=carts, values={"a": 1.0}, last=(Action(PICK_UP, "a"), Result(True)))
    assert agree(shares(holding), {"walk_to b": 1 / 2, "walk_to c": 1 / 2})
    holding.last = (Action(WALK_TO, "c"), FAILED)
    assert shares(holding) == {"walk_to c": 1.0}
    holding.last = (Action(WALK_TO, "c"), Result(True))
    assert shares(holding) == {"drop c": 1.0}


def test_it_rescues_what_it_sees() -> None:
    ground = Playground({"a": (1.0, 0.0), "b": (0.0, 2.0)}, {"a": 1.0, "b": 5.0})
    taken = play(Rule(), ground)
    assert ground.rescued == {"a", "b"} and {action.verb for action in taken} == {EXPLORE, WALK_TO, PICK_UP, DROP}


def test_it_is_a_function_of_its_seed() -> None:
    def episode(seed: int) -> list[Action]:
        return play(Rule(), seen(), seed)

    assert episode(3) == episode(3)
    assert episode(3) != episode(4)
    assert shares(seen(), 1) != shares(seen(), 2)
