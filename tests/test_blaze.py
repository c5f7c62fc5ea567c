"""The realistic fire: laws of its kernels beyond the published numbers (those: test_validate.py), and what holds for every fire."""

from __future__ import annotations

import dataclasses
import math

import pytest
import torch
from fire_worlds import room_world
from hypothesis import given, settings
from hypothesis import strategies as st

from hazard_ms.catalogue import CATEGORIES
from hazard_ms.effects.charring import char_codes
from hazard_ms.hazards import burning, fuels, radiation, smoke, tenability
from hazard_ms.hazards.blaze import Blaze
from hazard_ms.hazards.blaze_state import BlazeState
from hazard_ms.hazards.fire import BURNING, BURNT, NORMAL, body_flames, floor_flames
from hazard_ms.hazards.presets import fire
from hazard_ms.spec import Opening, Room
from hazard_ms.world import World

REAL = Blaze()
NAMES = ("book", "apple", "pan", "phone", "box", "throw_pillow", "sofa")
positive = st.floats(0.1, 1000.0)


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


def number(*values: float) -> torch.Tensor:
    return torch.tensor([float(v) for v in values])


def test_the_preset_is_this_fire() -> None:
    assert fire("realistic") == REAL and REAL.name == "fire"


# ---------------------------------------------------------------- heat release


@settings(max_examples=60, deadline=None)
@given(growth=st.floats(1e-3, 0.2), peak=positive, energy=st.floats(10.0, 1e6))
def test_a_fire_gives_off_its_energy_and_no_more_than_its_peak(growth: float, peak: float, energy: float) -> None:
    course = burning.course(number(growth), number(peak), number(energy))
    age = torch.linspace(0.0, float(course.end), 20_001)
    seen = burning.release(burning.Course(*(v.expand(age.shape) for v in course)), age).double()
    assert float(seen.mean() * course.end) == pytest.approx(energy, rel=2e-3)
    assert float(seen.max()) <= peak * (1 + 1e-5)
    early = age < float(course.decline) * 0.999
    assert torch.allclose(seen[early], torch.minimum(growth * age[early] ** 2, course.peak).double(), rtol=1e-4)
    assert float(burning.release(course, course.end * 1.001)) == 0.0


def test_measured_curves_go_through_their_knots_and_straight_between() -> None:
    for row, curve in enumerate(fuels.CURVES.values()):
        for (t0, q0), (t1, q1) in zip(curve.knots, curve.knots[1:], strict=False):
            seen = burning.measured(torch.full((2,), row), number(t0, (t0 + t1) / 2))
            assert seen.tolist() == pytest.approx([q0, (q0 + q1) / 2], rel=1e-4, abs=1e-3)
        last = curve.knots[-1][0]
        assert burning.measured(torch.full((2,), row), number(last + 1, -1.0)).tolist() == [0.0, 0.0]
        assert float(burning.lasting(torch.tensor(row))) == last
        assert float(burning.radiant(torch.tensor(row), 0.2)) == pytest.approx(curve.radiant)
    assert float(burning.radiant(torch.tensor(-1), 0.2)) == pytest.approx(0.2)


def test_every_category_has_a_material_and_every_table_names_categories() -> None:
    for name in CATEGORIES:
        made = fuels.material(name)
        assert (made.inertia > 0) != (made.sheet > 0) and made.critical > 0 and 200 <= made.ignition <= 700
    listed = {n for names in fuels._OF.values() for n in names} | set(fuels.CURVE_OF) | set(fuels.MEASURED)
    assert listed <= set(CATEGORIES) and set(fuels.CURVE_OF.values()) <= set(fuels.CURVES) and set(fuels._OF) <= set(fuels.MATERIALS)


# ---------------------------------------------------------------- radiation and surfaces


def test_fluxes_add_fall_with_the_square_and_do_not_exceed_a_flames() -> None:
    place = torch.tensor([[[0.0, 0.0, 0.0], [50.0, 0.0, 0.0]]])
    fires = radiation.Fires(place, number(100.0, 0.0)[None], torch.full((1, 2), 0.35), torch.full((1, 2), 0.34))
    points = torch.tensor([[[4.0, 0.0, 0.0], [8.0, 0.0, 0.0], [0.0, 0.0, 0.3], [46.0, 0.0, 0.0]]])
    one = radiation.flux(fires, points, number(50.0))[0]
    lift = (float(radiation.flame_length(number(100.0), number(0.34))) / 3) ** 2
    assert float(one[0] / one[1]) == pytest.approx((64 + lift) / (16 + lift), rel=1e-4)
    assert float(one[2]) == radiation.FLAME_FLUX
    both = radiation.flux(fires._replace(power=number(100.0, 100.0)[None]), points, number(50.0))[0]
    assert float(both[0] - one[0]) == pytest.approx(0.35 * 100 / (4 * math.pi * (46**2 + lift)), rel=1e-3)


def test_a_batch_gives_what_one_gives(monkeypatch: pytest.MonkeyPatch) -> None:
    generator = torch.Generator().manual_seed(1)
    place, points = (5 * torch.rand(6, n, 3, generator=generator) for n in (9, 7))
    fires = radiation.Fires(place, 200 * torch.rand(6, 9, generator=generator), torch.full((6, 9), 0.35), torch.full((6, 9), 0.3))
    whole = radiation.flux(fires, points, torch.full((6,), 2.6))
    monkeypatch.setattr(radiation, "_BLOCK", 100)
    assert torch.equal(whole, radiation.flux(fires, points, torch.full((6,), 2.6)))


SURFACES = st.sampled_from(
    [
        radiation.Solid(number(390.0), number(16.0), number(0.5), number(0.0)),
        radiation.Solid(number(300.0), number(10.0), number(0.0), number(0.4)),
    ]
)


@settings(max_examples=60, deadline=None)
@given(solid=SURFACES, flux=st.floats(0.0, 60.0), start=st.floats(20.0, 800.0), parts=st.integers(2, 30), span=st.floats(0.1, 300.0))
def test_surfaces_do_not_know_the_length_of_a_step(solid: radiation.Solid, flux: float, start: float, parts: int, span: float) -> None:
    once = radiation.warm(number(start), number(flux), solid, 20.0, span)
    many = number(start)
    for _ in range(parts):
        many = radiation.warm(many, number(flux), solid, 20.0, span / parts)
    assert float(many) == pytest.approx(float(once), rel=1e-3, abs=0.05)
    limit = 20.0 + flux * (float(solid.ignition) - 20.0) / float(solid.critical)
    assert min(start, limit) - 0.05 <= float(once) <= max(start, limit) + 0.05


@settings(max_examples=60, deadline=None)
@given(flux=st.floats(0.0, 80.0), gas=st.floats(20.0, 820.0))
def test_a_plate_thermometer_neither_gains_nor_loses_heat(flux: float, gas: float) -> None:
    surface = float(radiation.adiabatic(torch.tensor(flux, dtype=torch.float64), torch.tensor(gas, dtype=torch.float64), 20.0))
    gain = 0.9 * (flux + 5.670e-11 * (293.15**4 - (surface + 273.15) ** 4)) + 0.01 * (gas - surface)
    assert abs(gain) < 0.01 * max(flux, 1.0)
    assert surface >= 20.0 - 1e-6


# ---------------------------------------------------------------- smoke


def test_heat_and_soot_are_conserved_in_a_tight_room_without_losses(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(smoke, "WALLS", 0.0)
    walls = smoke.Walls(number(400.0), number(5.0), number(80.0))
    layer, source = smoke.Layer(*(torch.zeros(1) for _ in range(3))), smoke.Source(number(300.0), number(200.0), number(0.2), number(0.001))
    for _ in range(300):
        layer = smoke.fill(layer, walls, torch.zeros(1, 1, 3), source, 20.0, 820.0, 0.1)
    assert float(layer.energy) == pytest.approx(200.0 * 30, rel=1e-4) and float(layer.soot) == pytest.approx(0.03, rel=1e-4)
    assert 0 < float(smoke.interface(layer.volume, walls)) < 5.0
    hot = float(smoke.temperature(layer, 20.0)) + 273.15
    assert 353 / hot * float(layer.volume) * (hot - 293.15) == pytest.approx(6000.0, rel=1e-3)  # mass times rise, 1 kJ/kg K


def test_smoke_leaves_through_gaps_above_its_face_only() -> None:
    door = Room(size=(4.0, 5.0), openings=(Opening("door", "south", 2.0, 0.9, 2.0), Opening("window", "east", 2.0, 1.0, 1.2, 0.9)))
    assert smoke.gaps(door) == [(0.02, 0.0, 2.0), (0.02, 0.9, 2.1)]
    vents = torch.tensor([[(0.9, 0.0, 2.0)]])
    assert float(smoke.leak(vents, number(2.1), number(200.0), 20.0)) == 0.0
    assert float(smoke.leak(vents, number(1.0), number(20.0), 20.0)) == 0.0
    rho, air = 353 / 473.15, 353 / 293.15
    layers = torch.linspace(1.0, 2.0, 20_001, dtype=torch.float64)  # velocity head of each height, by the pressure above the face
    want = 0.7 * 0.9 * float((2 * rho * 9.81 * (air - rho) * (layers - 1.0)).sqrt().mean())
    assert float(smoke.leak(vents, number(1.0), number(200.0), 20.0)) == pytest.approx(want, rel=1e-3)


@settings(max_examples=30, deadline=None)
@given(power=st.floats(1.0, 20000.0), dt=st.floats(0.01, 5.0), width=st.floats(0.0, 3.0))
def test_a_layer_stays_in_its_room_and_below_the_heat_of_flames(power: float, dt: float, width: float) -> None:
    walls, vents = smoke.Walls(number(12.0), number(2.4), number(14.0)), torch.tensor([[(width, 0.0, 2.0)]])
    layer = smoke.Layer(*(torch.zeros(1) for _ in range(3)))
    for step in range(150):
        now = power if step < 100 else 0.0
        layer = smoke.fill(layer, walls, vents, smoke.Source(number(now), number(0.65 * now), number(0.0), number(1e-3)), 20.0, 820.0, dt)
        assert 0.0 <= float(smoke.interface(layer.volume, walls)) <= 2.4 + 1e-6
        assert 19.99 <= float(smoke.temperature(layer, 20.0)) <= 820.1 and float(layer.soot) >= 0.0


def test_thermal_classes_of_robots() -> None:
    seen = tenability.thermal_class(number(20, 80, 140, 200, 300, 20, 20, 20), number(0, 0, 0, 0, 0, 1.5, 5, 12))
    assert seen.tolist() == [0, 1, 2, 3, 4, 2, 3, 4]


# ---------------------------------------------------------------- the hazard

coordinate = st.floats(1.0, 3.0, width=32)
things = st.lists(st.tuples(st.sampled_from(NAMES), st.tuples(coordinate, coordinate, st.sampled_from([0.0, 0.8]))), min_size=1, max_size=8)
fires = st.lists(st.tuples(coordinate, coordinate), min_size=0, max_size=3)


@settings(max_examples=5, deadline=None)
@given(things=things, fires=fires, seed=st.integers(0, 2**31), floor=st.sampled_from(["carpet", "wood", "tile"]))
def test_invariants_of_every_fire(things: list, fires: list, seed: int, floor: str) -> None:
    """Temperatures stay between the room's and the flames', the burning set of the floor only grows, nothing burnt burns again."""
    world = with_room(room_world(things, fires, size=(4.0, 4.0), extent=(0.2, 0.15, 0.1)), floor=floor)
    world.chance.seed += seed
    state = begin(REAL, world)
    cells, status = state.flame_cell.clone(), state.status.clone()
    for _ in range(12):
        run(REAL, state, world, 3.0, 0.1)
        every = torch.cat([state.temperature.flatten(), state.agent_temperature, state.smoke_temperature])
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
    assert (state.temperature == 20.0).all() and not state.status.any() and float(state.smoke_height) == pytest.approx(2.6)
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
                    state.smoke_temperature,
                    state.smoke_density,
                    state.agent_dose,
                    state.smoke_height + 1,
                ]
            )
        )
    assert bool((made[0] > 0).all()) and float(made[0][3]) > 100.0
    assert torch.allclose(made[0], made[1], rtol=0.02, atol=0.02)


def test_the_spread_does_not_know_the_frame_rate() -> None:
    """Mean number of burning cells after 12 s, from 150 floors each at 10 and at 40 frames a second, within four deviations."""
    short = dataclasses.replace(REAL, horizon=12.0)
    seen = []
    for dt in (1 / 10, 1 / 40):
        world = with_room(room_world([], [(2.5, 2.5)], size=(5.0, 5.0), copies=150), floor="carpet")
        state = begin(short, world)
        for _ in range(round(12.0 / dt)):
            world.chance.tick()
            short._spread(state, world, dt * short.lapse)
        seen.append((state.flame_cell >= 0).sum(1).double())
    error = 4 * math.sqrt(float(seen[0].var() + seen[1].var()) / 150)
    assert float(seen[0].mean()) > 2.5 and abs(float(seen[0].mean() - seen[1].mean())) < error


def test_a_batch_of_64_is_as_each_alone() -> None:
    def episode(copies: int, seed: int) -> BlazeState:
        world = room_world([("box", (1.9, 1.5, 0.0)), ("apple", (2.2, 1.5, 0.0))], [(1.5, 1.5)], size=(4.0, 4.0), copies=copies)
        world.chance.seed[:] = torch.arange(copies) + seed
        state = begin(REAL, world)
        run(REAL, state, world, 12.0, 0.1)
        return state

    batch = episode(64, 0)
    assert len(batch.flame_cell.unique(dim=0)) > 3
    for e in (0, 37, 63):
        alone = episode(1, e)
        for name, value in alone.save().items():
            assert torch.equal(value[0], getattr(batch, name)[e]), name


def test_a_thing_burns_as_long_as_its_fuel_lasts_then_cools_and_warms_nothing() -> None:
    plain = dataclasses.replace(REAL, lapse=1.0, every=1)
    world = with_room(room_world([("throw_pillow", (2.0, 2.0, 0.0))], size=(4.0, 4.0), extent=(0.4, 0.4, 0.15)), floor="tile")
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
    codes = char_codes(state, state.smoke_height.numpy() * 0)
    assert codes[0, 0] >= 255.0  # black


def test_flames_that_reach_a_thing_ignite_it_and_a_wall_of_distance_does_not() -> None:
    world = with_room(
        room_world([("book", (2.0, 2.15, 0.0)), ("book", (3.5, 3.5, 0.0)), ("key", (2.0, 1.85, 0.0))], [(2.0, 2.0)], size=(4.0, 4.0)),
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
        assert set(info) >= {"agent_temperature", "agent_dose", "agent_thermal_class", "agent_in_fire", "agent_overheated"}
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


@pytest.mark.parametrize(
    ("field", "value"),
    [("lapse", 0.0), ("first_release", -1.0), ("horizon", math.inf), ("radiant", 1.0), ("agent_bound", 0.0), ("flame_temperature", 20.0)],
)
def test_impossible_parameters_are_refused_by_name(field: str, value: float) -> None:
    with pytest.raises(ValueError, match=f"{field} is {value}"):
        dataclasses.replace(REAL, **{field: value})


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
        for name in ("temperature", "status", "burn_age", "smoke_volume", "agent_dose", "flame_age"):
            assert torch.equal(getattr(both, name)[env], getattr(one, name)[0]), name
    assert not torch.equal(both.temperature[0], both.temperature[1])
