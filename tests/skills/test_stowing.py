"""What a robot brings to a cart is let go in its basket, in real physics; what it cannot bring there it keeps."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
import pytest
import torch

from hazard_ms.skills import failures
from hazard_ms.skills.context import LowLevel, Skill, Stage
from hazard_ms.skills.decision import Result
from hazard_ms.skills.motor import stowing
from hazard_ms.skills.motor.arm import follow
from hazard_ms.skills.motor.grasping import come_near, pick_up
from hazard_ms.skills.motor.routes import Route
from hazard_ms.skills.motor.stowing import drop
from hazard_ms.skills.motor.surface import Leg, Surface
from hazard_ms.spec.registry import ROBOTS
from tests.worlds.arena import Arena, Box

SIZE = (0.56, 0.94, 1.02)  # of a cart [m]
X, RIM = 1.1, 0.885  # where the cart stands, and the height of its basket [m]
SIDE, END, WALL = 0.266, 0.44, 0.035  # distances of the basket's walls from its middle, and their thickness [m]
FLOOR = 0.51  # of the basket, which the arena takes for the cart's middle [m]
BACK = 0.5  # how much farther from the cart it may begin [m]
WALK = 62.0  # frames that the base takes to drive a metre [1/m]
LOW_FALL = 0.2  # most that a thing may fall to the rim [m]
CART = (
    Box("cart", (X, 0.0, FLOOR), (2 * SIDE, 2 * END, 0.04), target=False),
    *(Box(f"side_{s}", (X + s * SIDE, 0.0, RIM - 0.2), (WALL, 2 * END, 0.4), target=False) for s in (-1, 1)),
    *(Box(f"end_{s}", (X, s * END, RIM - 0.2), (2 * SIDE, WALL, 0.4), target=False) for s in (-1, 1)),
    Box("can", (0.0, -0.65, 0.06), (0.07, 0.07, 0.12), 0.3),
    Box("parcel", (0.0, 0.7, 0.1), (0.25, 0.2, 0.2), 1.0),
)


@pytest.fixture(scope="module", params=ROBOTS)
def street(request: pytest.FixtureRequest) -> Iterator[Arena]:
    made = Arena(CART, robot=request.param)
    yield made
    made.close()


def begin(street: Arena) -> int:
    """Start anew; the index of the cart, which the skills know by its whole size."""
    street.restart()
    cart = street.index("cart")
    street.world.extent[0, cart] = torch.tensor(SIZE)
    return cart


def let_go_at(street: Arena, cart: int) -> np.ndarray:
    """Drop what the hand holds into the `cart`; the place of its middle when the hand opened [m], [3]."""
    held, once, places = street.stage.held, type(street).step, []

    def step(action: LowLevel) -> None:
        once(street, action)
        if street.stage.held == held:
            places.append(street.stage.position(held))

    street.step = step  # type: ignore[method-assign]
    try:
        street.run(drop(street.stage, cart))
    finally:
        del street.step
    assert street.stage.held == -1
    return np.asarray(places[-1])


@pytest.mark.parametrize("name", ["can", "parcel"])
def test_a_thing_is_let_go_in_the_basket(street: Arena, name: str) -> None:
    cart = begin(street)
    index = street.index(name)
    assert street.run(pick_up(street.stage, index)).ok
    x, y, z = let_go_at(street, cart)
    half = float(street.world.extent[0, index, 2]) / 2
    assert abs(x - X) < SIDE and abs(y) < END
    assert z - half < RIM + LOW_FALL  # wind has no time to carry it past the walls


@pytest.mark.long
def test_from_farther_away_the_base_drives_on_while_the_arm_unfolds(street: Arena) -> None:
    frames = []
    for back in (0.0, BACK):
        cart = begin(street)
        index = street.index("can")
        assert street.run(pick_up(street.stage, index)).ok
        street.agent.place(torch.tensor([0]), torch.tensor([[-back, 0.0]]), torch.tensor([0.0]))
        began = street.stage.frame
        x, y, _ = let_go_at(street, cart)
        assert abs(x - X) < SIDE and abs(y) < END
        frames.append(street.stage.frame - began)
    assert frames[1] - frames[0] < 0.85 * WALK * BACK, frames


def test_the_base_has_time_for_the_whole_way_of_a_leg(street: Arena) -> None:
    """A metre takes longer than a movement of the arm may."""
    begin(street)
    street.agent.place(torch.tensor([0]), torch.tensor([[-3.0, 0.0]]), torch.tensor([0.0]))
    leg = Leg(street.stage.robot.arm(), 1.1)
    assert street.run(follow(street.stage, Route((leg,), 0.0, 0))).ok
    assert street.stage.robot.base()[0] == pytest.approx(-1.9, abs=0.05)


def test_a_second_try_begins_with_room_before_the_cart(street: Arena, monkeypatch: pytest.MonkeyPatch) -> None:
    cart = begin(street)
    assert street.run(pick_up(street.stage, street.index("can"))).ok
    lower, tries = stowing._lower_into, list[tuple[int, float]]()

    def failing_first(stage: Stage, cart: int, held: int, way: stowing.Way) -> Skill:
        tries.append((way.number, stage.robot.base()[0]))
        return (yield from lower(stage, cart, held, way)) if len(tries) > 1 else Result(False)

    monkeypatch.setattr(stowing, "_lower_into", failing_first)
    street.run(drop(street.stage, cart))
    assert street.stage.held == -1
    (first, near), (second, far) = tries
    assert first != second and near - far > 0.3


def test_the_way_down_into_a_basket_counts(street: Arena, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where the arm would lie in something once it is down, another posture is taken."""
    cart = begin(street)
    assert street.run(pick_up(street.stage, street.index("can"))).ok
    street.run(come_near(street.stage, street.stage.position(cart)))
    basket, hits = stowing._basket(street.stage, cart), Surface.hits
    chosen = stowing._way(street.stage, basket, street.stage.held, set())
    assert chosen is not None

    def hit(self: Surface, legs: Sequence[Leg], enough: float = np.inf) -> int:
        return 100 if np.array_equal(legs[-1].arm, chosen.arm) else hits(self, legs, enough)

    monkeypatch.setattr(Surface, "hits", hit)
    other = stowing._way(street.stage, basket, street.stage.held, set())
    assert other is not None and not np.array_equal(other.arm, chosen.arm)


def test_a_thing_stays_in_the_hand_where_no_basket_is_within_reach(street: Arena) -> None:
    cart = begin(street)
    index = street.index("can")
    assert street.run(pick_up(street.stage, index)).ok
    street.world.position[0, cart, 2] += 1.5  # a basket at 2.4 m
    result = street.run(drop(street.stage, cart))
    assert not result.ok and result.reason == failures.CART_UNREACHABLE
    assert street.stage.held == index and not np.isnan(street.stage.position(index)).any()


def test_a_drop_finds_out_within_reach_that_no_cart_is_there(street: Arena, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where an agent only believes one to be; from farther away it cannot tell."""
    cart = begin(street)
    index = street.index("can")
    assert street.run(pick_up(street.stage, index)).ok
    missed: list[int] = []
    monkeypatch.setattr(street.stage.labeller, "thing", lambda index: -1)
    monkeypatch.setattr(street.stage.labeller, "missed", missed.append)
    for back, found in ((3.0, []), (0.0, [cart])):
        street.agent.place(torch.tensor([0]), torch.tensor([[-back, 0.0]]), torch.tensor([0.5]))
        result = street.run(drop(street.stage, cart))
        assert not result.ok and result.reason == failures.CART_UNREACHABLE and street.stage.held == index
        assert missed == found and (result.frames > 0) == bool(found)  # it turns to the place
