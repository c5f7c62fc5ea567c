"""What is on offer at a decision, and what follows by itself."""

from __future__ import annotations

import numpy as np
import pytest

from hazard_ms.agents.llm.choices import LETTERS, forced, menu
from hazard_ms.sensing.sighting import Sighting
from hazard_ms.skills.decision import Action, Result
from tests.agents.llm.conftest import Ground

CARTS = {"mug": (2.0, 0.0), "cart_1": (1.0, 2.0), "cart_2": (2.0, 1.5)}


def many(count: int) -> Ground:
    """Targets along a line, the nearest with the highest index, all seen."""
    names = [f"mug_{k}" for k in range(count)]
    ground = Ground({n: (30.0 - k, 0.0) for k, n in enumerate(names)}, dict.fromkeys(names, 1.0), frozenset())
    for k, name in enumerate(names):
        ground.remember(k, Sighting(np.array([*ground.places[name], 0.5], np.float32), 0.1, 0.6, 0, 50))
    return ground


@pytest.mark.parametrize("most", [6, 10, 20])
def test_of_many_targets_the_nearest_are_offered_in_the_order_of_their_indices(most: int) -> None:
    made = menu(many(29).decision(), {}, {}, 4, "macro", most)
    targets = [choice.thing for choice in made.choices if choice.move == "fetch"]
    count = most - sum(choice.move != "fetch" for choice in made.choices)
    assert targets == [f"mug_{k}" for k in range(29 - count, 29)] and count >= most - 6
    assert [choice.letter for choice in made.choices] == list(LETTERS[:most])
    assert [str(choice.action) for choice in made.choices[-2:]] == ["explore", "stop"]


def test_what_failed_too_often_is_not_offered() -> None:
    ground = Ground()
    ground.look()
    made = menu(ground.decision(), {"mug": 4, "book": 3}, {}, 4, "macro", 20)
    assert {choice.thing for choice in made.choices if choice.move == "fetch"} == {"book", "stone"}


def test_looking_around_twice_is_offered_only_where_nothing_else_is_left() -> None:
    ground = Ground()
    moves = [choice.move for choice in menu(ground.decision(), {}, {}, 4, "macro", 20).choices]
    assert moves == ["look", "stop"]
    ground.last = (Action("explore"), Result(True, "", 60))
    assert [choice.move for choice in menu(ground.decision(), {}, {}, 4, "macro", 20).choices] == ["look", "stop"]
    ground.look()
    assert "look" not in [choice.move for choice in menu(ground.decision(), {}, {}, 4, "macro", 20).choices]


def test_with_a_full_hand_carts_are_offered_and_no_targets() -> None:
    ground = Ground(CARTS, {"mug": 1.0}, frozenset(), carts=("cart_1", "cart_2"), held="mug", at=(0.5, 1.5))
    ground.look()
    for moves, more in (("macro", []), ("full", ["put into cart_1", "put into cart_2"])):
        made = menu(ground.decision(), {}, {}, 4, moves, 20)
        shown = [f"{c.move} {c.thing}" for c in made.choices if c.thing is not None and c.move != "search at"]
        assert shown == ["bring to cart_1", "bring to cart_2", *more]


def test_what_follows_by_itself() -> None:
    ground = Ground()
    assert forced(ground.decision()) is None
    ground.last = (Action("walk_to", "mug"), Result(True, "", 90))
    assert forced(ground.decision()) == Action("pick_up", "mug")
    ground.last = (Action("walk_to", "mug"), Result(False, "max_frames", 100))
    assert forced(ground.decision()) is None
    ground.last = (Action("walk_to", "shelf"), Result(True, "", 90))
    assert forced(ground.decision()) is None, "no target"
    ground.held = "mug"
    assert forced(ground.decision()) == Action("drop")
    street = Ground(CARTS, {"mug": 1.0}, frozenset(), carts=("cart_1", "cart_2"), held="mug")
    assert forced(street.decision()) is None
    street.last = (Action("walk_to", "cart_2"), Result(True, "", 90))
    assert forced(street.decision()) == Action("drop", "cart_2")
