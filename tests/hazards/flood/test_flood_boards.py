"""Flood boards in the outer doors of homes of `paper`: the water behind one stays as high as it was when it was set."""

from __future__ import annotations

import math

import pytest

from hazard_ms.hazards.flood.flood import Flood
from hazard_ms.hazards.flood.flood_state import FloodState
from hazard_ms.simulation import building
from hazard_ms.simulation.world import World
from hazard_ms.spec import AgentStart, Body, Opening, Room, SceneSpec
from tests.hazards.flood.test_flood_surface import DIVIDED, SIZE, SLOPE, levels
from tests.worlds.flood_worlds import begin, frames

LAW = Flood(through_doors=True)  # 0.01 m every 10 frames
WEST, NORTH = Opening("door", "west", 1.0, 0.9, 2.0), Opening("door", "north", 8.0, 0.9, 2.0)
INSIDE = (0.0, 1.0)  # in the west door
FROM_NORTH = math.hypot(7.55, SIZE[1] - 1.45)  # way from the north door to there, level along the west one [m]


def flooded(*openings: Opening, board: float = 2.0, kind: str = "") -> tuple[World, FloodState]:
    """A room with two boards, `board` high [m], that water comes into through its outer doors."""
    partitions, inner = DIVIDED[kind] if kind else ((), ())
    size = (1.0, 0.04, board)
    boards = tuple(Body(f"flood_board_{k}", "box", "plain_box", (3.0, 1.0 + k, 0.0), scale=size) for k in range(2))
    spec = SceneSpec(
        name="test/boards",
        room=Room(SIZE, openings=(*inner, *openings), partitions=partitions),
        fixtures=(),
        bodies=(Body("bottle_0", "bottle", "plain_box", (9.0, 1.0, 0.0), scale=(0.08, 0.08, 0.2)), *boards),
        target_categories=("bottle",),
        fires=(),
        agent_start=AgentStart((5.0, 1.0), 0.0),
        flood_side=openings[0].wall,
        second_flood_side=openings[1].wall if len(openings) > 1 else None,
    )
    world = building.make_world((spec,), "cpu")
    world.equip(["flood_board"])
    return world, begin(LAW, world)


def set_in(world: World, opening: Opening, number: int = 0) -> None:
    assert world.equipment is not None
    thing = world.names[0].index(f"flood_board_{number}")
    world.equipment.state.stands_in[0, thing] = world.specs[0].room.openings.index(opening)


def level(world: World, state: FloodState, place: tuple[float, float]) -> float:
    return levels(LAW, state, world, [place])[0]


def test_behind_a_board_the_water_stays_until_that_of_another_door_is_higher() -> None:
    """0.7 m at frame 700; 1.0 m at the north door at 1,000, 1.4 m at 1,400, less the slope of the way from there."""
    world, state = flooded(WEST, NORTH)
    frames(LAW, state, world, 700)
    set_in(world, WEST)
    found = []
    for _ in range(2):
        frames(LAW, state, world, 300 if not found else 400)
        found.append((level(world, state, INSIDE), level(world, state, (8.0, SIZE[1]))))
    assert 1.0 - SLOPE * FROM_NORTH < 0.7 < 1.4 - SLOPE * FROM_NORTH, "the case tells both apart"
    assert found[0] == (pytest.approx(0.7, abs=1e-3), pytest.approx(1.0, abs=1e-3))
    assert found[1] == (pytest.approx(1.4 - SLOPE * FROM_NORTH, abs=1e-3), pytest.approx(1.4, abs=1e-3))


def test_with_boards_in_all_doors_no_water_rises_anywhere() -> None:
    world, state = flooded(WEST, NORTH)
    frames(LAW, state, world, 700)
    places = [INSIDE, (8.0, SIZE[1]), (5.0, 3.0), (9.5, 0.5)]
    before = levels(LAW, state, world, places)
    for number, door in enumerate((WEST, NORTH)):
        set_in(world, door, number)
    frames(LAW, state, world, 500)
    assert max(before) > 0.0
    assert levels(LAW, state, world, places) == pytest.approx(before, abs=1e-3)


def test_water_higher_than_a_board_rises_behind_it_as_before_it() -> None:
    """A board of 1 m holds 0.3 m back from frame 700 to 1,000: 1.4 m outside are 1.1 m inside at 1,400."""
    world, state = flooded(WEST, board=1.0)
    frames(LAW, state, world, 700)
    set_in(world, WEST)
    frames(LAW, state, world, 700)
    assert level(world, state, INSIDE) == pytest.approx(1.1, abs=0.011)  # a step of the level


@pytest.mark.parametrize("kind", ["across", "three", "cross"])
def test_a_board_holds_water_from_rooms_behind_inner_walls_too(kind: str) -> None:
    """Rooms that are joined by doorways: what has come through them stays as high as it is."""
    world, state = flooded(WEST, kind=kind)
    frames(LAW, state, world, 1000)
    places = [(x, y) for x in (1.0, 5.0, 9.0) for y in (1.0, 5.0)]
    before = levels(LAW, state, world, places)
    set_in(world, WEST)
    frames(LAW, state, world, 300)
    assert levels(LAW, state, world, places) == pytest.approx(before, abs=1e-3) and min(before) >= 0.0


def test_water_of_rooms_that_floods_come_into_over_whole_walls_passes_boards() -> None:
    """The published tasks' floods know no doors."""
    law = Flood()
    world, _ = flooded(WEST)
    state = begin(law, world)
    set_in(world, WEST)
    frames(law, state, world, 700)
    assert levels(law, state, world, [INSIDE])[0] == pytest.approx(0.7, abs=1e-3)
