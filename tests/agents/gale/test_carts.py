"""Carts that are taken along: which pushes are possible, how long they take, and when one is chosen."""

from __future__ import annotations

import dataclasses
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from hazard_ms.agents.gale.aims import GaleAims
from hazard_ms.agents.gale.carts import FAILURES, Pushing, pushes
from hazard_ms.hazards.presets import gale
from hazard_ms.sketch.planning.travel import StaticTravel
from hazard_ms.skills.decision import WALK_TO, Action, Result
from tests.agents.gale.test_aims import NAMES, ahead, aims, brief, decision

THINGS = NAMES[:3]  # at (2, 0), (0, 2) and (2, 1); the cart is at (8, 0), the robot at (0, 0)


def now(**changes: Any) -> Any:
    """The decision of the tests of aims, with a cart that can be pushed."""
    told = {"containers": ("cart_1",), "walked_up_to": None, "max_frames": 3000}
    return SimpleNamespace(**{**vars(decision()), **told, **changes})


def far_from_the_cart() -> Any:
    """The outlook of the tests of aims until frame 1700, with 500 frames from the cart to all others, too."""
    made = ahead()
    table = made.frames.copy()
    table[3, :3] = 500.0
    problem = dataclasses.replace(made.problem, travel=StaticTravel(table, 1), limit=1700.0)
    return dataclasses.replace(made, problem=problem, frames=table)


def test_pushes_lead_to_things_that_are_far_from_the_cart() -> None:
    """8 m to the cart and 6 m less 1.6 m with it are 769 frames; 600 of them are one push, and each grip takes 75."""
    (first, *rest) = pushes(now(), THINGS)
    assert (first.thing, len(rest)) == ("suitcase_1", 2)
    assert first.frames == pytest.approx(62.0 * (8.0 + 4.4) + 2 * 75.0, abs=30.0)
    assert first.place == pytest.approx((3.6, 0.0), abs=0.3) and first.robot == pytest.approx((2.5, 0.0), abs=0.3)
    near = now(map=decision(places=((6.0, 0.0), (0.0, 2.0), (2.0, 1.0), (8.0, 0.0))).map)
    assert [push.thing for push in pushes(near, THINGS)] == ["phone_1", "soda_can_1"]


def test_a_push_must_be_five_percent_better_and_is_gone_on_with_while_it_is_not_worse() -> None:
    pushing = Pushing()

    def chosen(told: Any, worth: float) -> Action | None:
        return pushing.choose(told, THINGS, lambda: 10.0, lambda push: worth if push.thing == "phone_1" else 0.0)

    begun = Action("push", "phone_1")
    assert chosen(now(), 10.4) is None
    assert chosen(now(), 10.6) == begun
    unfinished = now(last_action=begun, last_result=Result(False, "max_frames", 600))
    assert chosen(unfinished, 9.6) == begun
    assert chosen(unfinished, 9.4) is None
    walking = now(last_action=Action(WALK_TO, "phone_1"), last_result=Result(False, "max_frames", 100))
    assert chosen(walking, 20.0) is None  # it is on its way to a rescue
    assert chosen(now(held="phone_1"), 20.0) is None
    for _ in range(FAILURES):
        assert chosen(now(), 20.0) == begun
        chosen(now(last_action=begun, last_result=Result(False, "blocked", 90)), 0.0)
    assert chosen(now(), 20.0) is None


def test_the_cart_comes_where_targets_lie_far_from_it() -> None:
    """The phone stays. Rescues take 710 and 1110 frames, so there is one by 1700; beside the cart, both are done."""
    outlook = far_from_the_cart()
    for speed, pushed in ((1.2, True), (0.2, False)):
        known = aims(speed)
        known.see(now())
        action = known.push(now(), known.aimed(now(), outlook))
        assert (action is not None and action.verb == "push") is pushed, speed


def test_a_cart_that_was_given_up_is_not_pushed() -> None:
    """The nearest cart is the one that a push moves; plans count on another one."""
    outlook, known = far_from_the_cart(), aims()
    known.see(now())
    assert known.push(now(), outlook) is not None
    assert known.push(now(), dataclasses.replace(outlook, carts=("cart_2",))) is None


def test_without_measures_nothing_is_pushed_or_put_into_the_lee() -> None:
    plain = GaleAims(brief(gale("paper")), mitigate=False)
    plain._weather = aims()._weather
    aimed = plain.aimed(now(), far_from_the_cart())
    assert aimed.problem.travel.carts == 1 and plain.push(now(), aimed) is None
    assert plain.put_away(decision(held="suitcase_1"), np.inf) is None
