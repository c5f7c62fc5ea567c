"""Things that lie in a cart: W-16 of docs/physics.md 2.3, for carts anywhere and at any angle, alone and in batches."""

from __future__ import annotations

import math

import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from hazard_ms.hazards.presets import wind
from hazard_ms.scenes.assets.rows import Asset
from hazard_ms.scenes.assets.shipped import shipped_index
from hazard_ms.simulation.containers import container_index, in_containers
from hazard_ms.simulation.kernels.containers import BASKET_HIGH, BASKET_LOW
from hazard_ms.simulation.world import World
from tests.worlds.fire_worlds import about_z
from tests.worlds.wind_worlds import Block, Thing, begin, run, street

SIZE = (0.54, 0.94, 1.03)  # of a cart [m]


def cart(x: float = 8.0, y: float = 8.0, angle: float = 0.0) -> Block:
    return Block("cart", (x, y, 0.0), SIZE, about_z(angle))


def inside(world: World) -> list[bool]:
    return in_containers(world, container_index(world), torch.zeros_like(world.safe))[0].tolist()


def ball(*at: float, **more: object) -> Thing:
    return Thing((0.04, 0.04, 0.04), 0.1, at, **more)  # type: ignore[arg-type]


def test_carts_are_found_by_their_category() -> None:
    world = street([Thing(), Thing()], blocks=[Block("house", (1.0, 1.0, 0.0), (1.0, 1.0, 3.0)), cart(), cart(3.0)])
    assert container_index(world).tolist() == [[3, 4]]
    assert container_index(street([Thing()])).tolist() == [[-1]]
    assert inside(street([ball(0.0, 0.0, 0.0)])) == [False]


@settings(max_examples=60, deadline=None)
@given(
    angle=st.floats(-math.pi, math.pi),
    share=st.tuples(st.floats(-0.8, 0.8), st.floats(-0.8, 0.8), st.floats(-0.6, 0.6)),
    x=st.floats(2.0, 14.0),
    y=st.floats(2.0, 14.0),
)
def test_in_the_basket_or_beside_it(angle: float, share: tuple[float, float, float], x: float, y: float) -> None:
    """Points as shares of the cart's own axes, but not within 5 cm of an edge, where base and centre may differ."""
    edges = [(low * s, high * s) for low, high, s in zip(BASKET_LOW, BASKET_HIGH, SIZE, strict=True)]
    local = [f * s for f, s in zip(share, SIZE, strict=True)]
    if any(abs(v - e) < 0.05 for v, pair in zip(local, edges, strict=True) for e in pair):
        return
    c, s = math.cos(angle), math.sin(angle)
    at = (x + c * local[0] - s * local[1], y + s * local[0] + c * local[1], SIZE[2] / 2 + local[2])
    want = all(low < v < high for v, (low, high) in zip(local, edges, strict=True))
    assert inside(street([ball(*at)], blocks=[cart(1.0, 1.0), cart(x, y, angle)]))[0] == want


def test_under_over_and_beside_a_cart_is_not_inside() -> None:
    things = [
        ball(8.0, 8.0, 0.1),
        ball(8.0, 8.0, 1.2),
        ball(8.0, 8.6, 0.7),
        ball(8.4, 8.0, 0.7),
        ball(8.0, 8.0, 0.5),
        ball(8.0, 8.0, 0.8),
    ]
    assert inside(street(things, blocks=[cart()])) == [False, False, False, False, True, True, False]


def test_a_suitcase_on_its_head_lies_in_the_cart() -> None:
    world = street([Thing((0.4, 0.2, 0.6), 3.0, (8.0, 8.0, 0.0))], blocks=[cart()])
    world.rotation[0, 0], world.position[0, 0] = (
        torch.tensor([0.0, 1.0, 0.0, 0.0]),
        torch.tensor([8.0, 8.0, 0.48 + 0.3]),
    )
    assert inside(world)[0]


def test_what_is_held_or_put_away_lies_nowhere() -> None:
    world = street([ball(8.0, 8.0, 0.5)] * 3, blocks=[cart()])
    world.held[0, 0], world.away[0, 1] = True, True
    assert inside(world)[:3] == [False, False, True]


@pytest.mark.parametrize("copies", [1, 64])
@pytest.mark.parametrize("preset", ["paper", "shipped", "realistic"])
def test_w16_the_chain_settles_a_pile_one_layer_a_frame_and_for_ever(preset: str, copies: int) -> None:
    """A box in the basket, one on it, one on that, one beside the heap on the ground."""
    heights = (0.60, 1.00, 1.40, 0.0)
    things = [Thing((0.3, 0.3, 0.4), 1.0, (8.0, 8.0 if z else 9.0, z)) for z in heights]
    law, world = wind(preset), street(things, blocks=[cart(angle=0.4)], copies=copies)
    state = begin(law, world)
    seen = []
    for _ in range(4):
        run(law, state, world, 1)
        seen.append(state.settled[-1, :4].tolist())
    assert seen == [
        [True, False, False, False],
        [True, True, False, False],
        [True, True, True, False],
        [True, True, True, False],
    ]
    world.position[:, 1] = torch.tensor([3.0, 3.0, 0.2])  # even if it falls out
    world.velocity[:, 1] = torch.tensor([1.0, 0.0, 0.0])
    run(law, state, world, 5)
    push = law.force(state, world, 0.01)
    assert push.torque is not None
    assert (push.force[:, :3] == 0).all() and (push.torque[:, :3] == 0).all()
    assert (push.force[:, 3].norm(dim=-1) > 0).all() and (push.force[:, 4] == 0).all()


def test_nothing_settles_on_itself_or_on_what_has_not_settled() -> None:
    things = [Thing((0.3, 0.3, 0.4), 1.0, (4.0, 4.0, 0.0)), Thing((0.3, 0.3, 0.4), 1.0, (4.0, 4.0, 0.4))]
    assert inside(street(things, blocks=[cart()])) == [False, False, False]


def test_what_had_settled_and_lies_elsewhere_is_not_listed() -> None:
    """Nothing lies on itself."""
    world = street([ball(3.0, 3.0, 0.0), ball(8.0, 8.0, 0.6)], blocks=[cart()])
    assert in_containers(world, container_index(world), torch.ones_like(world.safe)).tolist() == [[False, True, False]]


@pytest.mark.parametrize("kind", [a for a in shipped_index().values() if a.category == "cart"], ids=lambda a: a.id)
def test_the_basket_is_the_hollow_of_every_cart_there_is(kind: Asset) -> None:
    """Rays from the middle of the basket to all six sides, against the cart's own collision boxes."""
    low, high = ([s * e for s, e in zip(share, kind.extent, strict=True)] for share in (BASKET_LOW, BASKET_HIGH))
    start = [0.0, -0.03, 0.6]
    for axis in range(3):
        others = [a for a in range(3) if a != axis]
        hit = [b for b in kind.boxes if all(abs(start[a] - b[a]) < b[3 + a] for a in others)]
        below = max(b[axis] + b[3 + axis] for b in hit if b[axis] < start[axis])
        above = [b[axis] - b[3 + axis] for b in hit if b[axis] > start[axis]] or [
            max(b[2] + b[5] for b in kind.boxes[1:5])
        ]
        shift = kind.extent[2] / 2 if axis == 2 else 0.0
        assert low[axis] + shift == pytest.approx(below, abs=0.015)
        assert high[axis] + shift == pytest.approx(min(above), abs=0.015)


def test_scenes_of_different_sizes_in_one_batch() -> None:
    """Padding is in no cart, and each scene has carts of its own."""
    worlds = [street([ball(8.0, 8.0, 0.5)] * n, blocks=[cart()] * c) for n, c in ((1, 2), (4, 1))]
    specs = tuple(w.specs[0] for w in worlds)
    extents = [[(0.04, 0.04, 0.04)] * len(s.bodies) + [SIZE] * len(s.fixtures) for s in specs]
    world = World.of(specs, extents, [[1.0] * len(s.things) for s in specs])
    found = in_containers(world, container_index(world), torch.zeros_like(world.safe))
    assert found.tolist() == [[True, False, False, False, False], [True, True, True, True, False]]
