"""Balances of the smoke over whole episodes: oxygen, heat and pressure, in rooms of all splits, by all severities."""

from __future__ import annotations

import math
from collections.abc import Sequence

import pytest
import torch

from hazard_ms.hazards.fire.realistic import radiation
from hazard_ms.hazards.fire.realistic.blaze_state import BlazeState
from hazard_ms.hazards.fire.realistic.twozone.gas import PARTS
from hazard_ms.hazards.fire.realistic.twozone.lining import CELLS, RATIO
from hazard_ms.scenes.splits import scene, scene_names, split_names
from hazard_ms.spec import Opening, Partition, Room, SceneSpec
from hazard_ms.spec.severity import SEVERITIES
from hazard_ms.validation.experiments.smoke_room import INSULATED, WOOD, Burner, burn, fire_at, rooms
from tests.worlds.flood_balance import drawn

MASS, ENERGY, LACK = 0, 1, 3  # parts of a layer
PER_OXYGEN, OXYGEN = 13100.0, 0.232  # [kJ/kg], [-]
FUEL = 50000.0  # heat per fuel of methane [kJ/kg]
EPISODE = 50.0 * 4.5  # seconds of fire [s]
STEP = 0.75  # [s]


def kept(state: BlazeState) -> torch.Tensor:
    """Heat [kJ] in the gas and in the linings of all rooms, [E]."""
    shares = RATIO ** torch.arange(CELLS, dtype=torch.float64)
    depth = state.lining_thickness[:, None, None] * shares / shares.sum()  # [E, 1, CELLS]
    upper, lower = (((v.double() - 20.0) * depth).sum(-1) for v in (state.zone_upper, state.zone_lower))
    whole, high = 2 * state.zone_area + state.zone_edge * state.height[:, None], state.zone_wall.double()
    walls = torch.where(state.zone_area > 0, high * upper + (whole - high) * lower, 0.0).sum(1)
    return (state.zone_smoke + state.zone_air)[..., ENERGY].double().sum(1) + state.lining_capacity * walls


def reach(state: BlazeState) -> float:
    """Largest flow of air [kg/s] into all rooms together: 0.52 A sqrt(H) of what can be open (Kawagoe)."""
    out = (state.vent_to[0] < 0) & (state.vents[0, :, 3] > 0)
    _, low, high, wide = state.vents[0, out].unbind(-1)
    area = float((wide * (high - low)).sum())
    return 0.52 * area * math.sqrt(float(high.max() - low.min())) if area > 0.0 else 0.0


def check(room: Room, places: list[tuple[float, float]], growth: float, most: float, seconds: float = EPISODE) -> float:
    """Burn a room's fires, which grow to `most` [kW] in all, and hold every balance; returns the largest share of air.

    Burnt heat is at most that of the oxygen there and of what openings can let in.
    """
    state, world = rooms(room)
    limit, volume = reach(state), float((state.zone_area * state.height[:, None]).sum())
    burner = Burner(most / len(places), step=STEP)
    fires = [fire_at(*place, burner) for place in places]
    fire = radiation.Fires(*(torch.cat([getattr(f, name) for f in fires], 1) for name in radiation.Fires._fields))
    burnt, before, largest, was_open = 0.0, 0.0, 0.0, False
    steps = round(seconds / STEP)
    for step in range(1, steps + 1):
        power = torch.clamp(fire.power.new_full((1, len(places)), growth * (60.0 + step * STEP) ** 2), max=burner.power)
        burnt += STEP * burn(state, world, burner, fire._replace(power=power), STEP)
        gas = state.zone_smoke + state.zone_air
        assert bool(gas.isfinite().all()) and float(gas[..., MASS].min()) >= 0.0
        assert float(kept(state)) <= burnt * 1.002 + 1.0
        assert burnt <= PER_OXYGEN * (OXYGEN * 1.204 * volume + limit * step * STEP)
        lack = gas[..., LACK]
        assert bool((lack <= OXYGEN * gas[..., MASS] + 1e-3).all())
        if was_open:  # for at least a step
            assert float(state.zone_pressure.abs().max()) < 30.0
        was_open = float(state.vents[0, (state.vent_to[0] < 0), 0].max()) > 0.1
        largest, before = max(largest, (burnt - before) / STEP / max(PER_OXYGEN * OXYGEN * limit, 1.0)), burnt
        fits = (gas[0, :, MASS] * 293.15 / 353.0).sum()
        assert float(fits) <= volume * 1.3
    return largest


def opened(room: Room) -> Room:
    """The room with holes for its outer doors once it is hot: windows, whose panes fall out."""
    holes = tuple(
        Opening("window", o.wall, o.centre, o.width, o.height, o.sill) if o.kind == "door" else o for o in room.openings
    )
    return Room(room.size, room.height, openings=holes, partitions=room.partitions, wall=room.wall)


def check_scenes(specs: Sequence[SceneSpec], severity: str) -> None:
    """Scenes' own rooms, closed and with doors open, with the fires of a severity, and three times as much."""
    strength = SEVERITIES[severity]
    for spec in specs:
        places = [(float(x), float(y)) for x, y in spec.fires] or [(1.0, 1.0)]
        for room, times in ((spec.room, 1.0), (opened(spec.room), 3.0)):
            check(room, places, strength.fire_growth, times * strength.fire_start)


@pytest.mark.parametrize("severity", SEVERITIES)
@pytest.mark.parametrize("split", split_names())
def test_oxygen_heat_and_pressure_balance_over_an_episode(split: str, severity: str) -> None:
    """One scene of each split, another one for each severity."""
    check_scenes([scene(scene_names(split)[7 * list(SEVERITIES).index(severity)])], severity)


@pytest.mark.parametrize("severity", SEVERITIES)
@pytest.mark.parametrize("split", split_names())
@pytest.mark.long
@pytest.mark.timeout(3600)
def test_oxygen_heat_and_pressure_balance_in_many_scenes(split: str, severity: str) -> None:
    """Fifty scenes of each split; those that belong to none make up the number."""
    for spec in drawn(split, 50):
        check_scenes([spec], severity)


def test_a_room_after_flashover_burns_what_its_door_lets_in() -> None:
    """Kawagoe: 1,500 A sqrt(H) kW within 30 %, and hardly any pressure, after one and after ten minutes of 8 MW."""
    room = opened(Room((3.6, 2.4), 2.4, openings=(Opening("door", "south", 1.8, 0.8, 2.0),)))
    state, world = rooms(room)
    burner = Burner(8000.0, combustion=WOOD)
    for seconds in (60.0, 540.0):
        burns = burn(state, world, burner, fire_at(1.8, 1.2, burner), seconds)
        assert burns == pytest.approx(1500.0 * 1.6 * math.sqrt(2.0), rel=0.3)
        assert abs(float(state.zone_pressure)) < 15.0
        warmth = torch.stack([state.zone_temperature, state.zone_low_temperature]) + 273.15
        mass = torch.stack([state.zone_smoke, state.zone_air])[..., MASS]
        assert float((mass * warmth).sum()) / 353.0 == pytest.approx(3.6 * 2.4 * 2.4, rel=0.05)  # no gas too much
    assert 900.0 < float(state.zone_temperature) < 1600.0  # nothing is cut off


def test_no_heat_is_thrown_away_above_820_degrees() -> None:
    """In a sealed room whose walls take none, a layer hotter than flames were once let be has all that burnt."""
    state, world = rooms(Room((3.0, 3.0), 2.4), INSULATED)
    burner = Burner(3000.0, step=0.25, radiant=0.01)
    burnt = sum(0.25 * burn(state, world, burner, fire_at(1.5, 1.5, burner), 0.25) for _ in range(40))
    assert float(state.zone_temperature) > 850.0
    assert float((state.zone_smoke + state.zone_air)[..., ENERGY].sum()) == pytest.approx(burnt, rel=0.02)


def test_openings_carry_all_of_what_they_take() -> None:
    """Two rooms that are joined but closed to the outside: gas, lack of oxygen and soot of both add up."""
    parts = (Partition("partition_1", "y", 4.06),)
    room = Room((8.12, 4.0), 2.6, openings=(Opening("doorway", "partition_1", 2.0, 0.9, 2.0),), partitions=parts)
    state, world = rooms(room)
    burner = Burner(200.0)
    start = float(state.zone_air[..., MASS].sum())
    burnt = sum(STEP * burn(state, world, burner, fire_at(2.0, 2.0, burner), STEP) for _ in range(100))
    gas = (state.zone_smoke + state.zone_air).sum(1)[0].double()
    assert len(gas) == PARTS and float(gas[MASS]) == pytest.approx(start + burnt / FUEL, rel=1e-5)
    assert float(gas[LACK]) == pytest.approx(burnt * (1 / PER_OXYGEN + OXYGEN / FUEL), rel=1e-4)
    assert float(kept(state)) == pytest.approx(burnt, rel=0.01)
