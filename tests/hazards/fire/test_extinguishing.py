"""Extinguishers: what their jets reach, how a fire of the paper shrinks, and what films do to a realistic fire."""

from __future__ import annotations

import math
from typing import Any

import pytest
import torch

from hazard_ms.hazards import presets
from hazard_ms.hazards.fire.fire import Fire
from hazard_ms.hazards.fire.fire_state import BURNING, BURNT, NORMAL, FireState
from hazard_ms.hazards.fire.realistic import burners, extinguishing
from hazard_ms.hazards.fire.realistic.blaze import Blaze
from hazard_ms.hazards.fire.realistic.blaze_state import BlazeState
from hazard_ms.simulation.jet import Jet, spray
from hazard_ms.simulation.walls import Walls
from hazard_ms.simulation.world import World
from hazard_ms.spec.extinguishers import CRIB, EXTINGUISHERS
from tests.worlds.fire_worlds import room_world

REAL = presets.fire("realistic")
ROW = torch.arange(1)
LATENT, FLAMES = 335.0 + 2257.0, 30.0  # kJ/kg, kW/m^2: water of 20 C to steam; flux of flames on what burns
NOZZLE = (1.0, 4.0, 1.0)


def point(*place: float) -> torch.Tensor:
    return torch.tensor([place])


def fight(world: World, kind: str, towards: tuple[float, float, float], place: Any = NOZZLE) -> Jet:
    world.jets = [Jet.closed(1)]
    world.jets[0].open(ROW, kind, point(*place), point(*towards))
    return world.jets[0]


def room(*bodies: Any, fires: Any = (), law: Fire | Blaze = REAL, extent: Any = (1.0, 0.6, 2.0)) -> tuple[Any, World]:
    world = room_world(list(bodies), fires, size=(8.0, 8.0), extent=extent)
    state = law.state_type.allocate({"E": 1, "B": world.num_bodies, **law.sizes(world)}, world.device)
    law.reset(state, world, ROW)
    return state, world


def frames_until(done: Any, state: Any, world: World, law: Any, most: int = 400) -> int:
    for frame in range(most):
        if done():
            return frame
        world.chance.tick()
        law.advance(state, world, 1 / 30)
    return most


def test_a_jet_is_a_cone_that_ends_at_its_reach() -> None:
    """2 kg of powder in 12 s, 3 m away, on a disc of the radius 3 tan 0.12."""
    jet = Jet.closed(1)
    jet.open(ROW, "powder", point(1.0, 4.0, 1.0), point(2.0, 4.0, 1.0))
    radius = 3.0 * math.tan(0.12)
    places = [(4.0, 4.0 + 0.99 * radius, 1.0), (4.0, 4.0, 1.0 - 1.01 * radius), (5.6, 4.0, 1.0), (0.5, 4.0, 1.0)]
    found = spray(jet, Walls.none(1), torch.tensor([places]))[0]
    assert found.tolist() == pytest.approx([(2.0 / 12.0) / (math.pi * radius**2), 0.0, 0.0, 0.0], rel=1e-5)
    wall = Walls(True, torch.tensor([[[0.0, 2.5, 0.05]]]), Walls.none(1).doorway)
    assert not bool(spray(jet, wall, torch.tensor([places])).any())
    jet.close(ROW)
    assert not bool(spray(jet, Walls.none(1), torch.tensor([places])).any())


def test_wrong_extinguishers_and_aims_are_refused() -> None:
    jet = Jet.closed(1)
    with pytest.raises(ValueError, match=r"extinguisher must be one of water, powder, co2, small_powder, got 'sand'"):
        jet.open(ROW, "sand", point(0.0, 0.0, 0.0), point(1.0, 0.0, 0.0))
    with pytest.raises(ValueError, match="towards must differ from the place of the nozzle"):
        jet.open(ROW, "water", point(1.0, 0.0, 0.0), point(1.0, 0.0, 0.0))


@pytest.mark.parametrize("preset", ["paper", "shipped"])
def test_the_largest_flame_of_the_paper_goes_out_in_35_frames_for_good(preset: str) -> None:
    law = presets.fire(preset)
    state, world = room(fires=[(4.0, 4.0), (4.0, 6.0)], law=law)
    assert isinstance(state, FireState)
    state.flame_birth[0, :2] = world.frame - 5000
    jet = fight(world, "powder", (4.0, 4.0, 0.0))
    assert frames_until(lambda: int(state.flame_birth[0, 0]) > 10**9, state, world, law) == 35
    jet.close(ROW)
    frames_until(lambda: False, state, world, law, 200)
    assert int(state.flame_birth[0, 0]) > 10**9 and int(state.flame_birth[0, 1]) < 0


def test_a_thing_of_the_paper_burns_again_only_once_it_is_heated_anew() -> None:
    law = presets.fire("paper")
    state, world = room(("book", (4.0, 4.0, 0.0)), fires=[(4.3, 4.3)], law=law, extent=(0.2, 0.2, 0.1))
    state.status[:], state.burn_updates[:], state.temperature[:] = BURNING, 100, 600.0
    jet = fight(world, "water", (4.0, 4.0, 0.05))
    took = frames_until(lambda: int(state.status[0, 0]) == NORMAL, state, world, law)
    assert 28 <= took <= 36 and float(state.temperature[0, 0]) <= 600.0
    frames_until(lambda: False, state, world, law, 5)
    assert float(state.temperature[0, 0]) <= 100.0 + 0.03 * 500.0
    jet.close(ROW)
    threshold = float(state.threshold[0, 0])
    again = frames_until(lambda: int(state.status[0, 0]) == BURNING, state, world, law, 2000)
    assert again > 60 and threshold > 100.0


def out(state: BlazeState) -> bool:
    return int(state.status[0, 0]) == BURNT


def test_water_puts_out_as_much_as_it_is_rated_for() -> None:
    """EN 3-7: 6 litres put out a crib 8A, not 21A. A block with the surface of the crib stands for it; all water hits.

    (rate - what boils) t = 0.95 of the film: (m / (S f) - q / (f L)) t = 0.95.
    """
    water = EXTINGUISHERS["water"]
    for rating, success in ((8, True), (21, False)):
        surface = CRIB * rating
        edge = math.sqrt(surface / 6.0)
        state, world = room(("cabinet", (4.0, 4.0, 0.0)), extent=(edge, edge, edge))
        state.status[:], state.peak[:], state.growth[:], state.curve[:] = BURNING, 800.0, 100.0, -1
        state.burn_age[:], state.decline[:], state.burn_end[:] = 100.0, 1e6, 2e6
        state.roofed[:] = 0.0
        fight(world, "water", (4.0, 4.0, edge / 2), (1.5, 4.0, edge / 2))
        net = (water.charge / water.seconds) / (surface * water.film) - FLAMES / (water.film * LATENT)
        needed = 0.95 / net if net > 0 else math.inf
        took = frames_until(lambda s=state: out(s), state, world, REAL, round(30 * water.seconds / REAL.time_scale))
        assert out(state) == success == (needed < water.seconds)
        if success:
            assert took * REAL.time_scale / 30 == pytest.approx(needed, abs=2 * REAL.every * REAL.time_scale / 30)


def test_less_water_than_boils_away_puts_nothing_out() -> None:
    """The critical rate: q / L = 11.6 g/m^2 s on the surface; below it, the film never closes."""
    state, world = room(("cabinet", (4.0, 4.0, 0.0)))
    state.status[:], state.peak[:], state.growth[:], state.curve[:] = BURNING, 800.0, 100.0, -1
    state.burn_age[:], state.decline[:], state.burn_end[:] = 100.0, 1e6, 2e6
    critical = FLAMES / LATENT
    fight(world, "water", (4.0, 4.0, 1.0))
    surface = 2 * (0.6 + 1.2 + 2.0)
    kept = EXTINGUISHERS["water"]
    for share, success in ((0.9, False), (1.3, True)):
        state.status[:], state.wet[:] = BURNING, 0.0
        slow = kept._replace(seconds=kept.charge / (share * critical * surface))
        with pytest.MonkeyPatch.context() as patch:
            patch.setitem(EXTINGUISHERS, "water", slow)
            frames_until(lambda: out(state), state, world, REAL, 3000)
        assert out(state) == success


def test_powder_stays_and_keeps_things_from_burning() -> None:
    state, world = room(("book", (4.0, 4.0, 0.0)), extent=(0.3, 0.3, 0.3))
    jet = fight(world, "powder", (4.0, 4.0, 0.15))
    frames_until(lambda: float(state.coated[0, 0]) == 1.0, state, world, REAL)
    jet.close(ROW)
    state.temperature[:] = 800.0
    frames_until(lambda: False, state, world, REAL, 5)
    assert state.status.tolist() == [[NORMAL]] and float(state.coated[0, 0]) == 1.0
    state.coated[:] = 0.0
    state.temperature[:] = 800.0
    frames_until(lambda: False, state, world, REAL, 6)
    assert state.status.tolist() == [[BURNING]], "without powder it burns"


def test_gas_smothers_only_while_it_flows() -> None:
    state, world = room(("cabinet", (2.5, 4.0, 0.0)))
    state.status[:], state.burn_age[:] = BURNING, 100.0

    def heat() -> float:
        fires = burners.fires(state, world, REAL.growth, REAL.first_release, REAL.first_base, REAL.radiant)
        return float(extinguishing.fight(state, world, fires, 0.75).power[0, 0])

    world.jets = [Jet.closed(1)]
    before = heat()
    jet = fight(world, "co2", (2.5, 4.0, 1.0), (1.5, 4.0, 1.0))
    assert before > 100.0 and heat() == 0.0
    jet.close(ROW)
    assert heat() == before and state.status.tolist() == [[BURNING]]


def test_a_fire_is_put_out_while_it_is_small() -> None:
    """2 kg of powder cover 8.3 m^2: enough for the first fire of `severe` after 20 s, not for one of 21A."""
    state, world = room(fires=[(4.0, 4.0)])
    fight(world, "powder", (4.0, 4.0, 0.0), (2.0, 4.0, 1.0))
    state.flame_age[:] = 75.0
    frames_until(lambda: False, state, world, REAL, round(30 * 12.0 / REAL.time_scale))
    assert int(state.flame_birth[0, 0]) > 10**9
    state, world = room(fires=[(4.0, 4.0)])
    fight(world, "powder", (4.0, 4.0, 0.0), (2.0, 4.0, 1.0))
    state.flame_age[:], state.flame_peak[0, 0] = 1e4, 250.0 * CRIB * 21
    frames_until(lambda: False, state, world, REAL, round(30 * 12.0 / REAL.time_scale))
    assert int(state.flame_birth[0, 0]) == 0


def test_the_first_fire_boils_its_film_away() -> None:
    """In f L / q = 21.6 s of fire, once the nozzle is closed."""
    state, world = room(fires=[(4.0, 4.0)])
    world.jets = [Jet.closed(1)]
    state.flame_wet[0, 0] = 0.9
    frames_until(lambda: float(state.flame_wet[0, 0]) == 0.0, state, world, REAL, 400)
    took = int(world.frame[0]) * REAL.time_scale / 30
    assert took == pytest.approx(0.9 * 0.25 * LATENT / FLAMES, abs=2 * REAL.every * REAL.time_scale / 30)


@pytest.mark.parametrize("preset", ["paper", "realistic"])
def test_closed_nozzles_change_nothing(preset: str) -> None:
    found = []
    law = presets.fire(preset)
    for with_jet in (False, True):
        state, world = room(("book", (4.2, 4.2, 0.0)), fires=[(4.0, 4.0)], law=law)
        world.jets = [Jet.closed(1)] if with_jet else []
        frames_until(lambda: False, state, world, law, 150)
        found.append(state.save())
    assert all(torch.equal(found[0][name], found[1][name]) for name in found[0])
