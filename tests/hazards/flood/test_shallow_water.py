"""Water that flows over the floor: walls, doorways, furniture, what it holds, carries and leaves dry."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
import torch

from hazard_ms.hazards.flood.realistic import floor_plan
from hazard_ms.hazards.flood.realistic.inundation import Inundation
from hazard_ms.scenes.inlets import inlets
from hazard_ms.spec import Fixture, Opening, Partition
from hazard_ms.validation.experiments.basin import SMOOTH, Basin, door
from tests.worlds.flood_worlds import Thing, begin, room

FLAT = (Partition("middle", "y", 3.0),)
DOORWAY = Opening("doorway", "middle", 2.0, 0.9, 2.0)
NOTHING = [Thing((0.1,) * 3, at=(0.5, 0.5, 50.0))]
LAW = Inundation(outside=0.5)


def flat(*openings: Opening, sides: tuple[Partition, ...] = FLAT) -> tuple[object, object]:
    """The world and the state of two rooms of 3 x 4 m, with a door in the southern wall of the first."""
    world = room(
        NOTHING, "north", (6.0, 4.0), 1, (1.0, 1.0), sides, (Opening("door", "south", 1.5, 0.9, 2.0), *openings)
    )
    return world, begin(LAW, world)


def advance(world: object, state: object, seconds: float, law: Inundation = LAW) -> None:
    for _ in range(round(30 * seconds)):
        world.chance.tick()
        law.advance(state, world, 1 / 30)


def levels(world: object, state: object, *places: tuple[float, float]) -> list[float]:
    points = torch.tensor([[[*place, 0.0] for place in places]])
    return LAW.image(state, world, points)[0].tolist()


def test_a_closed_wall_keeps_the_other_room_dry_and_a_doorway_fills_it_later() -> None:
    world, state = flat()
    advance(world, state, 20.0)
    first, second = levels(world, state, (1.5, 3.0), (4.5, 2.0))
    assert first > 0.4 and second == 0.0
    world, state = flat(DOORWAY)
    advance(world, state, 4.0)
    first, second = levels(world, state, (1.5, 3.0), (5.5, 0.5))
    assert first > second + 0.02
    advance(world, state, 116.0)
    assert levels(world, state, (1.5, 3.0), (5.5, 0.5)) == pytest.approx([0.5, 0.5], abs=0.01)


def test_a_gap_under_a_door_lets_little_water_through() -> None:
    """Between the rooms, and in the outer wall: no more than an orifice whose head is all of the water."""
    most = 0.611 * 0.9 * 0.02 * math.sqrt(2 * 9.81 * 0.5) * 20.0
    world, state = flat(dataclasses.replace(DOORWAY, height=0.02))
    advance(world, state, 20.0)
    cells = state.depth[0].view(-1, floor_plan.size_of([world.specs[0].room])[1] + 2)
    second = float(cells[31:].sum()) * floor_plan.CELL**2
    assert 0.5 * most < second < most
    basin = Basin((3.0, 4.0), law=LAW, openings=(Opening("door", "south", 1.5, 0.9, 0.02),))
    basin.run(20.0)
    assert 0.95 * most < basin.volume < most


def test_water_comes_in_through_doors_and_else_through_the_middle_of_the_side() -> None:
    world, _ = flat()
    spec = world.specs[0]
    assert [(o.wall, o.centre) for o in inlets(spec)] == [("south", 1.5)]
    shut = dataclasses.replace(spec, room=dataclasses.replace(spec.room, openings=()), second_flood_side="west")
    assert [(o.wall, o.centre, o.width) for o in inlets(shut)] == [("north", 3.0, 0.9), ("west", 2.0, 0.9)]
    both = dataclasses.replace(spec, flood_side="east", second_flood_side="south")  # the door is in the second wall
    assert [(o.wall, o.centre) for o in inlets(both)] == [("south", 1.5), ("east", 2.0)]
    other = dataclasses.replace(spec, flood_side="east", second_flood_side="west")
    assert [o.wall for o in inlets(other)] == ["south", "west"]
    with pytest.raises(ValueError, match="flood_side must be one of west, east, south, north, got 'up'"):
        inlets(dataclasses.replace(shut, flood_side="up"))


def test_water_flows_round_what_stands_on_the_floor_and_under_what_has_legs() -> None:
    """Plain boxes: one on the floor, one on another one, one that hangs, a sheet and a leg."""
    at = {"chest": (1.0, 1.0, 0.0), "on_it": (1.0, 1.0, 0.5), "shelf": (3.0, 1.0, 1.0), "rug": (1.0, 3.0, 0.0)}
    edges = {"chest": (0.6, 0.6, 0.5), "on_it": (0.3, 0.3, 0.4), "shelf": (0.6, 0.6, 0.3), "rug": (0.6, 0.6, 0.02)}
    at["leg"], edges["leg"] = (3.05, 3.05, 0.0), (0.05, 0.05, 0.7)
    things = tuple(Fixture(name, "table", "none", place) for name, place in at.items())
    spec = dataclasses.replace(flat()[0].specs[0], fixtures=things)
    size = floor_plan.size_of([spec.room])
    bed = floor_plan.plan_of(spec, size, edges).bed.reshape(size[0] + 2, size[1] + 2)[1:-1, 1:-1]
    assert size == (60, 40)
    want = np.zeros(size, np.float32)
    want[7:13, 7:13] = 0.5  # cells whose middles are from 0.75 to 1.25 m
    want[9:11, 9:11] = 0.9  # the box on the chest reaches from 0.85 to 1.15 m
    inner = np.abs(0.1 * (np.arange(60) + 0.5) - 1.0) < 0.15
    want[7:13, 7:13] = np.where(np.outer(inner[7:13], inner[7:13]), 0.9, 0.5)
    np.testing.assert_allclose(bed, want, atol=1e-6)


def test_no_water_passes_walls_and_what_comes_in_stays() -> None:
    basin = Basin((6.0, 4.0), law=Inundation(outside=1.0), openings=(door(),))
    basin.run(100.0)
    came = float(basin.state.inflow) + float(basin.state.inflow_rest)
    assert came == pytest.approx(24.0, rel=0.01)  # as high inside as outside
    assert basin.volume == pytest.approx(came, rel=1e-6)
    depth = basin.get("depth")
    assert np.abs(np.diff(depth[20:30, 0])).max() < 0.005  # no cell of the door lets out what the next one lets in


def test_water_falls_over_an_edge_and_does_not_climb_it() -> None:
    """A plateau 0.3 m high beside a basin: 0.2 m of water on it runs down; 0.2 m in the basin stays below."""
    ground = np.where(np.arange(40) < 20, 0.3, 0.0)[:, None] * np.ones((1, 10))
    basin = Basin((4.0, 1.0), ground, np.where(ground > 0, 0.2, 0.0))
    basin.run(30.0)
    assert basin.get("depth")[:20].max() < 0.01 and basin.volume == pytest.approx(0.2 * 2.0, rel=1e-6)
    basin = Basin((4.0, 1.0), ground, np.where(ground > 0, 0.0, 0.2))
    basin.run(10.0)
    assert basin.get("depth")[:20].max() == 0.0 and basin.get("velocity_x").max() == 0.0


def test_what_floats_drifts_as_fast_as_the_water_where_it_is() -> None:
    """A ring of channels does not exist: a uniform flow is set, and a cork is pushed until it keeps its speed."""
    cork = Thing((0.1, 0.1, 0.1), 0.3, (1.0, 0.5, 0.52))
    basin = Basin((3.0, 1.0), depth=0.5, law=dataclasses.replace(SMOOTH, soaks=False), things=(cork,))
    basin.put("velocity_x", np.full(basin.cells, 0.4))
    basin.put("surface", np.full(basin.cells, 0.5))
    world, dt = basin.world, 1 / 120
    for _ in range(240):
        push = basin.law.force(basin.state, world, dt)
        assert push is not None
        world.velocity[0, 0, :2] += push.force[0, 0, :2] / world.mass[0, 0] * dt
    assert float(world.velocity[0, 0, 0]) == pytest.approx(0.4, rel=0.02)
    assert float(world.velocity[0, 0, 1]) == pytest.approx(0.0, abs=1e-6)


def test_a_thing_feels_the_slope_and_the_depth_where_it_is() -> None:
    """The surface falls by 5 cm a metre along x."""
    basin = Basin((3.0, 1.0), depth=0.5)
    x = 0.1 * (np.arange(30) + 0.5)
    basin.put("surface", np.broadcast_to((0.5 - 0.05 * x)[:, None], basin.cells))
    for at in (0.77, 1.5, 2.21):
        level, _ = basin.law._surface(basin.state, basin.world, torch.tensor([[[at, 0.43, 0.0]]]))
        assert float(level) == pytest.approx(0.5 - 0.05 * at, abs=1e-4)


def test_a_beam_under_a_sloping_surface_is_turned_by_it() -> None:
    """A box of length L and width b, cut at its sides only: the torque is density g slope b L^3 / 12."""
    beam = Thing((0.4, 0.1, 0.1), 500.0, (1.5, 0.5, 0.425))
    basin = Basin((3.0, 1.0), depth=0.5, things=(beam,))
    x = 0.1 * (np.arange(30) + 0.5)
    basin.put("surface", np.broadcast_to((0.5 - 0.05 * x)[:, None], basin.cells))
    push = basin.law.force(basin.state, basin.world, 1e-4)
    assert push is not None and push.torque is not None
    assert float(push.torque[0, 0, 1]) == pytest.approx(1000 * 9.81 * 0.05 * 0.1 * 0.4**3 / 12, rel=1e-3)


def test_a_cell_loses_no_more_water_than_it_holds() -> None:
    """Water in one cell runs off to all sides, so fast that twice as much would leave it in the first frame."""
    depth = np.zeros((21, 21))
    depth[10, 10] = 0.05
    basin = Basin((2.1, 2.1), depth=depth)
    away = np.zeros((21, 21))
    away[10, 10], away[11, 10] = -1.3, 1.3
    basin.put("velocity_x", away)
    basin.put("velocity_y", away.T)
    basin.run(1 / 30)
    assert basin.get("depth").sum() == pytest.approx(0.05, rel=1e-6)
    assert basin.get("depth") == pytest.approx(basin.get("depth").T, abs=1e-6) and basin.get("depth").min() >= 0.0


def test_inside_furniture_water_stands_as_high_as_around_it() -> None:
    """A cupboard of 0.8 m in water of 0.4 m: a book on its shelf gets wet, the top stays dry."""
    ground = np.zeros((20, 20))
    ground[6:14, 6:14] = 0.8
    basin = Basin((2.0, 2.0), ground, np.where(ground > 0, 0.0, 0.4))
    basin.run(0.5)
    assert basin.get("surface")[6:14, 6:14] == pytest.approx(np.full((8, 8), 0.4), abs=1e-3)
    assert basin.get("depth")[6:14, 6:14].max() == 0.0


@pytest.mark.parametrize(("name", "value"), [("outside", -0.1), ("outside", math.nan), ("roughness", -1.0)])
def test_impossible_parameters_are_refused(name: str, value: float) -> None:
    with pytest.raises(ValueError, match=name):
        dataclasses.replace(LAW, **{name: value})


def test_the_shortest_waves_do_not_grow_in_the_longest_steps() -> None:
    """Waves of two cells, in frames that are longer than a step; in steps a tenth longer they grow twelvefold."""
    i, j = np.indices((60, 60))
    basin = Basin((6.0, 6.0), depth=0.5 + 0.002 * (-1.0) ** (i + j))
    highest = 0.0
    for _ in range(60):
        basin.run(0.5, 1 / 30)
        highest = max(highest, float(np.sqrt(np.mean((basin.get("depth") - 0.5) ** 2))))
    assert highest < 2.0 * 0.002
