"""The plain data of things, scenes and robots: what its few functions compute."""

from __future__ import annotations

import pytest

from hazard_ms.spec.catalogue import CATEGORIES
from hazard_ms.spec.robot import Build
from hazard_ms.spec.scene import AgentStart, Body, Fixture, Parameter, Room, SceneSpec

ORIGIN = (0.0, 0.0, 0.0)
SCENE = SceneSpec(
    name="room/00",
    room=Room((4.0, 4.0)),
    fixtures=(Fixture("cart_1", "cart", "cart_1", ORIGIN), Fixture("apple_tree", "tree", "tree_1", ORIGIN)),
    bodies=(Body("apple_1", "apple", "apple_1", ORIGIN), Body("pan_1", "pan", "pan_1", ORIGIN)),
    target_categories=("apple", "tree"),
    fires=(),
    agent_start=AgentStart((2.0, 2.0)),
    parameters=(Parameter("dust", "speed", 3.0), Parameter("ash", "speed", 7.0)),
)
BUILD = Build(
    mass=100.0,
    width=0.5,
    drag_area=0.7,
    friction=0.6,
    forward_step=0.016,
    turn_step=0.1,
    arm_step=0.1,
    radius=0.3,
    shoulder=(0.2, 0.8),
    reach=1.0,
    elbow_room=0.7,
    nearest=0.4,
)


def test_what_is_worth_much_burns_or_bears_water() -> None:
    """Rows of the paper's table of attributes (docs/benchmark.md 1)."""
    laptop, banana, book, bottle = (CATEGORIES[name] for name in ("laptop", "banana", "book", "bottle"))
    assert (laptop.value, banana.value, book.value, bottle.value) == (5, 1, 5, 1)
    assert [c.flammable for c in (banana, book, bottle)] == [True, True, False]
    assert [c.waterproof for c in (banana, book, bottle)] == [True, False, True]


def test_targets_are_the_bodies_of_their_categories_and_containers_are_carts() -> None:
    assert [b.name for b in SCENE.targets] == ["apple_1"]
    assert [f.name for f in SCENE.containers] == ["cart_1"]
    assert [t.name for t in SCENE.things] == ["apple_1", "pan_1", "cart_1", "apple_tree"]


def test_a_parameter_belongs_to_its_hazard() -> None:
    assert SCENE.parameter("dust", "speed", 0.0) == 3.0
    assert SCENE.parameter("ash", "speed", 0.0) == 7.0
    assert SCENE.parameter("rain", "speed", 0.5) == 0.5


def test_an_arm_reaches_less_far_above_and_below_its_shoulder() -> None:
    """Pythagoras: 0.6 m above or below the shoulder leaves 0.8 m of an arm of 1 m."""
    for height, far in ((0.8, 1.2), (1.4, 1.0), (0.2, 1.0)):
        assert BUILD.span(height) == pytest.approx((0.4, far)), height
    assert BUILD.span(2.0) == (0.4, 0.0)  # out of reach
