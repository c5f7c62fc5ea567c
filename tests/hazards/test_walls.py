"""No hazard acts through a closed inner wall, in any preset; through a doorway it acts as it does in the open."""

from __future__ import annotations

import dataclasses
from typing import Any

import pytest
import torch
import warp as wp

from hazard_ms.hazards import presets
from hazard_ms.hazards.base import Hazard
from hazard_ms.hazards.walls import Partitions, clear, cut_off, within
from hazard_ms.simulation.kernels.launch import Launches
from hazard_ms.simulation.walls import Walls, blocked
from hazard_ms.simulation.world import World
from hazard_ms.spec import Opening, Partition, Room, SceneSpec
from tests.worlds.fire_worlds import room_world

AT = 3.0  # where the wall crosses the room [m]
DOORWAY = Opening("doorway", "inner", 2.0, 0.9, 2.05)
FIRE = (2.5, 2.0)  # half a metre before the wall, in front of the doorway where there is one


@wp.kernel
def see(here: wp.array(dtype=wp.vec3), there: wp.array(dtype=wp.vec3), walls: Partitions, found: wp.array(dtype=bool)):
    """Set `found` to whether no wall stands between places [m]."""
    k = wp.tid()
    found[k] = clear(0, here[k], there[k], walls)


def spec_with(world: World, *openings: Opening, walls: bool = True, axis: str = "y") -> SceneSpec:
    room = Room(size=(6.0, 6.0), floor="carpet", openings=openings, partitions=(Partition("inner", axis, AT),) * walls)
    return dataclasses.replace(world.specs[0], room=room)


def burning_beside(*openings: Opening, walls: bool = True) -> World:
    """A book and the agent 0.5 m behind the middle of a wall, a fire 0.5 m before it."""
    world = room_world([("book", (3.5, 2.0, 0.0))], [FIRE], size=(6.0, 6.0), agent=(3.4, 2.0), extent=(0.2, 0.2, 0.2))
    spec = spec_with(world, *openings, walls=walls)
    return World.of((spec,), [[(0.2, 0.2, 0.2)]], [[1.0]])


def played(preset: str, world: World, seconds: float) -> tuple[Hazard, Any]:
    """The fire of a preset after so many seconds of an episode."""
    law = presets.hazard("fire", preset)
    rate = presets.FREQUENCIES[preset][0]
    state = law.state_type.allocate({"E": 1, "B": world.num_bodies, **law.sizes(world)}, world.device)
    law.reset(state, world, torch.arange(1))
    for _ in range(round(seconds * rate)):
        world.chance.frame += 1
        law.advance(state, world, 1.0 / rate)
    return law, state


@pytest.mark.parametrize("axis", ["x", "y"])
def test_a_straight_line_passes_a_wall_in_its_doorway_alone(axis: str) -> None:
    """By the crossing of the line with the plane, worked out here by bisection."""
    walls = Walls.of((spec_with(room_world(), DOORWAY, axis=axis),), "cpu")
    made = torch.Generator().manual_seed(3)
    here, there = (torch.rand(1, 300, 3, generator=made) * torch.tensor([6.0, 6.0, 2.6]) for _ in range(2))
    found = blocked(walls, here, there)[0].diagonal()
    across = 1 if axis == "x" else 0
    for k in range(300):
        low, high = here[0, k].double(), there[0, k].double()
        if (low[across] < AT) == (high[across] < AT):
            assert not found[k]
            continue
        if low[across] > high[across]:
            low, high = high, low
        for _ in range(60):
            middle = (low + high) / 2
            low, high = (middle, high) if middle[across] < AT else (low, middle)
        through = abs(float(low[1 - across]) - 2.0) < 0.45 and float(low[2]) < 2.05
        assert bool(found[k]) is not through
    assert 30 < int(found.sum()) < 250
    same = torch.empty(300, dtype=torch.bool)
    launches = Launches()
    launches.run(see, (300,), here[0].contiguous(), there[0].contiguous(), launches.struct(Partitions, walls), same)
    assert torch.equal(~same, found)


@pytest.mark.parametrize("device", ["cpu", pytest.param("cuda", marks=pytest.mark.gpu)])
def test_the_kernel_cuts_off_what_the_operations_in_torch_call_blocked(device: str) -> None:
    """In three environments with walls of both axes, doorways, a window and a door that is half open."""
    inner = Partition("other", "x", 2.5)
    door = Opening("door", "other", 4.6, 0.8, 2.0, open=0.5)
    window = Opening("doorway", "inner", 4.5, 1.0, 1.0, sill=0.9)
    base = spec_with(room_world(), DOORWAY, window)
    room = dataclasses.replace(base.room, partitions=(*base.room.partitions, inner), openings=(DOORWAY, window, door))
    specs = (base, dataclasses.replace(base, room=room), spec_with(room_world(), walls=False))
    walls = Walls.of(specs, device)
    made = torch.Generator().manual_seed(4)
    here, there = (torch.rand(3, n, 3, generator=made) * torch.tensor([6.0, 6.0, 2.6]) for n in (70, 90))
    asked = (torch.rand(3, 70, 90, generator=made) < 0.7).to(device)
    expected = asked & ~blocked(walls, here.to(device), there.to(device))
    left = cut_off(asked.clone(), walls, here.to(device), there.to(device))
    assert torch.equal(left, expected)
    lost = (asked & ~left).flatten(1).sum(1).tolist()
    assert lost[0] > 1000 and lost[1] > lost[0] and lost[2] == 0
    part = cut_off(asked[1:2].clone(), walls.part(slice(1, 2)), here[1:2].to(device), there[1:2].to(device))
    assert torch.equal(part, left[1:2])
    with pytest.raises(ValueError, match=r"there must have the shape \[3, 90, 3\]"):
        cut_off(asked, walls, here.to(device), here.to(device))


def test_floor_under_a_wall_is_found_and_that_in_a_doorway_is_free() -> None:
    walls = Walls.of((spec_with(room_world(), DOORWAY),), "cpu")
    x, y = torch.tensor([[2.9, 2.8, 3.1, 3.0, 3.0]]), torch.tensor([[5.0, 5.0, 5.0, 2.0, 1.6]])
    assert within(walls, x, y, 0.1).tolist() == [[True, False, True, False, True]]
    high = dataclasses.replace(DOORWAY, sill=0.5, height=1.5)
    walls = Walls.of((spec_with(room_world(), DOORWAY, axis="x"), spec_with(room_world(), high)), "cpu")
    x, y = torch.tensor([2.0, 2.0, 1.6, 5.0]).expand(2, 4), torch.tensor([2.9]).expand(2, 4)
    assert within(walls, x, y, 0.1).tolist() == [[False, False, True, True], [False, False, False, False]]
    assert within(walls, y, x, 0.1)[1].all()  # a window leaves no floor
    assert not Walls.none(2).any and not blocked(Walls.none(1), torch.zeros(1, 1, 3), torch.ones(1, 1, 3)).any()


@pytest.mark.parametrize("preset", presets.PRESETS)
def test_a_fire_does_nothing_behind_a_closed_wall(preset: str) -> None:
    """Things, agent, floor, picture, and where the agent may go stay as if nothing burned there."""
    world = burning_beside()
    law, state = played(preset, world, 20.0)
    assert state.status.tolist() == [[0]] and float(state.temperature[0, 0]) < 60.0
    behind = state.flame_place[state.flame_cell >= 0][:, 0]
    assert len(behind) > 3 and float(behind.max()) < AT - 0.06 - 0.1 + 1e-4
    points = torch.tensor([[[3.2, 2.0, 0.0], [3.5, 2.0, 0.5], [5.0, 4.0, 0.0], [2.6, 2.0, 0.3]]])
    shown = law.image(state, world, points)[0]
    open_world = burning_beside(walls=False)
    law_open, state_open = played(preset, open_world, 20.0)
    there = law_open.image(state_open, open_world, points)[0]
    assert float(shown[:3].max()) < 65.0 < 150.0 < float(there[0]) and float(shown[3]) > 150.0
    assert not law.forbids(state, world, points[:, :3]).any() and bool(law.forbids(state, world, points)[0, 3])
    told, told_open = law.agent_info(state, world), law_open.agent_info(state_open, open_world)
    if preset == "realistic":  # whose air is that of the smoke
        assert float(told["agent_flux"]) < 2.5 < float(told_open["agent_flux"])
    else:
        assert float(told["agent_temperature"]) < 60.0 < float(told_open["agent_temperature"])


@pytest.mark.parametrize("preset", presets.PRESETS)
def test_a_fire_acts_through_a_doorway(preset: str) -> None:
    """The thing in the line of the fire is heated through the doorway as it is without a wall."""
    seconds = 2.0
    through, without = burning_beside(DOORWAY), burning_beside(walls=False)
    (_, one), (_, two) = (played(preset, world, seconds) for world in (through, without))
    assert float(one.temperature[0, 0]) > 21.0
    assert float(one.temperature[0, 0]) == pytest.approx(float(two.temperature[0, 0]), abs=0.5)


def test_flames_reach_no_cell_of_the_floor_behind_a_wall() -> None:
    """What warms the floor there is the smoke that its gaps let through, a quarter of what flames give at most."""
    world = burning_beside()
    _, state = played("realistic", world, 10.0)
    half = state.free.shape[-1] // 2
    x = FIRE[0] + 0.22 * (torch.arange(state.free.shape[-1]) - half)
    warmth = state.floor_temperature[0, 0]
    assert float(warmth[(x < 2.8) & (x > 2.0)].max()) > 100.0
    assert float(warmth[x > 3.1].max()) < float(warmth[x < 2.8].max()) / 4
