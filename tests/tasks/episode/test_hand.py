"""The assisted grasp without a simulator: what is taken, how it is carried, where it goes when it is let go.

Numbers by hand.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from torch import Tensor

from hazard_ms.simulation.world import World, rotate
from hazard_ms.spec import AgentStart, Body, Fixture, Room, SceneSpec
from hazard_ms.tasks.episode.episode import Episode
from hazard_ms.tasks.episode.grasp import Hand, conjugate, distance_to_boxes, graspable, multiply, places, update
from tests.worlds.fire_worlds import repeat

HALF = math.sqrt(0.5)
UPRIGHT = (1.0, 0.0, 0.0, 0.0)
LEFT = (HALF, 0.0, 0.0, HALF)  # a quarter turn about z: x becomes y
TIPPED = (HALF, HALF, 0.0, 0.0)  # a quarter turn about x: y becomes z
CUP, CAN, BOOK, LYING, TABLE = range(5)  # along B
SIZES = [(0.1, 0.1, 0.2), (0.1, 0.1, 0.2), (0.1, 0.1, 0.2), (0.1, 0.1, 0.6), (0.1, 0.1, 0.2)]


def shop(copies: int = 1) -> World:
    """Two targets 0.3 m apart; a book that is not one; a target 0.6 m long that lies along y; a table.

    All but that one upright.
    """
    bodies = (
        Body("cup", "bottle", "", (1.0, 0.0, 0.0)),
        Body("can", "bottle", "", (1.3, 0.0, 0.0)),
        Body("book", "book", "", (3.0, 0.0, 0.0)),
        Body("lying", "bottle", "", (5.0, 0.3, 0.05), TIPPED),  # its base faces +y, its middle is at y = 0
    )
    table = Fixture("table", "table", "", (4.0, 0.0, 0.0))
    spec = SceneSpec("shop", Room((8.0, 8.0)), (table,), bodies, ("bottle",), (), AgentStart((0.0, 0.0)))
    return repeat(World.of((spec,), [SIZES], [[1.0] * 5]), copies)


def empty_hand(world: World) -> Hand:
    return Hand.allocate({"E": world.num_envs, "B": world.num_bodies}, "cpu")


def at(*point: float) -> Tensor:
    return torch.tensor([point])


def close(hand: Hand, world: World, point: Tensor, turn: tuple[float, ...] = UPRIGHT, shut: bool = True) -> int:
    """Play one frame with the gripper at `point`; return what was let go."""
    return int(update(hand, world, point, torch.tensor([turn]), torch.tensor([shut]))[0])


@pytest.mark.parametrize(
    ("point", "taken"),
    [
        ((1.0, 0.0, 0.1), CUP),  # within it
        ((1.0, 0.0, 0.349), CUP),  # 0.149 m above its top
        ((1.0, 0.0, 0.351), -1),
        ((0.801, 0.0, 0.1), CUP),  # 0.149 m before its side
        ((0.799, 0.0, 0.1), -1),
        ((0.95 - 0.09, 0.05 + 0.11, 0.1), CUP),  # hypot(0.09, 0.11) = 0.142 m off its edge
        ((0.95 - 0.11, 0.05 + 0.11, 0.1), -1),  # 0.156 m
        ((1.14, 0.0, 0.1), CUP),  # 0.09 m from the cup, 0.11 m from the can
        ((1.16, 0.0, 0.1), CAN),
        ((3.0, 0.0, 0.1), -1),  # a book is not a target here
        ((4.0, 0.0, 0.1), -1),  # nor is a table
        ((5.0, 0.44, 0.05), LYING),  # 0.14 m beyond its end; were it upright, the middle would be 0.39 m away
        ((5.0, 0.0, 0.35), -1),  # 0.25 m above it; were it upright, within it
    ],
)
def test_the_nearest_target_within_15_cm_of_its_box_is_taken(point: tuple[float, float, float], taken: int) -> None:
    world = shop()
    hand = empty_hand(world)
    assert close(hand, world, at(*point)) == -1
    assert hand.held.tolist() == [taken]
    assert world.held[0].nonzero().flatten().tolist() == ([] if taken < 0 else [taken])


def test_what_is_safe_or_does_not_exist_cannot_be_taken() -> None:
    world = shop(copies=3)
    world.safe[1, CUP], world.exists[2, CUP] = True, False
    assert graspable(world, at(1.0, 0.0, 0.1).expand(3, 3)).tolist() == [CUP, -1, -1]


def test_it_takes_and_lets_go_only_when_the_command_changes() -> None:
    world = shop()
    hand = empty_hand(world)
    close(hand, world, at(0.0, 0.0, 1.0))  # shuts on nothing
    close(hand, world, at(1.0, 0.0, 0.1))  # passes the cup, still shut
    assert hand.held.tolist() == [-1]
    close(hand, world, at(1.0, 0.0, 0.1), shut=False)
    close(hand, world, at(1.0, 0.0, 0.1))
    close(hand, world, at(1.3, 0.0, 0.1))  # passes the can with the cup
    assert hand.held.tolist() == [CUP]
    assert close(hand, world, at(2.0, 0.0, 1.0), shut=False) == CUP
    assert hand.held.tolist() == [-1] and not world.held.any()
    assert close(hand, world, at(2.0, 0.0, 1.0), shut=False) == -1  # only once


def test_hands_of_different_environments_do_not_touch_each_other() -> None:
    """All are at the cup.

    The first shuts, the second stays open, the third lets go of a can, the fourth was shut on nothing.
    """
    world = shop(copies=4)
    hand = empty_hand(world)
    hand.held[2], hand.closed[2:], world.held[2, CAN] = CAN, True, True
    shut = torch.tensor([True, False, False, True])
    dropped = update(hand, world, at(1.0, 0.0, 0.1).expand(4, 3), torch.tensor([UPRIGHT] * 4), shut)
    assert dropped.tolist() == [-1, -1, CAN, -1]
    assert hand.held.tolist() == [CUP, -1, -1, -1] and hand.closed.tolist() == [True, False, False, True]
    assert world.held.nonzero().tolist() == [[0, CUP]]


@pytest.mark.parametrize(
    ("take", "turn", "carry", "turned", "base", "rotation"),
    [
        # from 0.1 m above the top: drawn up by 0.1 m, so the base hangs 0.2 m below the gripper
        ((1.0, 0.0, 0.3), UPRIGHT, (2.0, 3.0, 1.0), UPRIGHT, (2.0, 3.0, 0.8), UPRIGHT),
        # the same, the gripper then tipped: below becomes +y
        ((1.0, 0.0, 0.3), UPRIGHT, (2.0, 3.0, 1.0), TIPPED, (2.0, 3.2, 1.0), TIPPED),
        # the same, the gripper then turned left: the cup turns with it, below stays below
        ((1.0, 0.0, 0.3), UPRIGHT, (0.0, 0.0, 1.0), LEFT, (0.0, 0.0, 0.8), LEFT),
        # from 0.1 m before its side with the gripper turned left: drawn in to 0.05 m ahead, base 0.1 m below
        ((0.85, 0.0, 0.1), LEFT, (0.0, 0.0, 1.0), LEFT, (0.05, 0.0, 0.9), UPRIGHT),
        # then the gripper turned back: what was ahead along x is now ahead along -y
        ((0.85, 0.0, 0.1), LEFT, (0.0, 0.0, 1.0), UPRIGHT, (0.0, -0.05, 0.9), (HALF, 0.0, 0.0, -HALF)),
        # from inside: it stays where it is in the hand
        ((1.0, 0.0, 0.15), UPRIGHT, (0.0, 0.0, 1.0), UPRIGHT, (0.0, 0.0, 0.85), UPRIGHT),
    ],
)
def test_what_is_held_follows_the_gripper(
    take: tuple[float, ...],
    turn: tuple[float, ...],
    carry: tuple[float, ...],
    turned: tuple[float, ...],
    base: tuple[float, ...],
    rotation: tuple[float, ...],
) -> None:
    world = shop()
    hand = empty_hand(world)
    close(hand, world, at(*take), turn)
    frozen, bases, turns = places(hand, world, at(*carry), torch.tensor([turned]))
    assert frozen[0].nonzero().flatten().tolist() == [CUP]
    assert bases[0, CUP].tolist() == pytest.approx(base, abs=1e-6)
    assert turns[0, CUP].tolist() == pytest.approx(rotation, abs=1e-6)
    assert bases[0, CAN].tolist() == pytest.approx((1.3, 0.0, 0.0), abs=1e-6)  # all others stay
    assert bases[0, LYING].tolist() == pytest.approx((5.0, 0.3, 0.05), abs=1e-6)


def test_what_is_in_the_bag_waits_ten_metres_below_where_it_was() -> None:
    world = shop()
    world.away[0, CUP] = True
    frozen, bases, turns = places(empty_hand(world), world, at(0.0, 0.0, 1.0), torch.tensor([LEFT]))
    assert frozen[0].nonzero().flatten().tolist() == [CUP]
    assert bases[0, CUP].tolist() == [1.0, 0.0, -10.0] and turns[0, CUP].tolist() == list(UPRIGHT)


quaternions = (
    st.lists(st.floats(-1.0, 1.0), min_size=4, max_size=4)
    .filter(lambda q: float(np.linalg.norm(q)) > 0.1)
    .map(lambda q: tuple((np.array(q) / np.linalg.norm(q)).tolist()))
)
points = st.tuples(st.floats(-2.0, 2.0), st.floats(-2.0, 2.0), st.floats(0.0, 2.0))
near = st.tuples(st.floats(0.85, 1.14), st.floats(-0.15, 0.15), st.floats(0.0, 0.3))


@given(near, quaternions, points, quaternions)
@settings(max_examples=200, deadline=None)
def test_carrying_is_rigid(take: tuple, turn: tuple, carry: tuple, turned: tuple) -> None:
    """However a thing is taken and carried: never farther from the gripper than before, and always equally far."""
    world = shop()
    hand = empty_hand(world)
    before = float(distance_to_boxes(world, at(*take))[0, CUP])
    close(hand, world, at(*take), turn)
    if hand.held.tolist() != [CUP]:
        assert before > 0.15
        return
    gaps = []
    for point, rotation in ((take, turn), (carry, turned)):
        _, base, world_turn = places(hand, world, at(*point), torch.tensor([rotation]))
        moved = shop()
        moved.rotation[0, CUP] = world_turn[0, CUP]
        moved.position[0, CUP] = base[0, CUP] + rotate(world_turn[0, CUP], torch.tensor([0.0, 0.0, 0.1]))
        gaps.append(float(distance_to_boxes(moved, at(*point))[0, CUP]))
    assert gaps[0] <= before + 1e-5
    assert gaps[1] == pytest.approx(gaps[0], abs=1e-5)


@given(quaternions, quaternions, points)
@settings(max_examples=100, deadline=None)
def test_quaternions_multiply_as_rotations_do(a: tuple, b: tuple, vector: tuple) -> None:
    first, then, v = (torch.tensor(x, dtype=torch.float64) for x in (b, a, vector))
    assert torch.allclose(rotate(multiply(then, first), v), rotate(then, rotate(first, v)), atol=1e-9)
    assert torch.allclose(rotate(conjugate(then), rotate(then, v)), v, atol=1e-9)
    assert torch.equal(rotate(then, v, back=True), rotate(conjugate(then), v))


@pytest.mark.parametrize(("bag", "rescued"), [((2.0, 0.44, 1.0), True), ((2.0, 0.46, 1.0), False)])
def test_letting_go_over_the_bag_is_a_rescue_and_elsewhere_is_none(
    bag: tuple[float, float, float], rescued: bool
) -> None:
    """The bag's mouth is wide enough for 0.45 m. The cup is taken in frame 1 and let go in frame 3."""
    world = shop()
    episode = Episode(world, ())
    turn, elsewhere = torch.tensor([UPRIGHT]), at(9.0, 9.0, 9.0)
    frames = (((1.0, 0.0, 0.1), True), ((2.0, 0.0, 1.0), True), ((2.0, 0.0, 1.0), False), ((2.0, 0.0, 1.0), False))
    for number, (point, shut) in enumerate(frames):
        episode.advance(1 / 30)
        mouth = at(*bag) if number >= 2 else elsewhere
        episode.use_hand((at(*point), turn), torch.tensor([shut]), lambda mouth=mouth: mouth)
        assert world.held[0].any() == (number < 2) and not (world.safe.any() and number < 2)
    assert world.safe[0].nonzero().flatten().tolist() == ([CUP] if rescued else [])
    assert episode.rescue.frame[0].tolist() == [3 if rescued else -1, -1, -1, -1, -1]
    assert not episode.rescue.damaged.any()
    close(episode.hand, world, at(1.0, 0.0, 0.1))  # where it was: it can be taken again only if it was not rescued
    assert episode.hand.held.tolist() == [-1 if rescued else CUP]


@pytest.mark.parametrize(("others", "taken"), [([BOOK], CUP), ([CUP], -1), ([], CUP)])
def test_a_hand_takes_nothing_out_of_another_hand(others: list[int], taken: int) -> None:
    """Not even the next target, 0.3 m away: it has reached for the cup."""
    world = shop()
    hand, elsewhere = empty_hand(world), torch.zeros(1, 5, dtype=torch.bool)
    elsewhere[0, others] = True
    update(hand, world, at(1.0, 0.0, 0.1), torch.tensor([UPRIGHT]), torch.tensor([True]), elsewhere)
    assert int(hand.held[0]) == taken
