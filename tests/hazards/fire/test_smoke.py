"""The two zones of rooms: conservation, exact solutions, openings, oxygen and panes."""

from __future__ import annotations

import math

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from hazard_ms.hazards.fire.realistic.blaze_state import BlazeState
from hazard_ms.hazards.fire.realistic.twozone.lining import CELLS, GYPSUM, RATIO, Lining
from hazard_ms.hazards.fire.realistic.twozone.rooms import ends, joined, parts
from hazard_ms.spec import Opening, Partition, Room
from hazard_ms.validation.experiments.smoke_room import (
    INSULATED,
    SLOT,
    Burner,
    burn,
    course,
    fire_at,
    rooms,
)
from tests.worlds.flats import flat
from tests.worlds.smoke_probes import conducted, passed

AIR = 353.0  # density times absolute temperature [kg K/m^3]
ENERGY, SOOT, LACK = 1, 2, 3  # parts of a layer
LACKING = 1 / 13100.0 + 0.232 / 50000.0  # oxygen that a fire of methane takes from as much air, per heat [kg/kJ]
SEALED = (0.0, 0.0, 2.0)


def test_a_wall_warms_as_a_half_space_does() -> None:
    """Concrete of 150 mm under 5 kW/m^2, which heat does not pass in 600 s: 2 q sqrt(t / (pi k rho c)) at the face."""
    k, c = 1.6e-3, 1800.0
    for seconds in (60.0, 225.0, 600.0):
        seen = conducted(Lining(k, c, 0.150), 1e-6, 5.0, 20.0, seconds, 800)
        deep = 0.5 * 0.150 * (RATIO - 1) / (RATIO**CELLS - 1)  # middle of the first layer
        spread = 2 * math.sqrt(k / c * seconds)
        z = deep / spread
        exact = 5.0 / k * (spread / math.sqrt(math.pi) * math.exp(-(z**2)) - deep * math.erfc(z))
        assert float(seen[0]) - 20.0 == pytest.approx(exact, rel=0.02)


def test_a_wall_comes_to_the_temperature_that_its_films_give() -> None:
    """Gypsum board between gas of 220 C, film 20 W/m^2 K, and a room, film 10: heat passes three resistances in row."""
    seen = conducted(GYPSUM, 0.020, 0.0, 220.0, 40_000.0, 2000)
    through = 200.0 / (1 / 0.020 + 0.016 / 0.17e-3 + 1 / 0.010)
    first = 0.5 * 0.016 * (RATIO - 1) / (RATIO**CELLS - 1)
    assert float(seen[0]) == pytest.approx(220.0 - through * (1 / 0.020 + first / 0.17e-3), abs=0.5)


SIDES = st.tuples(st.floats(-5.0, 5.0), st.floats(0.0, 2.6), st.floats(0.3, 1.2))


@settings(max_examples=40, deadline=None)
@given(a=SIDES, b=SIDES, sill=st.sampled_from([0.0, 0.9]))
def test_openings_pass_what_the_pressure_over_their_height_drives(a: tuple, b: tuple, sill: float) -> None:
    """Against sums over 4,000 strips."""
    found = passed((0.9, sill, 2.1), (*a, 1.204), (*b, 1.204))
    z = np.linspace(sill, 2.1, 4001)
    z, strip = 0.5 * (z[1:] + z[:-1]), (2.1 - sill) / 4000
    head = [p + 9.81 * (1.204 - rho) * np.maximum(z - face, 0.0) for p, face, rho in (a, b)]
    drive = head[0] - head[1]
    want = []
    for sign, (_, face, rho) in ((1.0, a), (-1.0, b)):
        flow = 0.7 * 0.9 * strip * np.sqrt(2.0 * np.maximum(sign * drive, 0.0))
        hot = z > face
        want += [float((flow * hot).sum() * math.sqrt(rho)), float((flow * ~hot).sum() * math.sqrt(1.204))]
    assert found == pytest.approx(want, rel=0.01, abs=0.02)


def heat_in_walls(state: BlazeState) -> float:
    """Heat [kJ] in the linings of the one room."""
    shares = RATIO ** np.arange(CELLS)
    depth = float(state.lining_thickness) * shares / shares.sum()
    whole = 2 * float(state.zone_area) + float(state.zone_edge) * float(state.height)
    upper = float(state.zone_wall)
    held = [(float((state_ - 20.0) @ torch.tensor(depth, dtype=torch.float32))) for state_ in (
        state.zone_upper[0, 0], state.zone_lower[0, 0])]  # fmt: skip
    return float(state.lining_capacity) * (upper * held[0] + (whole - upper) * held[1])


def test_heat_and_soot_are_conserved_in_a_sealed_room() -> None:
    """What a fire gives off in 25 s is in the layer and in the walls, the radiated part too."""
    burner = Burner(200.0, step=0.25)
    state, world = rooms(Room((6.8, 6.4)))
    burn(state, world, burner, fire_at(3.4, 3.2, burner), 25.0)
    assert float(state.zone_height) > 0.0
    assert float((state.zone_smoke + state.zone_air)[0, 0, ENERGY]) + heat_in_walls(state) == pytest.approx(
        200.0 * 25.0, rel=0.005
    )
    assert float((state.zone_smoke + state.zone_air)[0, 0, SOOT]) == pytest.approx(burner.soot * 200.0 * 25.0, rel=1e-3)
    assert float((state.zone_smoke + state.zone_air)[0, 0, LACK]) == pytest.approx(200.0 * 25.0 * LACKING, rel=1e-3)


@pytest.mark.parametrize("power", [50.0, 100.0, 300.0])
def test_a_room_fills_as_zukoski_says(power: float) -> None:
    """Height of the layer under a room of insulated walls against the equation of filling, within 10 %."""
    burner = Burner(power, (12.0, 10.0, 6.0), SLOT, INSULATED, 0.0, step=0.25)
    times = (10.0, 20.0, 30.0, 60.0)
    seen = course(burner, times)
    z, dt = 6.0, 0.01
    for n in range(1, 6001):
        z -= dt / 120.0 * (power / AIR + 0.21 * (9.81 / AIR) ** (1 / 3) * power ** (1 / 3) * z ** (5 / 3))
        if n / 100 in times:
            assert seen[n / 100].height == pytest.approx(z, rel=0.1)
            assert 6.0 - seen[n / 100].height == pytest.approx(6.0 - z, rel=0.1)


def test_smoke_passes_an_open_doorway_and_nothing_is_lost_on_the_way() -> None:
    """Soot and missing oxygen of both rooms of a flat, before any leaves through the gap."""
    state, _ = flat(15.0, 100.0)
    made = 100.0 * 15.0
    assert float(state.zone_smoke[0, 1, SOOT]) > 0.01 * float(state.zone_smoke[0, 0, SOOT])
    assert float((state.zone_smoke + state.zone_air)[..., SOOT].sum()) == pytest.approx(made * 0.015 / 11900, rel=1e-3)
    assert float((state.zone_smoke + state.zone_air)[..., LACK].sum()) == pytest.approx(made * LACKING, rel=1e-3)
    assert float(state.zone_temperature[0, 0]) > float(state.zone_temperature[0, 1]) > 20.0


def test_both_rooms_of_a_flat_find_the_pressure_at_which_their_volumes_balance() -> None:
    """At 300 kW behind a closed door the gap passes what the heat makes: some 20 Pa in both rooms."""
    state, _ = flat(30.0, 300.0)
    first, second = state.zone_pressure[0].tolist()
    assert first == pytest.approx(second, abs=2.0) and 5.0 < second < 400.0


def test_a_closed_room_runs_out_of_oxygen() -> None:
    """The layer has at most (23.2 - 16.6) % of its mass to give: 13.1 MJ per kg of oxygen."""
    state, world = rooms(Room((6.8, 6.4)))
    burner = Burner(1000.0)
    fire = fire_at(3.4, 3.2, burner)
    given, before = 0.0, 1000.0
    for _ in range(40):
        before = burn(state, world, burner, fire, 7.5)
        given += before * 7.5
    mass = 1.204 * 6.8 * 6.4 * 2.6
    assert before < 200.0 and given <= 1.15 * 13100.0 * (0.232 - 0.166) * mass
    assert float(state.zone_share) == pytest.approx(before / 1000.0, rel=1e-3)


def test_panes_fall_out_of_windows_when_the_layer_is_hot() -> None:
    window = Opening("window", "north", 2.0, 1.2, 1.2, 0.9)
    state, world = rooms(Room((4.0, 4.0), openings=(window,)))
    burner = Burner(1500.0)
    cold = fire_at(2.0, 2.0, burner)._replace(power=torch.tensor([[20.0]]))
    burn(state, world, burner, cold, 60.0)
    assert state.vents[0, 0].tolist() == pytest.approx([0.02, 0.9, 2.1, 1.2])
    burn(state, world, burner, fire_at(2.0, 2.0, burner), 60.0)
    assert float(state.vents[0, 0, 0]) == pytest.approx(1.2)


@settings(max_examples=25, deadline=None)
@given(power=st.floats(1.0, 20000.0), step=st.floats(0.01, 5.0), width=st.sampled_from([0.0, 0.02, 0.9, 3.0]))
def test_a_layer_stays_in_its_room_and_below_the_heat_of_flames(power: float, step: float, width: float) -> None:
    burner = Burner(power, (4.0, 3.0, 2.4), step=step)
    state, world = rooms(Room((4.0, 3.0), 2.4, openings=(Opening("door", "south", 2.0, 0.9, 2.0),)))
    state.vents[0, 0, 0] = width
    fire = fire_at(2.0, 1.5, burner)
    for part in range(30):
        now = fire if part < 20 else fire._replace(power=torch.zeros(1, 1))
        burn(state, world, burner, now, 5 * step)
        assert 0.0 <= float(state.zone_height) <= 2.4 + 1e-6 and 0.0 <= float(state.zone_share) <= 1.0
        assert 19.99 <= float(state.zone_temperature) <= 2000.0 and bool((state.zone_smoke >= 0).all())
        assert bool(state.zone_upper.isfinite().all()) and float(state.zone_upper.max()) <= 2000.0


def test_partitions_cut_a_scene_into_rooms_and_openings_know_theirs() -> None:
    inner = (Partition("partition_1", "y", 4.0, 0.2), Partition("partition_2", "y", 7.0, 0.2))
    holes = (
        Opening("doorway", "partition_1", 2.0, 0.9, 2.0),
        Opening("door", "south", 5.0, 0.9, 2.0),
        Opening("window", "east", 2.0, 1.2, 1.2, 0.9),
    )
    room = Room((10.0, 5.0), openings=holes, partitions=inner)
    assert ends(room, 0) == [4.0, 7.0, math.inf] and ends(room, 1) == [math.inf]
    assert [p.area for p in parts(room)] == pytest.approx([3.9 * 5.0, 2.8 * 5.0, 2.9 * 5.0])
    assert [p.edge for p in parts(room)] == pytest.approx([17.8, 15.6, 15.8])
    assert joined(room, holes) == [(0, 1), (1, -1), (2, -1)]
    assert joined(room, [Opening("door", "north", 8.0, 0.9, 2.0)]) == [(2, -1)]
    turned = Room((5.0, 10.0), partitions=(Partition("partition_1", "x", 6.0),), openings=(
        Opening("door", "north", 2.0, 0.9, 2.0), Opening("door", "west", 2.0, 0.9, 2.0),
    ))  # fmt: skip
    assert joined(turned, turned.openings) == [(1, -1), (0, -1)] and ends(turned, 1) == [6.0, math.inf]
    assert len(parts(Room((3.0, 2.0)))) == 1 and joined(Room((3.0, 2.0)), ()) == []
