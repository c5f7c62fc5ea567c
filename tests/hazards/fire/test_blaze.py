"""The realistic fire as a whole: what holds for every fire, its agent, its image, and its episodes."""

from __future__ import annotations

import dataclasses

import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from hazard_ms.effects.charring import char_codes
from hazard_ms.hazards.fire.fire import BURNING, BURNT, NORMAL, body_flames, floor_flames
from hazard_ms.hazards.fire.realistic.blaze import Blaze
from hazard_ms.hazards.fire.realistic.blaze_state import BlazeState
from hazard_ms.simulation.world import World
from tests.worlds.fire_worlds import room_world

REAL = Blaze()
NAMES = ("book", "apple", "pan", "phone", "box", "throw_pillow", "sofa")


def begin(blaze: Blaze, world: World) -> BlazeState:
    state = BlazeState.allocate({"E": world.num_envs, "B": world.num_bodies, **blaze.sizes(world)}, "cpu")
    blaze.reset(state, world, torch.arange(world.num_envs))
    return state


def run(blaze: Blaze, state: BlazeState, world: World, seconds: float, dt: float = 1 / 30) -> None:
    for _ in range(round(seconds / dt)):
        world.chance.tick()
        blaze.advance(state, world, dt)


def with_room(world: World, **changes: object) -> World:
    specs = tuple(dataclasses.replace(s, room=dataclasses.replace(s.room, **changes)) for s in world.specs)  # type: ignore[arg-type]
    return dataclasses.replace(world, specs=specs)


coordinate = st.floats(1.0, 3.0, width=32)
things = st.lists(
    st.tuples(st.sampled_from(NAMES), st.tuples(coordinate, coordinate, st.sampled_from([0.0, 0.8]))),
    min_size=1,
    max_size=8,
)
fires = st.lists(st.tuples(coordinate, coordinate), min_size=0, max_size=3)


@settings(max_examples=5, deadline=None)
@given(things=things, fires=fires, seed=st.integers(0, 2**31), floor=st.sampled_from(["carpet", "wood", "tile"]))
def test_invariants_of_every_fire(things: list, fires: list, seed: int, floor: str) -> None:
    """Temperatures stay between the room's and the flames', the burning set of the floor only grows, nothing burnt
    burns again.
    """
    world = with_room(room_world(things, fires, size=(4.0, 4.0), extent=(0.2, 0.15, 0.1)), floor=floor)
    world.chance.seed += seed
    state = begin(REAL, world)
    cells, status = state.flame_cell.clone(), state.status.clone()
    for _ in range(12):
        run(REAL, state, world, 3.0, 0.1)
        every = torch.cat([state.temperature, state.agent_temperature], 1)
        assert float(every.min()) >= 20.0 - 1e-3 and float(every.max()) <= 820.1
        kept = cells >= 0
        assert torch.equal(state.flame_cell[kept], cells[kept]) and bool((state.status >= status).all())
        assert bool((state.agent_dose >= 0).all()) and 0.0 <= float(state.smoke_height) <= 2.6
        cells, status = state.flame_cell.clone(), state.status.clone()
    grown = int((state.flame_cell >= 0).sum()) - len(fires)
    assert grown == 0 if floor == "tile" or not fires else grown >= 0


def test_nothing_changes_in_a_cold_room() -> None:
    world = room_world([("book", (2.0, 2.0, 0.0)), ("sofa", (3.0, 2.0, 0.0))])
    state = begin(REAL, world)
    run(REAL, state, world, 10.0, 0.1)
    assert (
        (state.temperature == 20.0).all() and not state.status.any() and float(state.smoke_height) == pytest.approx(2.6)
    )
    assert float(state.agent_dose) < 1e-4 and float(state.smoke_density) == 0.0
    assert float(REAL.image(state, world, torch.tensor([[[1.0, 1.0, 1.0]]]))) == pytest.approx(20.0, abs=1e-3)


@pytest.mark.parametrize("dt", [1 / 60, 1 / 15])
def test_half_and_double_frames_give_the_same_fire(dt: float) -> None:
    """On tiles, where nothing is drawn: temperatures, heat, smoke and dose after 20 s of the episode."""
    made = []
    for step in (1 / 30, dt):
        world = with_room(
            room_world(
                [("box", (1.9, 1.5, 0.0)), ("sofa", (2.3, 2.2, 0.0)), ("pan", (3.0, 3.0, 0.8))],
                [(1.5, 1.5)],
                size=(4.0, 4.0),
                extent=(0.3, 0.3, 0.3),
                agent=(3.5, 1.0),
            ),
            floor="tile",
        )
        state = begin(REAL, world)
        run(REAL, state, world, 20.0, step)
        made.append(
            torch.cat(
                [
                    state.temperature[0],
                    state.heat_release,
                    state.smoke_temperature[0],
                    state.smoke_density[0],
                    state.agent_dose[0],
                    state.smoke_height[0] + 1,
                ]
            )
        )
    assert bool((made[0] > 0).all()) and float(made[0][3]) > 100.0
    assert torch.allclose(made[0], made[1], rtol=0.02, atol=0.02)


def test_a_batch_of_64_is_as_each_alone() -> None:
    def episode(copies: int, seed: int) -> BlazeState:
        world = room_world(
            [("box", (1.9, 1.5, 0.0)), ("apple", (2.2, 1.5, 0.0))], [(1.5, 1.5)], size=(4.0, 4.0), copies=copies
        )
        world.position[:, 1, 0] -= 0.01 * (torch.arange(copies) + seed)
        state = begin(REAL, world)
        run(REAL, state, world, 12.0, 0.1)
        return state

    batch = episode(64, 0)
    assert len(batch.temperature.unique(dim=0)) > 3
    for e in (0, 37, 63):
        alone = episode(1, e)
        for name, value in alone.save().items():
            assert torch.equal(value[0], getattr(batch, name)[e]), name


def test_a_thing_burns_as_long_as_its_fuel_lasts_then_cools_and_warms_nothing() -> None:
    plain = dataclasses.replace(REAL, time_scale=1.0, every=1)
    world = with_room(
        room_world([("throw_pillow", (2.0, 2.0, 0.0))], size=(4.0, 4.0), extent=(0.4, 0.4, 0.15)), floor="tile"
    )
    state = begin(plain, world)
    state.temperature[:] = 400.0  # above the ignition of foam, 390 C
    run(plain, state, world, 0.1, 0.1)
    assert state.status.item() == BURNING and state.temperature.item() == pytest.approx(820.0)
    assert bool(plain.damaged(state, world).all()) and float(body_flames(state)) > 0
    heat, seconds = 0.0, 0.1
    while state.status.item() == BURNING:
        run(plain, state, world, 0.3, 0.3)
        heat += float(state.heat_release) * 0.3
        seconds += 0.3
        assert seconds < 1000.0
    assert heat == pytest.approx(4400.0, rel=0.01) and seconds == pytest.approx(float(state.burn_end), abs=0.7)
    assert state.status.item() == BURNT
    run(plain, state, world, 400.0, 1.0)
    assert float(state.heat_release) == 0.0 and state.temperature.item() < 300.0 and state.status.item() == BURNT
    codes = char_codes(state, state.smoke_height[:, 0].numpy() * 0)
    assert codes[0, 0] >= 255.0  # black


def test_flames_that_reach_a_thing_ignite_it_and_a_wall_of_distance_does_not() -> None:
    world = with_room(
        room_world(
            [("book", (2.0, 2.15, 0.0)), ("book", (3.5, 3.5, 0.0)), ("key", (2.0, 1.85, 0.0))],
            [(2.0, 2.0)],
            size=(4.0, 4.0),
        ),
        floor="tile",
    )
    state = begin(REAL, world)
    run(REAL, state, world, 15.0)
    assert state.status[0].tolist() == [BURNING, NORMAL, NORMAL]  # keys are not flammable
    assert float(state.temperature[0, 2]) > 200.0


def test_heat_keeps_the_agent_out_and_adds_up_to_a_dose() -> None:
    near = with_room(room_world([], [(2.0, 2.0)], size=(6.0, 6.0), agent=(2.5, 2.0)), floor="tile")
    far = with_room(room_world([], [(2.0, 2.0)], size=(6.0, 6.0), agent=(5.5, 5.5)), floor="tile")
    doses = []
    for world in (near, far):
        state = begin(REAL, world)
        run(REAL, state, world, 4.0)
        info = REAL.agent_info(state, world)
        doses.append(float(info["agent_dose"]))
        assert set(info) >= {
            "agent_temperature",
            "agent_dose",
            "agent_thermal_class",
            "agent_in_fire",
            "agent_overheated",
        }
    assert doses[0] > 10 * doses[1] > 0
    points = torch.tensor([[[2.05, 2.0, 0.0], [5.5, 5.5, 0.0]]])
    assert REAL.forbids(state, world, points).tolist() == [[True, False]]


def test_the_image_shows_the_layer_and_the_flames() -> None:
    world = with_room(room_world([], [(2.0, 2.0)], size=(4.0, 4.0)), floor="tile")
    state = begin(REAL, world)
    run(REAL, state, world, 6.0)
    points = torch.tensor([[[3.5, 3.5, 2.5], [3.5, 3.5, 0.05], [2.0, 2.0, 0.2]]])
    high, low, flame = REAL.image(state, world, points)[0].tolist()
    assert flame > 500.0 and high > low + 3.0 and 0.05 < float(state.smoke_height) < 2.0
    place, scale = floor_flames(state, world.frame)
    assert place[0, 0].tolist() == [2.0, 2.0, 0.0] and float(scale[0, 0]) > 0.5


def test_plates_of_the_image_gain_no_heat_in_the_flux_and_gas_that_warm_things() -> None:
    world = with_room(room_world([("book", (2.4, 2.0, 0.0)), ("sofa", (3.0, 2.5, 0.0))], [(2.0, 2.0)]), floor="carpet")
    state = begin(REAL, world)
    run(REAL, state, world, 20.0)
    points = torch.rand(1, 400, 3, generator=torch.Generator().manual_seed(0)) * torch.tensor([4.0, 4.0, 2.6])
    state.zone_temperature[:], state.zone_height[:] = 30.0, 2.5  # so that plumes and jets are told from the layer
    state.zone_low_temperature[:] = 25.0
    plate = REAL.image(state, world, points).double() + 273.15
    flux, gas = (v.double() for v in REAL._exposure(state, world, REAL._fires(state, world), points))
    gain = 0.9 * (flux + 5.670e-11 * (293.15**4 - plate**4)) + 0.01 * (gas + 273.15 - plate)
    below = plate < 820.0 + 273.0
    assert int(below.sum()) > 200 and float(flux.max()) > 10.0 and int((state.flame_cell >= 0).sum()) > 3
    assert bool((gain[below].abs() < 0.01 * flux[below].clamp(min=1.0)).all()) and bool((gain[~below] > -0.1).all())
    assert int((gas[points[..., 2] > 2.34] > 40.0).sum()) > 10  # in the jet


def test_an_episode_that_began_later_is_updated_at_its_own_frames() -> None:
    """Two environments, the second two frames behind: each has the bits that it has alone."""
    bodies, fires = [("book", (2.4, 2.0, 0.0)), ("throw_pillow", (2.0, 2.5, 0.0))], [(2.0, 2.0)]
    pair, alone = (room_world(bodies, fires, copies=copies) for copies in (2, 1))
    both, one = begin(REAL, pair), begin(REAL, alone)
    run(REAL, both, pair, 2 / 30)
    both.clear(torch.tensor([1]))
    REAL.reset(both, pair, torch.tensor([1]))
    pair.chance.frame[1] = 0
    run(REAL, both, pair, 63 / 30)
    for env, frames in ((0, 65), (1, 63)):
        one.clear(torch.tensor([0]))
        alone.chance.seed[:], alone.chance.frame[:] = pair.chance.seed[env], 0
        REAL.reset(one, alone, torch.tensor([0]))
        run(REAL, one, alone, frames / 30)
        for name in ("temperature", "status", "burn_age", "zone_smoke", "zone_upper", "agent_dose", "flame_age"):
            assert torch.equal(getattr(both, name)[env], getattr(one, name)[0]), name
    assert not torch.equal(both.temperature[0], both.temperature[1])
