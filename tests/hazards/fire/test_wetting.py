"""Water wets a realistic fire by shares: what stands out of it burns on, wet things dry, drowned ones go out."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest
import torch

from hazard_ms.hazards import presets
from hazard_ms.hazards.fire.fire_state import BURNING, BURNT, NORMAL
from hazard_ms.hazards.fire.realistic import burners, wetting
from hazard_ms.hazards.fire.realistic.blaze import Blaze
from hazard_ms.hazards.fire.realistic.blaze_state import BlazeState
from hazard_ms.simulation.world import World
from tests.worlds.fire_worlds import room_world

REAL = presets.fire("realistic")
LATENT = 335.0 + 2257.0  # kJ/kg: water of 20 C to steam of 100 C


def still(depth: float) -> Callable[[torch.Tensor], torch.Tensor]:
    """Water everywhere, with its surface at `depth` [m]."""
    return lambda points: torch.full(points.shape[:2], depth)


def room(
    *bodies: tuple[str, tuple[float, float, float]], fires: Any = (), tall: float = 2.0
) -> tuple[BlazeState, World]:
    world = room_world(list(bodies), fires, size=(8.0, 8.0), extent=(1.0, 0.6, tall))
    assert isinstance(REAL, Blaze)
    state = BlazeState.allocate({"E": 1, "B": world.num_bodies, **REAL.sizes(world)}, world.device)
    REAL.reset(state, world, torch.arange(1))
    return state, world


def run(state: BlazeState, world: World, seconds: float) -> None:
    for _ in range(round(30 * seconds)):
        world.chance.tick()
        REAL.advance(state, world, 1 / 30)


def power(state: BlazeState, world: World) -> torch.Tensor:
    return burners.fires(state, world, REAL.growth, REAL.first_release, REAL.first_base, REAL.radiant).power[0]


@pytest.mark.parametrize(("depth", "left"), [(0.006, 0.997), (0.5, 0.75), (1.0, 0.5)])
def test_a_wardrobe_burns_above_the_water(depth: float, left: float) -> None:
    """FI-12: 6 mm of water take 0.3 % of the fire of a wardrobe of 2 m; half under water, it gives half of its heat."""
    state, world = room(("cabinet", (4.0, 4.0, 0.0)))
    state.status[:], state.burn_age[:], state.temperature[:] = BURNING, 100.0, 820.0
    whole = float(power(state, world)[0])
    world.fields["water"] = still(depth)
    wetting.soak(state, world)
    assert state.status.tolist() == [[BURNING]] and whole > 500.0
    assert float(power(state, world)[0]) == pytest.approx(left * whole, rel=1e-3)
    run(state, world, 2.0)
    assert state.status.tolist() == [[BURNING]]


def test_what_is_drowned_goes_out_for_good_and_what_is_wet_all_over_stays_below_boiling() -> None:
    state, world = room(("book", (4.0, 4.0, 0.0)), ("book", (4.0, 5.5, 0.0)), tall=0.04)
    state.status[:, 0], state.temperature[:] = BURNING, 300.0
    world.fields["water"] = still(0.05)
    run(state, world, 0.5)
    assert state.status.tolist() == [[BURNT, NORMAL]] and float(state.temperature.max()) <= 100.0
    assert not bool(power(state, world).any())


def test_wet_things_dry_by_the_heat_that_boils_their_film_away() -> None:
    """A quarter of a kilogram of water on each square metre: FILM LATENT / q, to a step."""
    state, _ = room(("book", (4.0, 4.0, 0.0)))
    state.wet[:] = 1.0
    flux, step, seconds = torch.tensor([[20.0]]), 0.05, 0.0
    while float(state.wet[0, 0]) > 0.0 and seconds < 100.0:
        state.temperature[:] = 250.0
        wetting.dry(state, flux, step)
        seconds += step
        if float(state.wet[0, 0]) >= wetting.SOAKED:
            assert float(state.temperature[0, 0]) == 100.0
    assert seconds == pytest.approx(0.25 * LATENT / 20.0, rel=0.01)
    assert float(state.temperature[0, 0]) == 250.0


def test_what_stands_in_water_does_not_dry_below_its_surface() -> None:
    state, world = room(("cabinet", (4.0, 4.0, 0.0)))
    world.fields["water"] = still(0.5)
    wetting.soak(state, world)
    for _ in range(1000):
        wetting.dry(state, torch.tensor([[100.0]]), 1.0)
    assert float(state.wet[0, 0]) == pytest.approx(0.25)


def test_a_held_thing_is_not_wetted() -> None:
    state, world = room(("book", (4.0, 4.0, 0.0)), tall=0.04)
    world.held[:] = True
    world.fields["water"] = still(0.5)
    wetting.soak(state, world)
    assert not bool(state.wet.any())


@pytest.mark.parametrize(("severity", "height"), [("moderate", 0.6), ("severe", 0.9), ("extreme", 1.8)])
def test_the_first_fire_burns_above_the_water_and_the_floor_does_not(severity: str, height: float) -> None:
    law = presets.fire("realistic", severity)
    assert isinstance(law, Blaze) and law.first_height == height
    world = room_world([], [(4.0, 4.0)], size=(8.0, 8.0))
    state = BlazeState.allocate({"E": 1, "B": world.num_bodies, **law.sizes(world)}, world.device)
    law.reset(state, world, torch.arange(1))
    world.fields["water"] = still(height / 3)
    wetting.soak(state, world)
    assert float(state.flame_dry[0, 0]) == pytest.approx(2 / 3)
    state.flame_cell[0, 1], state.flame_birth[0, 1] = 0, 0
    wetting.soak(state, world)
    assert int(state.flame_birth[0, 1]) == wetting.NEVER and int(state.flame_birth[0, 0]) == 0
    world.fields["water"] = still(0.97 * height)
    wetting.soak(state, world)
    assert int(state.flame_birth[0, 0]) == wetting.NEVER
