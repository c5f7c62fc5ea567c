"""The reward `paper` of decisions, worked out by hand: where the safe place is a bag, and where it is a cart."""

from __future__ import annotations

import pytest

from hazard_ms.skills.options.rewards import paper, potential

BAG, CART = False, True
SITUATIONS = {
    # what happens: safe place, before, after (rescued, something in the hand, metres to a target, to a cart), allowed
    "the only target, 2 m away, is rescued": (BAG, (0, False, 2, 0), (1, False, 0, 0), True, 39.9),
    "a target is rescued, the next is 3 m away": (BAG, (0, False, 2, 0), (1, False, 3, 0), True, 9.9),
    "two metres nearer": (BAG, (1, False, 5, 0), (1, False, 3, 0), True, 19.9),
    "one metre farther off": (BAG, (0, False, 1, 0), (0, False, 2, 0), True, -10.1),
    "a look around": (BAG, (0, False, 4, 0), (0, False, 4, 0), True, -0.1),
    "an option that cannot be chosen": (BAG, (0, False, 4, 0), (0, False, 4, 0), False, -5.1),
    "a target is taken, the next is 1 m away": (BAG, (0, False, 0.5, 0), (0, True, 1, 0), True, -15.1),
    "what was held goes into the bag": (BAG, (0, True, 1, 0), (1, False, 1, 0), True, 29.9),
    "what was held is dropped on the floor": (BAG, (0, True, 1, 0), (0, False, 0.25, 0), True, 17.4),
    "the last one is in the hand": (BAG, (2, False, 0.5, 0), (2, True, 0, 0), True, -5.1),
    "a target 2 m away is taken, 3 m from a cart": (CART, (0, False, 2, 1), (0, True, 0.5, 3), True, -10.1),
    "it is brought 3 m to the cart, the next is 4 m away": (CART, (0, True, 0.5, 3), (1, False, 4, 0.5), True, 9.9),
    "the last one is brought": (CART, (1, True, 0, 3), (2, False, 0, 0.5), True, 49.9),
    "two metres nearer to the cart": (CART, (0, True, 7, 5), (0, True, 9, 3), True, 19.9),
    "a metre off the cart": (CART, (0, True, 2, 1), (0, True, 1, 2), True, -10.1),
    "nearer to a target with empty hands": (CART, (0, False, 3, 1), (0, False, 2, 2), True, 9.9),
    "a look around with full hands": (CART, (0, True, 3, 1), (0, True, 3, 1), True, -0.1),
    "a bag that is not there": (CART, (0, True, 3, 1), (0, True, 3, 1), False, -5.1),
    "it is lost on the way to the cart": (CART, (0, True, 6, 2), (0, False, 0.25, 1.5), True, 17.4),
    "the wind takes a target away": (CART, (0, False, 1, 1), (0, False, 2.5, 1), True, -15.1),
}


@pytest.mark.parametrize("what", SITUATIONS)
def test_the_reward_of_the_paper(what: str) -> None:
    carts, before, after, allowed, wanted = SITUATIONS[what]
    levels = [potential(rescued, holding, carts, target, cart) for rescued, holding, target, cart in (before, after)]
    assert float(paper(*levels, allowed)) == pytest.approx(wanted)


def test_there_are_ten_situations_for_each_safe_place() -> None:
    assert [sum(case[0] is carts for case in SITUATIONS.values()) for carts in (BAG, CART)] == [10, 10]
    assert float(potential(0, False, CART, 0.0, 0.0)) == 0.0 == float(potential(0, False, BAG, 0.0, 0.0))
