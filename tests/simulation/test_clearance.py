"""Where a robot can be put: distances from boxes and walls by hand, without a simulator."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from hazard_ms.simulation.clearance import MARGIN, clear_points, obstacle
from hazard_ms.simulation.world import World
from hazard_ms.spec import Partition, SceneSpec
from tests.worlds.fire_worlds import room_world

RADIUS = 0.3  # [m]
REACH = RADIUS + MARGIN
JUST = 0.001  # [m]


def table(turn: float = 0.0, height: float = 0.7, low: float = 0.0) -> World:
    """A table 1 m x 0.5 m in the middle of a room of 20 m x 20 m, turned by `turn` [rad]."""
    return room_world([], (), [((10.0, 10.0, low), (1.0, 0.5, height), turn)])


def room(world: World, **changes: object) -> World:
    spec: SceneSpec = world.specs[0]
    world.specs = (replace(spec, room=replace(spec.room, **changes)),)  # type: ignore[arg-type]
    return world


def free(world: World, x: float, y: float) -> bool:
    return obstacle(world, 0, (x, y), RADIUS) == ""


def test_a_disc_keeps_its_radius_from_a_side_and_from_a_corner() -> None:
    world = table()
    assert free(world, 10.5 + REACH + JUST, 10.0) and not free(world, 10.5 + REACH - JUST, 10.0)
    assert free(world, 10.0, 10.25 + REACH + JUST) and not free(world, 10.0, 10.25 + REACH - JUST)
    across = REACH / math.sqrt(2.0)
    assert free(world, 10.5 + across + JUST, 10.25 + across + JUST)
    assert not free(world, 10.5 + across - JUST, 10.25 + across - JUST)
    assert not free(world, 10.0, 10.0)


def test_a_turned_thing_is_as_wide_as_it_stands() -> None:
    world = table(turn=math.pi / 2)
    assert free(world, 10.25 + REACH + JUST, 10.0) and not free(world, 10.0, 10.5 + REACH - JUST)


@pytest.mark.parametrize(
    ("height", "low", "clear"), [(0.02, 0.0, True), (0.05, 0.0, False), (0.5, 1.75, True), (0.5, 1.3, False)]
)
def test_rugs_and_what_hangs_high_are_no_obstacles(height: float, low: float, clear: bool) -> None:
    """The base glides over what is lower than 0.03 m; the robots reach up to 1.4 m."""
    assert free(table(height=height, low=low), 10.0, 10.0) == clear


def test_things_on_the_floor_count_where_they_are_now_and_not_in_the_bag() -> None:
    world = room_world([("book", (5.0, 5.0, 0.0))], (), [])
    assert obstacle(world, 0, (5.0, 5.0), RADIUS) == world.names[0][0]
    world.position[0, 0, 0] += 1.0
    assert free(world, 5.0, 5.0) and not free(world, 6.0, 5.0)
    world.away[0, 0] = True
    assert free(world, 6.0, 5.0)


def test_walls_keep_the_disc_inside_and_partitions_keep_it_apart() -> None:
    world = table()
    size = world.specs[0].room.size[0]
    for x, clear in ((REACH + JUST, True), (REACH - JUST, False), (size - REACH - JUST, True), (size - 0.1, False)):
        assert free(world, x, 5.0) == clear and free(world, 5.0, x) == clear
    assert obstacle(world, 0, (0.1, 5.0), RADIUS) == "a wall"
    divided = room(world, partitions=(Partition("middle", "y", 4.0),))
    assert not free(divided, 4.1, 5.0) and free(divided, 5.0, 5.0)


def test_clear_points_are_all_that_are_clear() -> None:
    world = table()
    points = clear_points(world, 0, RADIUS, 0.5)
    assert len(points) > 1000
    grid = [(x / 2 + 0.25, y / 2 + 0.25) for x in range(40) for y in range(40)]
    assert {tuple(p) for p in points.tolist()} == {p for p in grid if free(world, *p)}
