"""What smoke does: behind doorways, to floors, to what hangs under a ceiling, and to the agent."""

from __future__ import annotations

import math

import pytest
import torch

from hazard_ms.hazards.fire.realistic import front, radiation, smoke, tenability
from hazard_ms.hazards.fire.realistic.fuels import MATERIALS
from hazard_ms.spec import Opening, Room
from hazard_ms.validation.experiments.smoke_room import INSULATED, Burner, burn, fire_at, rooms
from tests.hazards.fire.test_blaze import REAL, begin, run, with_room
from tests.worlds.fire_worlds import room_world
from tests.worlds.flats import flat
from tests.worlds.smoke_probes import law

STEFAN = 5.670e-11  # [kW/m^2 K^4]
MASS, ENERGY, SOOT, LACK, MONOXIDE, CYANIDE = range(6)  # parts of a layer


def number(*values: float) -> torch.Tensor:
    return torch.tensor([float(v) for v in values])


def test_smoke_behind_an_opening_draws_in_air_as_spill_plumes_do() -> None:
    """Poreh et al. 1998: 0.5 kg/s of 220 C through 0.9 m, rising by 1 m in air of 20 C."""
    dense = 353.0 / 293.15
    scale = (9.81 * dense**2 / 293.15 * 0.5 * 200.0) ** (1 / 3)
    want = 0.44 * (293.15 / 493.15) ** (2 / 3) * scale * 0.9 ** (2 / 3)
    assert law("spill", 0.5, 220.0, 20.0, 0.9, 1.0) == pytest.approx(want, rel=1e-4)
    assert law("spill", 0.5, 220.0, 20.0, 0.9, -0.1) == 0.0 == law("spill", 0.5, 20.0, 220.0, 0.9, 1.0)


def test_smoke_is_thinner_in_the_next_room() -> None:
    """What passes a doorway takes air along as it rises, so there is less soot per mass."""
    state, _ = flat(40.0, 100.0)
    first, second = (float(g[SOOT] / g[MASS]) for g in state.zone_smoke[0])
    assert second < 0.55 * first


def test_air_that_falls_through_smoke_takes_some_along() -> None:
    """So the air below the layer of a room with an open door has soot, and lacks oxygen."""
    room = Room((3.6, 2.4), 2.4, openings=(Opening("window", "south", 1.8, 0.8, 2.0),))
    state, world = rooms(room)
    state.vents[0, 0, 0] = 0.8
    burner = Burner(300.0)
    burn(state, world, burner, fire_at(1.8, 1.2, burner), 60.0)
    assert float(state.zone_air[0, 0, SOOT]) > 0.0 and float(state.zone_air[0, 0, LACK]) > 0.0
    assert 0.0 < float(state.zone_low_density) < 0.5 * float(state.zone_density)
    assert float(state.zone_low_temperature) > 25.0  # and the floor has warmed it


def test_a_draught_bends_a_plume_which_then_draws_in_more() -> None:
    """Hoult, Fay and Forney 1969: 0.6 of the draught's speed beside 0.11 of the plume's own, over its height."""
    still, across = law("entrained", 100.0, 65.0, 100.0, 2.0, 0.0), law("entrained", 100.0, 65.0, 100.0, 2.0, 0.3)
    speed = 5 / 6 / 0.11 * (0.9 * 0.11 * 9.81 * 100.0 / 353.0 / math.pi) ** (1 / 3) * 2.0 ** (-1 / 3)
    assert across / still == pytest.approx(1 + 5 / 6 * 0.6 * 0.3 / (0.11 * speed), rel=1e-4)
    draughts = []
    for wide in (0.02, 0.9):
        state, world = rooms(Room((4.0, 4.0), openings=(Opening("door", "south", 2.0, 0.9, 2.0),)))
        state.vents[0, 0, 0] = wide
        burner = Burner(200.0)
        burn(state, world, burner, fire_at(2.0, 2.0, burner), 60.0)
        draughts.append(float(state.zone_draught))
    assert draughts[0] < 0.02 and 0.05 < draughts[1] < 0.5


def test_both_places_that_need_the_length_of_a_flame_have_the_same() -> None:
    for power, wide in ((20.0, 0.2), (500.0, 0.8), (4500.0, 1.5)):
        want = float(radiation.flame_length(number(power), number(wide)))
        assert law("flame_length", power, wide) == pytest.approx(want, rel=1e-3)


def test_openings_radiate_what_the_layer_behind_them_does() -> None:
    """A black layer of 800 K behind a wide window, beside walls that take nothing, against a clear one."""
    left = []
    for soot in (0.0, 1.0):
        state, world = rooms(Room((4.0, 4.0), openings=(Opening("window", "south", 2.0, 2.0, 1.0, 1.5),)), INSULATED)
        state.vents[0, 0, 0] = 2.0
        air = state.zone_air[0, 0].clone()
        state.zone_smoke[0, 0, MASS], state.zone_smoke[0, 0, SOOT] = 0.3 * air[MASS], soot
        state.zone_air[0, 0, MASS] = 0.2 * air[MASS]
        state.zone_smoke[0, 0, ENERGY] = 0.3 * air[MASS] * 506.85 * (1 + 1e-4 * 506.85)
        burner = Burner(1.0, step=0.02)
        cold = fire_at(2.0, 2.0, burner)._replace(power=torch.zeros(1, 1))
        burn(state, world, burner, cold, 0.02)  # which finds what is where
        before = float(state.zone_temperature)
        burn(state, world, burner, cold, 0.2)
        capacity = float(state.zone_smoke[0, 0, MASS]) * (1 + 2e-4 * 506.85)  # [kJ/K]
        left.append((before - float(state.zone_temperature)) * capacity)
    assert float(state.zone_height) < 1.5 and float(state.zone_emissivity) > 0.999
    assert left[1] - left[0] == pytest.approx(2.0 * STEFAN * (800.0**4 - 293.15**4) * 0.2, rel=0.05)


def test_smoke_heats_the_floor_below_it() -> None:
    """A carpet under a black layer of 500 C, far from every fire: sqrt(q^2 t / (pi/4 k rho c)) after 10 s."""
    world = with_room(room_world([], [(0.5, 0.5)], size=(12.0, 12.0)), floor="carpet")
    state = begin(REAL, world)
    state.zone_temperature[:], state.zone_emissivity[:] = 500.0, 1.0
    fire = radiation.Fires(torch.tensor([[[400.0, 400.0, 0.0]]]), *(torch.tensor([[v]]) for v in (1.0, 0.35, 0.1)))
    for _ in range(10):
        front.warm(state, world, fire, 20.0, 1.0)
    flux = STEFAN * (773.15**4 - 293.15**4)
    want = 20.0 + math.sqrt(flux**2 * 10.0 / (math.pi / 4 * 0.42))
    seen = state.floor_temperature[0, 0][state.free[0, 0]]
    assert len(seen) > 3 and torch.allclose(seen, torch.full_like(seen, want), rtol=0.01)


def test_what_hangs_under_a_ceiling_feels_the_jet_below_it() -> None:
    """Alpert 1972 under 3 m, 1,000 kW: 270.8 K above the fire, 86.2 K 3 m aside."""
    power, high = number(1000.0, 1000.0), number(3.0, 3.0)
    assert smoke.jet_rise(power, number(0.3, 3.0), high).tolist() == pytest.approx([270.8, 86.2], rel=0.01)
    world = with_room(room_world([], [(1.0, 1.0)], size=(6.0, 6.0)), floor="tile", height=3.0)
    state = begin(REAL, world)
    state.flame_age[:, 0] = 1e3
    points = torch.tensor([[[4.0, 1.0, 2.9], [4.0, 1.0, 2.5]]])
    _, gas = REAL._exposure(state, world, REAL._fires(state, world), points)
    want = 5.38 * (REAL.first_release / 3.0) ** (2 / 3) / 3.0
    assert gas[0].tolist() == pytest.approx([20.0 + want, 20.0], rel=0.01)


def test_a_layer_after_flashover_shows_as_hot_as_it_is() -> None:
    """A black layer of 1,100 C, far above the 820 C of flames: so hot is what hangs in it, but nothing is hotter."""
    world = with_room(room_world([], [(2.0, 2.0)], size=(4.0, 4.0)), floor="tile")
    state = begin(REAL, world)
    state.zone_temperature[:], state.zone_emissivity[:], state.zone_height[:] = 1100.0, 1.0, 1.0
    state.flame_age[:, 0] = 1e3
    high, flame = REAL.image(state, world, torch.tensor([[[0.3, 0.3, 2.0], [2.0, 2.0, 1.5]]]))[0].tolist()
    assert high == pytest.approx(1100.0, abs=15.0) and flame == pytest.approx(1100.0, abs=0.1)


def test_in_the_open_no_jet_runs_under_a_ceiling_that_is_not_there() -> None:
    world = with_room(room_world([], [(2.0, 2.0)]), open_air=True)
    state = begin(REAL, world)
    state.flame_age[:, 0] = 1e3
    fires, points = REAL._fires(state, world), torch.tensor([[[0.2, 0.2, 2.5]]])
    assert float(REAL._exposure(state, world, fires, points)[1]) == 20.0
    length = 0.9 * (3.7 * (2100.0 / (1.2 * 293.15 * 9.81**0.5 * 0.9**2.5)) ** 0.4 - 1.02)
    away = 2 * 1.8**2 + (length / 3 - 2.5) ** 2
    flux = 0.35 * 2100.0 / (4 * math.pi * away)
    assert length > 2.6 and float(REAL._exposure(state, world, fires, points)[0]) == pytest.approx(flux, rel=0.01)
    plate = float(REAL.image(state, world, points)) + 273.15
    assert 0.9 * (flux + 5.670e-11 * (293.15**4 - plate**4)) == pytest.approx(0.01 * (plate - 293.15), abs=0.05)


def test_poison_by_iso_13571() -> None:
    """1,000 ppm of CO for 35 min, 100 ppm of HCN for 22.9 min, 10 % of oxygen for 9.43 min (Purser): helpless."""
    gas = torch.zeros(4, 6)
    gas[:, MASS] = 2.0
    gas[0, MONOXIDE], gas[1, CYANIDE] = 2.0 * 1e-3 * 28.01 / 28.96, 2.0 * 1e-4 * 27.03 / 28.96
    gas[2, LACK] = 2.0 * 0.109 * 32.0 / 28.96
    minutes = 1 / 60 / tenability.toxic_rate(gas)
    assert minutes[0] == pytest.approx(35.0, rel=1e-3) and minutes[1] == pytest.approx(22.87, rel=1e-2)
    assert minutes[2] == pytest.approx(9.43, rel=1e-2) and float(tenability.toxic_rate(gas)[3]) == 0.0
    deep = gas[0] + torch.tensor([0.0, 0.0, 0.0, 2.0 * 0.05 * 32.0 / 28.96, 0.0, 0.0])  # 4 % of carbon dioxide, too
    assert float(tenability.toxic_rate(deep) * 60 * 35) == pytest.approx(math.exp(0.8), rel=1e-2)


def test_fires_without_air_make_more_poison() -> None:
    """Gottuk and Lattimer's yields of CO, and those of foam in a room that lets in too little air for it."""
    assert law("monoxide", 0.5) == pytest.approx(0.0093, abs=5e-4) and law("monoxide", 2.0) == pytest.approx(
        0.211, rel=0.01
    )
    made = []
    for power in (20.0, 6000.0):
        state, world = rooms(Room((4.0, 4.0), openings=(Opening("window", "south", 2.0, 0.9, 2.0),)))
        state.vents[0, 0, 0] = 0.9
        burner = Burner(power)
        fire = fire_at(2.0, 2.0, burner)
        yields = torch.tensor([[MATERIALS["foam"].yields]])
        for _ in range(80):
            smoke.advance(state, world, fire, yields, 20.0, 0.75)
        made.append([float(state.zone_smoke[0, 0, k] / state.zone_smoke[0, 0, LACK]) for k in (MONOXIDE, CYANIDE)])
    per_lack = 1.0 / (22300.0 / 13100.0 + 0.232)  # fuel per oxygen that is missing
    assert made[0] == pytest.approx([0.010 * per_lack, 0.0013 * per_lack], rel=0.3)
    assert made[1][0] == pytest.approx(0.21 * per_lack, rel=0.2) and made[1][1] == pytest.approx(
        0.015 * per_lack, rel=0.2
    )


def test_the_agent_feels_heat_and_breathes_smoke_at_its_chest() -> None:
    """A metre above the floor: in a layer down to 0.8 m, and not in one down to 1.2 m."""
    world = with_room(room_world([], [], size=(6.0, 6.0), agent=(3.0, 3.0)), floor="tile")
    state = begin(REAL, world)
    state.zone_temperature[:], state.zone_density[:] = 150.0, 1.5
    state.zone_smoke[0, 0] = torch.tensor([10.0, 1300.0, 0.0, 1.0, 0.2, 0.0])
    for face, warmth, sight, poison in ((0.8, 150.0, 2.0, True), (1.2, 20.0, 100.0, False)):
        state.zone_height[:] = state.smoke_height[:] = face
        info = REAL.agent_info(state, world)
        assert float(info["agent_temperature"]) == pytest.approx(warmth, rel=1e-3)
        assert float(info["agent_visibility"]) == pytest.approx(sight, rel=1e-3)
        assert bool(info["agent_in_smoke"]) is (face < 1.0)
        breathed = smoke.breathed(state, tenability.chest(world))
        assert bool(tenability.toxic_rate(breathed) > 1e-3) is poison


def test_radiation_counts_from_what_people_bear_and_doses_add_up_in_the_agents_own_seconds() -> None:
    """2.5 kW/m^2 are unbearable after 44 s of the episode (ISO 13571), however fast the fire runs; less never."""
    assert 1.0 / float(tenability.dose_rate(number(0.0), number(2.5))) == pytest.approx(44.2, rel=0.01)
    assert float(tenability.dose_rate(number(0.0), number(2.4))) == 0.0
    world = with_room(room_world([], [(2.0, 2.0)], size=(9.0, 9.0), agent=(4.0, 2.0)), floor="tile", open_air=True)
    state = begin(REAL, world)
    state.flame_age[:, 0] = 1e3
    run(REAL, state, world, 3.0)
    before, info = float(state.agent_dose), REAL.agent_info(state, world)
    rate = float(tenability.dose_rate(info["agent_temperature"], info["agent_flux"]))
    run(REAL, state, world, 6.0)
    assert float(info["agent_flux"]) > 2.5 and float(state.agent_dose) - before == pytest.approx(6.0 * rate, rel=0.02)
    assert float(state.agent_toxic_dose) == 0.0
