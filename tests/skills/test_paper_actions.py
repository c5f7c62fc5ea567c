"""The six actions of the original's learner on decisions: which action of the benchmark each is, and when it can be."""

from __future__ import annotations

import numpy as np
import pytest

from hazard_ms.skills.decision import DROP, EXPLORE, PICK_UP, WALK_ONE_STEP, WALK_TO, Action
from hazard_ms.skills.options.paper_actions import (
    COUNT,
    LET_GO,
    LOOK,
    NAMES,
    REACH,
    TAKE,
    TO_CART,
    TO_TARGET,
    WANDER,
    SixActions,
    nearest,
    possible,
)
from tests.worlds.playground import Playground

PLACES = {"mug": (2.5, 0.0), "book": (0.0, 1.5), "shelf": (2.5, 1.0), "cart_1": (0.0, -2.5), "hidden": (9.0, 0.0)}
VALUES = {"mug": 5.0, "book": 1.0, "hidden": 1.0}


def at(ground: Playground, actions: SixActions | None = None) -> SixActions:
    """The six actions at the decision in `ground`."""
    made = actions or SixActions(0)
    made.see(ground.decision())
    return made


def names(made: SixActions) -> set[str]:
    return {NAMES[k] for k in np.flatnonzero(made.mask)}


def test_the_nearest_known_things_are_meant() -> None:
    ground = Playground(dict(PLACES), dict(VALUES), carts=("cart_1",))
    assert names(at(ground)) == {"explore"}  # nothing was seen yet
    ground.look()
    made = at(ground)
    assert names(made) == {"to_target", "to_cart", "pick_up", "explore", "wander"}
    want = [Action(WALK_ONE_STEP, "book"), Action(WALK_ONE_STEP, "cart_1"), Action(PICK_UP, "book"), None]
    assert [made.action(k) for k in range(LET_GO + 1)] == want and made.action(LOOK) == Action(EXPLORE)
    ground.at = (1.5, 0.0)
    assert at(ground).action(TO_TARGET) == Action(WALK_ONE_STEP, "mug")
    ground.rescued.add("mug")
    assert at(ground).action(TO_TARGET) == Action(WALK_ONE_STEP, "book")


def test_full_hands_pick_nothing_up_and_need_a_cart_within_reach() -> None:
    ground = Playground(dict(PLACES), dict(VALUES), carts=("cart_1",))
    ground.look()
    ground.held = "book"
    made = at(ground)
    assert names(made) == {"to_target", "to_cart", "explore", "wander"}  # the cart is 2.5 m away
    assert made.action(TO_TARGET) == Action(WALK_ONE_STEP, "mug")  # not what is in the hand
    ground.at = (0.0, -2.5 + REACH)
    assert at(ground).action(LET_GO) == Action(DROP, "cart_1")
    bag = Playground(dict(PLACES), dict(VALUES))
    bag.look()
    bag.held = "book"
    assert at(bag).action(LET_GO) == Action(DROP) and not at(bag).mask[TO_CART]


def test_a_target_beyond_reach_cannot_be_picked_up() -> None:
    ground = Playground({"mug": (REACH + 0.01, 0.0)}, {"mug": 5.0})
    ground.look()
    assert not at(ground).mask[TAKE]
    ground.at = (0.02, 0.0)
    assert at(ground).mask[TAKE]


def test_what_is_wandered_to_is_kept_until_it_is_reached() -> None:
    """Also if other actions come between, or other things into sight; then another thing is drawn."""
    ground = Playground({"shelf": (7.0, 0.0), "lamp": (7.0, 0.5), "door": (-9.0, 0.0)}, {}, sight=8.0)
    ground.look()
    actions, drawn = SixActions(0), set[str]()
    for _ in range(4):
        first = at(ground, actions).action(WANDER)
        assert first is not None and first.verb == WALK_TO and first.target in ("shelf", "lamp")
        ground.do(first)
        ground.do(Action(EXPLORE))
        at(ground, actions)
        assert actions.action(WANDER) == first  # 1.6 m of 7 m
        for _ in range(10):
            ground.do(first)
            if ground.last[1] is not None and ground.last[1].ok:
                break
            assert at(ground, actions).action(WANDER) == first
        drawn.add(str(first.target))
        at(ground, actions)
        ground.at = (0.0, 0.0)
        ground.look()
    assert drawn == {"shelf", "lamp"}


def test_a_thing_without_a_way_to_it_is_given_up() -> None:
    ground = Playground({"shelf": (2.0, 0.0)}, {}, broken=frozenset({"shelf"}))
    ground.look()
    actions = SixActions(0)
    action = at(ground, actions).action(WANDER)
    assert action == Action(WALK_TO, "shelf")
    ground.do(Action(WALK_TO, "shelf"))
    ground.map.frame = 10**6  # nothing is in sight any more
    at(ground, actions)
    assert actions.action(WANDER) is None


def test_seeds_determine_what_is_wandered_to() -> None:
    ground = Playground({f"box_{k}": (2.0, 0.1 * k) for k in range(9)}, {})
    ground.look()

    def drawn(seed: int) -> Action | None:
        actions = SixActions(seed)
        return at(ground, actions).action(WANDER)

    assert drawn(3) == drawn(3) and len({drawn(seed) for seed in range(20)}) > 5


def test_the_nearest_of_none_is_no_thing() -> None:
    metres = np.array([[3.0, 1.0, 2.0], [1.0, 2.0, 3.0]])
    number, least = nearest(metres, np.array([[True, False, True], [False, False, False]]))
    assert number.tolist() == [2, -1] and least.tolist() == [2.0, np.inf]
    assert nearest(np.zeros((2, 0)), np.zeros((2, 0), bool))[0].tolist() == [-1, -1]


@pytest.mark.parametrize("carts", [False, True])
def test_exploring_is_always_possible_and_one_hand_holds_one_thing(carts: bool) -> None:
    chance = np.random.default_rng(0)
    far = [np.where(chance.random(500) < 0.3, np.inf, chance.uniform(0.0, 4.0, 500)) for _ in range(2)]
    holding, goal = chance.random(500) < 0.5, chance.random(500) < 0.5
    made = possible(*far, np.full(500, carts), holding, goal)
    assert made.shape == (500, COUNT) and made[:, LOOK].all() and not (made[:, TAKE] & made[:, LET_GO]).any()
    assert (made[:, LET_GO] == (holding & (far[1] <= REACH) if carts else holding)).all()
