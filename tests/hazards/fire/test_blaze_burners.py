"""The fires of a realistic fire: the kernel beside the laws in torch, and what does not burn left out."""

from __future__ import annotations

import math

import numpy as np
import pytest
import torch

from hazard_ms.hazards.fire.fire_state import BURNING
from hazard_ms.hazards.fire.realistic import burners, burning, fuels, radiation, smoke, touching
from hazard_ms.hazards.fire.realistic.blaze import Blaze
from hazard_ms.hazards.fire.realistic.blaze_state import BlazeState
from hazard_ms.simulation.world import World
from tests.worlds.fire_worlds import room_world

REAL = Blaze()
NAMES = ("book", "sofa", "throw_pillow", "apple", "pan", "box")
COPIES = 40
SIZE = (0.4, 0.3, 0.3)  # of things [m]


@pytest.fixture
def burning_rooms() -> tuple[BlazeState, World]:
    """Rooms in which things of all kinds burn, those with a measured curve, too, and flames of all ages."""
    draw = torch.Generator().manual_seed(0)
    places = [(name, (1.0 + 0.4 * k, 1.0 + 0.3 * (k % 4), 0.1)) for k, name in enumerate(NAMES)]
    world = room_world(places, [(2.0, 2.0), (1.2, 2.6)], copies=COPIES)
    state = BlazeState.allocate({"E": COPIES, "B": world.num_bodies, **REAL.sizes(world)}, "cpu")
    REAL.reset(state, world, torch.arange(COPIES))

    def drawn(like: torch.Tensor, most: float) -> torch.Tensor:
        return most * torch.rand(like.shape, generator=draw)

    state.status[:] = torch.where(drawn(state.burn_age, 1.0) < 0.7, BURNING, state.status)
    state.curve[:] = (drawn(state.burn_age, 1.0) * (len(fuels.CURVES) + 1)).long() - 1
    state.burn_age[:] = drawn(state.burn_age, 1500.0)
    world.extent[:] = 0.2 + drawn(world.extent, 0.3)
    world.safe[:] = drawn(state.burn_age, 1.0) < 0.1
    cells = torch.arange(state.flame_cell.shape[1])
    state.flame_cell[:] = torch.where(cells < 30, cells, -1)
    state.flame_birth[:] = torch.where(cells < 20, 0, 5)
    state.flame_age[:] = drawn(state.flame_age, 90.0) - 5.0
    state.flame_place[:] = torch.tensor([2.0, 2.0, 0.0]) + drawn(state.flame_place, 1.0)
    state.flame_peak[:, 2:] = burners.CELL_RELEASE
    return state, world


def all_fires(state: BlazeState, world: World) -> radiation.Fires:
    return burners.fires(state, world, REAL.growth, REAL.first_release, REAL.first_base, REAL.radiant)


def test_the_kernel_gives_the_bits_of_the_laws(burning_rooms: tuple[BlazeState, World]) -> None:
    state, world = burning_rooms
    fires, things = all_fires(state, world), world.num_bodies
    alight = world.exists & ~world.safe & (state.status == BURNING)
    assert 0.5 < float(alight.float().mean()) < 0.9 and bool((state.curve[alight] >= 0).any())
    assert torch.equal(fires.power[:, :things], burning.release(state.course, state.burn_age) * alight)
    assert torch.equal(fires.radiant[:, :things], burning.radiant(state.curve, REAL.radiant))
    extent = world.extent.numpy()  # float32, whose square root numpy rounds correctly
    disc = np.sqrt(np.float32(4.0 / math.pi) * extent[..., 0] * extent[..., 1])
    assert len(np.unique(disc)) > COPIES and np.array_equal(fires.diameter[:, :things].numpy(), disc)
    bottom = world.position[0] - torch.tensor([0.0, 0.0, 0.5]) * world.extent[0]
    assert torch.allclose(fires.place[0, :things], bottom, atol=1e-6)


def test_flames_on_the_floor_grow_from_their_birth_on(burning_rooms: tuple[BlazeState, World]) -> None:
    """Those of the start share `first_release`; later ones give off as much as their cell can."""
    state, world = burning_rooms
    power, things = all_fires(state, world).power, world.num_bodies
    for k in (0, 1, 7, 19):
        part = 0.5 if k < 2 else 1.0
        most = part * REAL.first_release if k < 2 else burners.CELL_RELEASE
        expected = (REAL.growth * part * state.flame_age[:, k].clamp(min=0).double() ** 2).clamp(max=most)
        assert torch.allclose(power[:, things + k].double(), expected, rtol=1e-5)
    assert not power[:, things + 20 :].any() and bool(power[:, things : things + 20].any())
    world.chance.frame += 5
    assert bool(all_fires(state, world).power[:, things + 20 : things + 30].any())


@pytest.mark.parametrize("rows", [slice(0, 1), slice(0, COPIES)])
def test_what_does_not_burn_changes_no_bit(
    burning_rooms: tuple[BlazeState, World], rows: slice, monkeypatch: pytest.MonkeyPatch
) -> None:
    state, world = burning_rooms
    fires = radiation.Fires(*(v[rows] for v in all_fires(state, world)))
    points, height = world.position[rows] + torch.tensor([0.1, 0.0, 0.4]), state.height[rows]

    class Some:
        walls = world.walls.part(rows)
        position, rotation, extent = world.position[rows], world.rotation[rows], world.extent[rows]

    def seen() -> list[torch.Tensor]:
        return [smoke.above(fires, Some.walls, points, 20.0), touching.touched(fires, Some(), height)]  # type: ignore[arg-type]

    few, number = radiation.alight(fires)
    assert bool((few.power > 0).any(0).all()) and len(number) < fires.power.shape[1]
    found = seen()
    assert bool(found[0].any()) and bool(found[1].any()) and not bool(found[1].all())
    numbers = torch.arange(fires.power.shape[1])
    monkeypatch.setattr(smoke, "alight", lambda fires: (fires, numbers))
    monkeypatch.setattr(radiation, "alight", lambda fires: (fires, numbers))
    assert all(torch.equal(a, b) for a, b in zip(found, seen(), strict=True))


def test_where_nothing_burns_nothing_is_warmed(burning_rooms: tuple[BlazeState, World]) -> None:
    state, world = burning_rooms
    fires = all_fires(state, world)
    cold = fires._replace(power=torch.zeros_like(fires.power))
    assert (
        not smoke.above(cold, world.walls, world.position, 20.0).any()
        and not touching.touched(cold, world, state.height).any()
    )


def test_a_thing_is_not_touched_by_its_own_flames() -> None:
    world = room_world([("sofa", (1.0, 1.0, 0.0)), ("book", (3.0, 3.0, 0.0))], [], extent=SIZE)
    place = torch.cat([world.base_of(world.position, world.rotation, world.extent), torch.zeros(1, 1, 3)], 1)
    alone = radiation.Fires(place, torch.tensor([[500.0, 0.0, 0.0]]), torch.full((1, 3), 0.35), torch.ones(1, 3))
    assert touching.touched(alone, world, torch.tensor([2.6])).tolist() == [[False, False]]
    world.position[0, 1, :2] = world.position[0, 0, :2] + torch.tensor([0.1, 0.0])
    assert touching.touched(alone, world, torch.tensor([2.6])).tolist() == [[False, True]]
