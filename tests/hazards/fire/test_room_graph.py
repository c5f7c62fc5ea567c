"""Smoke in rooms that partitions of both directions cut: a graph of rooms, and openings between any two of them."""

from __future__ import annotations

import numpy as np
import pytest
import torch

from hazard_ms.hazards.fire.realistic import smoke
from hazard_ms.hazards.fire.realistic.blaze_state import BlazeState
from hazard_ms.hazards.fire.realistic.twozone.rooms import joined, parts
from hazard_ms.spec import Opening, Partition, Room
from hazard_ms.validation.experiments.smoke_room import INSULATED, Burner, burn, fire_at, rooms

CROSS = (Partition("cross", "x", 4.0), Partition("along", "y", 4.0))  # four rooms of 3.94 x 3.94 m
ROUND = tuple(Opening("doorway", wall, at, 0.9, 2.0) for wall in ("cross", "along") for at in (2.0, 6.0))
BURNER = Burner(300.0)


def burnt(room: Room, place: tuple[float, float], seconds: float, burner: Burner = BURNER) -> BlazeState:
    """The smoke of a room some time after a fire began; windows have no panes."""
    state, world = rooms(room, INSULATED)
    for k, o in enumerate(room.openings):
        if o.kind == "window":
            state.vents[0, k, 0] = o.width
    burn(state, world, burner, fire_at(*place, burner), seconds)
    return state


def test_rooms_are_the_cells_that_partitions_cut() -> None:
    room = Room((10.0, 8.0), partitions=(*CROSS, Partition("far", "y", 7.0)))
    assert [p.area for p in parts(room)] == pytest.approx([w * 3.94 for _ in range(2) for w in (3.94, 2.88, 2.94)])
    holes = (
        *(Opening("doorway", "cross", at, 0.9, 2.0) for at in (2.0, 5.0, 9.0)),
        *(Opening("door", "far", at, 0.9, 2.0) for at in (2.0, 6.0)),
        *(Opening("window", wall, 7.5, 0.5, 1.0, 1.0) for wall in ("south", "north", "west", "east")),
    )
    assert joined(room, holes) == [(0, 3), (1, 4), (2, 5), (1, 2), (4, 5), (2, -1), (5, -1), (3, -1), (5, -1)]
    state, _ = rooms(room)
    points = torch.tensor([[[1.0, 1.0, 0.0], [5.0, 1.0, 0.0], [9.0, 1.0, 0.0], [1.0, 7.0, 0.0], [9.0, 7.0, 0.0]]])
    assert smoke.zone_of(state, points).tolist() == [[0, 1, 2, 3, 5]]


def test_smoke_goes_round_four_rooms_the_same_on_both_ways() -> None:
    window = Opening("window", "east", 6.0, 1.0, 2.0)  # of the room farthest from the fire
    state = burnt(Room((8.0, 8.0), openings=(*ROUND, window), partitions=CROSS), (2.0, 2.0), 60.0)
    near, right, left, far = state.zone_temperature[0].tolist()
    assert near > right + 20.0 > far + 20.0 > 60.0 and right == pytest.approx(left, abs=0.1)
    low, *between, end = state.zone_pressure[0].tolist()
    assert between[0] == pytest.approx(between[1], abs=1e-3)
    closed = burnt(Room((8.0, 8.0), openings=(*ROUND[:3], window), partitions=CROSS), (2.0, 2.0), 60.0)
    assert closed.zone_temperature[0, 1] > closed.zone_temperature[0, 2] + 5.0  # all of it goes the one way


def test_a_row_that_a_closed_wall_cuts_off_is_as_without_it() -> None:
    """The pressures of two rooms in a row by bisection, and by Newton's method as two of four rooms."""
    ways = (Opening("doorway", "along", 2.0, 0.9, 2.0), Opening("window", "east", 2.0, 1.0, 2.0))
    fire = ((2.0, 2.0), 45.0)
    one = burnt(Room((8.0, 3.94), openings=ways, partitions=CROSS[1:]), *fire)
    two = burnt(Room((8.0, 8.0), openings=ways, partitions=CROSS), *fire)
    for name in ("zone_temperature", "zone_height", "zone_low_temperature"):
        assert getattr(two, name)[0, :2].tolist() == pytest.approx(getattr(one, name)[0].tolist(), rel=2e-3), name
    assert two.zone_pressure[0, :2].tolist() == pytest.approx(one.zone_pressure[0].tolist(), abs=0.01)
    assert two.zone_smoke[0, 2:].abs().max() == 0.0 and two.zone_pressure[0, 2:].tolist() == [0.0, 0.0]


def filled(gas: torch.Tensor) -> float:
    """Volume [m^3] of a gas of the heat capacity 1 + 0.0001 dT kJ/kg K."""
    heat = float(gas[1] / gas[0].clamp(min=1e-6))
    return float(gas[0]) / 353.0 * (293.15 + 2.0 * heat / (1.0 + (1.0 + 4e-4 * heat) ** 0.5))


@pytest.mark.parametrize("seed", range(8))
def test_the_gas_of_all_rooms_fits_into_them(seed: int) -> None:
    """In up to nine rooms with openings by lot, from wide open to nearly closed: volumes balance in each of them."""
    draw = np.random.default_rng(seed)
    inner = tuple(Partition(f"p{k}", axis, 3.0 * (1 + k // 2)) for k, axis in enumerate("xyxy"))
    ways = tuple(
        Opening("doorway", p.name, at, float(draw.choice([0.05, 0.4, 0.9])), 2.0)
        for p in inner
        for at in (1.5, 4.5, 7.5)
        if draw.random() < 0.75
    )
    holes = tuple(Opening("window", wall, 4.5, 0.8, 1.0, 0.9) for wall in ("south", "east"))
    room = Room((9.0, 9.0), openings=(*ways, *holes), partitions=inner)
    state = burnt(room, (4.5, 4.5), 60.0, Burner(float(draw.choice([50.0, 500.0])), step=0.25))
    gas = state.zone_smoke + state.zone_air
    joined_to = {0: set(), **{r: set() for r in range(9)}}
    for a, b in joined(room, room.openings):
        joined_to[a].add(b)
        joined_to.setdefault(b, set()).add(a)
    vented, new = set(), {-1}
    while new:
        vented, new = vented | new, {r for v in new for r in joined_to[v]} - vented - new
    for r in range(9):
        volume = float(state.zone_area[0, r]) * 2.6
        fills = sum(filled(part[0, r]) for part in (state.zone_smoke, state.zone_air))
        if r in vented:
            assert fills == pytest.approx(volume, rel=0.03), r
    assert bool(gas.isfinite().all()) and float(gas[..., 0].min()) >= 0.0
    assert float(state.zone_pressure.abs().max()) < 2000.0
