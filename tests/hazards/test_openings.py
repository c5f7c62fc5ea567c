"""One state of doors and windows: what is closed stops all but its leak, whoever asks; what breaks it; saved states."""

from __future__ import annotations

import dataclasses
import math
from typing import Any

import numpy as np
import pytest
import torch

from hazard_ms.hazards import presets
from hazard_ms.hazards.base import begin
from hazard_ms.hazards.fire import floor
from hazard_ms.hazards.fire.realistic.twozone import leaves
from hazard_ms.hazards.flood import flow_paths
from hazard_ms.hazards.flood.flood import Flood
from hazard_ms.hazards.flood.realistic import openings
from hazard_ms.hazards.flood.realistic.inundation import Inundation
from hazard_ms.simulation.walls import blocked
from hazard_ms.simulation.world import World
from hazard_ms.spec import Opening, Partition, Room
from hazard_ms.tasks.episode import snapshot
from hazard_ms.tasks.episode.episode import Episode
from hazard_ms.validation.experiments.basin import SMOOTH, Basin
from hazard_ms.validation.experiments.smoke_room import INSULATED, Burner, burn, fire_at, rooms
from hazard_ms.validation.experiments.tank import Thing, room
from tests.hazards.test_walls import DOORWAY, burning_beside, played
from tests.worlds.fire_worlds import repeat

DOOR = dataclasses.replace(DOORWAY, kind="door")  # 0.9 x 2.05 m around 2.0 m of the wall "inner" at 3 m
WALL = Partition("inner", "y", 3.0)
ONE = torch.arange(1)
NOTHING = (Thing((0.1,) * 3, at=(0.05, 0.05, 50.0)),)


def basin(*doors: Opening, depth: float | np.ndarray = 0.0, law: Inundation = SMOOTH) -> Basin:
    """A room of 6 x 4 m in two halves, the western one `depth` [m] deep, without water from outside."""
    deep = np.where(np.arange(60)[:, None] < 30, depth, 0.0) * np.ones((60, 40))
    made = Basin((6.0, 4.0), depth=deep, partitions=(WALL,), openings=doors, law=law)
    made.state.inlet[:] = -1
    return made


def seen(world: World, along: float) -> bool:
    """Whether a straight line across the wall at a place along it [m] is free."""
    ends = (torch.tensor([[[x, along, 1.0]]]) for x in (2.5, 3.5))
    return not bool(blocked(world.walls, *ends))


@pytest.mark.parametrize("preset", presets.PRESETS)
def test_a_fire_does_nothing_behind_a_closed_door_and_all_once_it_is_open(preset: str) -> None:
    world = burning_beside(DOOR)
    _, state = played(preset, world, 20.0)
    behind = state.flame_place[state.flame_cell >= 0][:, 0]
    assert state.status.tolist() == [[0]] and float(state.temperature[0, 0]) < 60.0
    assert len(behind) > 3 and float(behind.max()) < 3.0 - 0.06 - 0.1 + 1e-4
    through = burning_beside(DOOR)
    through.openings.set_open(ONE, 0, 1.0)
    (_, one), (_, two) = (played(preset, w, 3.0) for w in (through, burning_beside(DOORWAY)))
    assert float(one.temperature[0, 0]) == float(two.temperature[0, 0]) > 21.0


def test_lines_pass_what_is_open_of_a_door_and_flames_lie_there_only() -> None:
    world = burning_beside(DOOR)
    x, y = torch.full((1, 3), 3.0), torch.tensor([[1.7, 2.1, 2.3]])
    for share, free in ((0.0, ()), (0.5, (2.1, 2.3)), (1.0, (1.7, 2.1, 2.3)), (0.0, ())):
        world.openings.set_open(ONE, 0, share)
        assert [seen(world, along) for along in (1.7, 2.1, 2.3)] == [along in free for along in (1.7, 2.1, 2.3)]
        assert floor.shut(world, x, y)[0].tolist() == [along not in free for along in (1.7, 2.1, 2.3)]
    assert bool(floor.free_floor(world, ONE, torch.tensor([[[3.0, 2.0]]]), 1, True))  # it may open


def test_doors_bear_only_numbers_that_are_shares_and_doorways_have_no_leaf() -> None:
    world = burning_beside(DOORWAY, DOOR)
    with pytest.raises(ValueError, match="share must be from 0 to 1, got 1.5"):
        world.openings.set_open(ONE, 1, 1.5)
    with pytest.raises(ValueError, match=r"opening must be from 0 to \d, got 7"):
        world.openings.set_open(ONE, 7, 0.5)
    world.openings.set_open(ONE, 0, 0.0)
    assert world.openings.share[0, :2].tolist() == [1.0, 0.0]


def test_water_leaks_under_a_closed_door_and_flows_through_what_is_open() -> None:
    """Orifice 0.611 a sqrt(2 g H) under the leaf; in the gap of an ajar door a weir, as wide as the share says."""
    came = {}
    for share in (0.0, 0.5, 1.0):
        made = basin(DOOR, depth=0.5)
        made.world.openings.set_open(ONE, 0, share)
        made.run(1.0)
        came[share] = float(made.get("depth")[30:].sum()) * 0.01 / made.now
    assert came[0.0] == pytest.approx(0.611 * 0.9 * 0.02 * math.sqrt(2 * 9.81 * 0.5), rel=0.08)
    assert came[0.5] / came[1.0] == pytest.approx(0.5, abs=0.12)  # of nine cells, four or five
    shut = Basin(
        (6.0, 4.0), law=dataclasses.replace(SMOOTH, outside=0.5), openings=(Opening("door", "south", 2, 0.9, 2),)
    )
    shut.world.openings.set_open(ONE, 0, 0.0)
    shut.run(2.0)
    assert shut.volume / shut.now == pytest.approx(0.611 * 0.9 * 0.02 * math.sqrt(2 * 9.81 * 0.5), rel=0.03)


def test_smoke_leaks_around_a_closed_door_by_the_same_gap() -> None:
    """What 200 kW make, Q / 353 m^3/s, goes through 0.7 a sqrt(2 dp / rho), a = 0.02 x 2.05 m^2: some 240 Pa."""
    leak = Opening("window", "east", 2.0, 1.0, 2.0)
    state, world = rooms(Room((6.0, 4.0), openings=(DOOR, leak), partitions=(WALL,)), INSULATED)
    state.vents[0, 1, 0] = 1.0
    burner = Burner(200.0, radiant=0.0, step=0.25)
    burn(state, world, burner, fire_at(1.5, 2.0, burner), 5.0)
    flow = 200.0 / 353.0 / (0.7 * 0.02 * 2.05)
    first, second = state.zone_pressure[0].tolist()
    assert first - second == pytest.approx(0.5 * 1.2 * flow**2, rel=0.10) and abs(second) < 1.0
    world.openings.set_open(ONE, 0, 0.5)
    assert leaves.vents(world)[0, 0].tolist() == pytest.approx([0.45, 0.0, 2.05, 0.45])


def test_nothing_passes_a_wall_without_an_opening() -> None:
    hole = Opening("window", "west", 2.0, 1.0, 2.0)
    state, world = rooms(Room((6.0, 4.0), openings=(hole,), partitions=(WALL,)))
    burner = Burner(300.0)
    burn(state, world, burner, fire_at(1.5, 2.0, burner), 30.0)
    air = 3.0 - 0.06
    assert float(state.zone_temperature[0, 0]) > 100.0
    assert state.zone_smoke[0, 1].tolist() == [0.0] * 6 and float(state.zone_pressure[0, 1]) == 0.0
    assert state.zone_air[0, 1].tolist() == pytest.approx([air * 4.0 * 2.6 * 353.0 / 293.15, *[0.0] * 5], rel=2e-3)


def test_air_does_not_pass_what_is_under_water() -> None:
    """The lower end of a doorway is where the water stands; one that is drowned joins no rooms."""
    state, world = rooms(Room((6.0, 4.0), openings=(DOORWAY, Opening("window", "west", 2, 1, 2)), partitions=(WALL,)))
    burner, depth = Burner(300.0), [0.0, 0.8]
    world.fields["water"] = lambda points: torch.where(points[..., 0] > 3.0, depth[1], depth[0])
    assert leaves.vents(world)[0, 0].tolist() == pytest.approx([0.9, 0.8, 2.05, 0.9])
    depth[0] = 2.2
    state.vents.copy_(leaves.vents(world))
    state.vents[0, 1] = torch.tensor([1.0, 0.0, 2.0, 1.0])
    burn(state, world, burner, fire_at(1.5, 2.0, burner), 30.0)
    assert float(state.zone_smoke[0, 1].sum()) == 0.0 and float(state.zone_pressure[0].abs().max()) < 50.0


def test_one_state_is_seen_by_fire_smoke_and_water() -> None:
    made = basin(DOOR)
    for share, wide, high in ((0.0, 0.02, 0.02), (1.0, 0.9, 2.05)):
        made.world.openings.set_open(ONE, 0, share)
        openings.set_heights(made.state, made.world)
        heights = made.state.open_x[0].view(62, 42)[31, 17:25]  # the sides of the cells from 1.6 to 2.4 m
        assert heights.tolist() == pytest.approx([high] * 8)
        assert float(leaves.vents(made.world)[0, 0, 0]) == pytest.approx(wide) and seen(made.world, 2.0) is bool(share)


@pytest.mark.parametrize("seed", range(12))
def test_water_of_paper_finds_its_way_through_the_doors_that_are_open(seed: int) -> None:
    """As through doorways in place of the open ones and walls in place of the closed ones, opened one by one."""
    draw = np.random.default_rng(seed)
    inner = tuple(Partition(f"p{k}", axis, at) for k, (axis, at) in enumerate((("y", 2.0), ("x", 3.0), ("y", 4.5))))
    ways = [(p.name, float(draw.uniform(0.6, 5.4))) for p in inner for _ in range(2)]
    is_open = draw.random(len(ways)) < 0.6
    side = str(draw.choice(["east", "south"]))
    doors = tuple(Opening("door", name, at, 0.9, 2.0) for name, at in ways)
    holes = tuple(
        Opening("doorway", name, at, 0.9, 2.0) for (name, at), free in zip(ways, is_open, strict=True) if free
    )
    (a, one), (b, two) = (begun_paper(side, inner, given) for given in (doors, holes))
    for k in np.nonzero(is_open)[0].tolist():
        a.openings.set_open(ONE, k, 1.0)
    Flood().advance(one, a, 1 / 30)
    points = torch.from_numpy(draw.uniform(0.1, 5.9, (1, 50, 3))).float()
    lengths, directions = flow_paths.path_lengths(one, points)
    expected, toward = flow_paths.path_lengths(two, points)
    assert torch.allclose(lengths, expected, rtol=1e-5, atol=1e-4) and torch.allclose(directions, toward, atol=1e-3)


def begun_paper(side: str, inner: tuple[Partition, ...], ways: tuple[Opening, ...]) -> tuple[World, Any]:
    world = room(NOTHING, side, (6.0, 6.0), 1, (0.5, 0.5), inner, ways)
    world = dataclasses.replace(world, specs=(dataclasses.replace(world.specs[0], second_flood_side="north"),))
    return world, begin(Flood(), world)


def test_openings_are_saved_restored_and_reset_by_rows() -> None:
    """A replay from a saved state is the same bit by bit, the walls as well; a reset of one row leaves the other."""
    world = repeat(burning_beside(DOOR, Opening("window", "west", 2.0, 1.0, 1.0, 0.9)), 2)
    episode = Episode(world, tuple(presets.hazard(name, "realistic") for name in ("flood", "fire")))
    rows = torch.arange(2)
    episode.begin(rows, rows)
    episode.begin_hazards(rows)
    start = world.openings.state.save()
    assert start["open"][0].tolist() == [0.0, 0.0, 1.0]  # the third is where water comes in
    world.openings.set_open(torch.tensor([1]), 0, 0.3)
    world.openings.state.hold[0, 0] = 1.0
    saved, frames = snapshot.copied(snapshot.save(episode)), 40
    spans = world.walls.doorway.clone()
    runs = []
    for _ in range(2):
        for _ in range(frames):
            episode.advance(1 / 30)
        runs.append((snapshot.save(episode), world.walls.doorway.clone()))
        world.openings.set_open(rows, 0, 0.9)
        snapshot.restore(episode, snapshot.copied(saved), rows)
        assert torch.equal(world.walls.doorway, spans)
    (first, doors), (again, doors_again) = runs
    assert torch.equal(doors, doors_again)
    for part, record in first.items():
        assert all(torch.equal(value, again[part][name]) for name, value in record.items()), part
    episode.begin(rows[:1], rows[:1])
    assert world.openings.share[:, 0].tolist() == pytest.approx([0.0, 0.3])
    assert "openings" not in Episode(burning_beside(DOORWAY), (presets.hazard("fire", "paper"),)).parts
