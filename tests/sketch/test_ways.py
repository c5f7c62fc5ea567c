"""Walks over the floor of scenes: against lengths worked out by hand, and against the paths that agents plan."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hazard_ms.robots.fetch import HazardFetch
from hazard_ms.robots.g1 import HazardG1
from hazard_ms.scenes.floor import boxes_of
from hazard_ms.scenes.splits import scene
from hazard_ms.sketch.travel import ways as module
from hazard_ms.sketch.travel.ways import INDOOR_CELL, OUTDOOR_CELL, SETTLE, TURN, WALK, Ways
from hazard_ms.skills.motor.navigation import plan
from hazard_ms.skills.motor.walking import ARRIVED
from hazard_ms.spec import AgentStart, Body, Partition, Room, SceneSpec
from hazard_ms.spec.scene import Opening

CELL = INDOOR_CELL
EMPTY = SceneSpec("test/empty", Room((8.0, 6.0)), (), (), ("apple",), (), AgentStart((1.05, 1.05)))


def divided(doorway: bool) -> SceneSpec:
    """Two halls with a wall between them at x = 4 m, and a doorway around y = 5 m or none."""
    openings = (Opening("doorway", "partition_1", 5.0, 1.2, 2.05),) if doorway else ()
    return replace(EMPTY, room=Room((8.0, 6.0), partitions=(Partition("partition_1", "y", 4.0),), openings=openings))


def test_the_speeds_are_those_of_the_robots() -> None:
    for robot in (HazardFetch, HazardG1):
        assert pytest.approx(1.0 / robot.build.forward_step) == WALK
        assert pytest.approx(1.0 / robot.build.turn_step) == TURN


@pytest.mark.parametrize("heading", np.deg2rad([0.0, 20.0, 45.0, 90.0, -160.0]))
def test_three_metres_in_an_empty_room_take_the_frames_of_two_and_a_half(heading: float) -> None:
    middle = np.array([4.05, 3.05])
    start = middle - 1.5 * np.array([np.cos(heading), np.sin(heading)])
    frames = Ways(EMPTY).frames(start, start + 2.0 * (middle - start))
    assert frames == pytest.approx(62 * (3.0 - 0.5) + 3, abs=62 * CELL)


def test_who_looks_away_turns_first_but_not_all_the_way() -> None:
    """At 6 degrees a frame, until the way is 25 degrees off: then the base turns while it drives."""
    ways, a, b = Ways(EMPTY), (2.05, 3.05), (5.05, 3.05)
    ahead = ways.frames(a, b)
    late = ways.frames(a, b, heading=np.deg2rad([0.0, 20.0, 90.0, -90.0, 180.0])) - ahead
    assert late == pytest.approx([0.0, 0.0, 65 / 6, 65 / 6, 155 / 6], abs=0.01)
    back = ways.frames(b, a, heading=np.deg2rad([-170.0, 90.0])) - ways.frames(b, a)
    assert back == pytest.approx([0.0, 65 / 6], abs=0.01)


def test_a_way_begins_towards_its_first_corner_and_ends_facing_the_thing() -> None:
    route = Ways(divided(doorway=True)).route((2.05, 1.05), (6.05, 1.05))
    assert route.first == pytest.approx(np.arctan2(4.0, 2.0), abs=0.2)
    assert route.last == pytest.approx(-np.arctan2(4.0, 2.0), abs=0.2)


def test_a_thing_is_reached_before_its_edge_and_who_is_there_stays() -> None:
    ways, a, b = Ways(EMPTY), (2.05, 3.05), (5.05, 3.05)
    near, far = ways.frames(a, b, edge=0.0), ways.frames(a, b, edge=0.4)
    assert near - far == pytest.approx(62 * 0.4, abs=0.1)
    across = ways.frames((3.05, 1.05), b, edge=0.4)  # diagonally over cells, inside one of which it ends
    assert across == pytest.approx(62 * (np.sqrt(8.0) - 0.5 - 0.4) + SETTLE, abs=1.0)
    assert ways.frames((4.65, 3.05), b) == SETTLE
    assert np.allclose(ways.along((4.65, 3.05), b, 5.0), (4.65, 3.05))


def test_a_way_leads_through_the_doorway_or_nowhere() -> None:
    a, b = np.array([2.05, 1.05]), np.array([6.05, 1.05])
    route = Ways(divided(doorway=True)).route(a, b)
    edge, middle = (4.0, 5.0 - 0.6 + 0.29), (4.0, 5.0)
    shortest, central = (sum(np.hypot(*(corner - end)) for end in (a, b)) - ARRIVED for corner in (edge, middle))
    assert shortest < route.metres < 1.05 * central
    assert np.deg2rad(30.0) < route.turned < 2 * np.arctan(2.0)
    shut = Ways(divided(doorway=False))
    assert shut.frames(a, b) == np.inf
    assert np.allclose(shut.along(a, b, 2.0), a)
    east = shut.origin[0] + shut.cell * np.arange(shut.free.shape[1]) > 4.0
    assert shut.free[:, ~east].any() and not shut.free[:, east].any()
    assert np.isfinite(shut.frames(a, (3.05, 5.05)))


def test_who_follows_a_way_stays_off_things_and_arrives() -> None:
    ways = Ways(divided(doorway=True))
    a, b = np.array([2.05, 1.05]), np.array([6.05, 1.05])
    length = float(ways.route(a, b).metres)
    walked = np.arange(0.0, length, 0.05)
    places = ways.along(a, b, walked)
    assert np.hypot(*np.diff(places, axis=0).T) == pytest.approx(0.05, abs=0.01)
    wall = (np.abs(places[:, 0] - 4.0) < 0.06 + 0.29 - CELL) & (np.abs(places[:, 1] - 5.0) > 0.6)
    assert not wall.any()
    assert np.hypot(*(ways.along(a, b, np.inf) - b)) == pytest.approx(ARRIVED, abs=CELL)
    for part in (0.3, 0.6):
        left = ways.route(ways.along(a, b, part * length), b).metres
        assert left == pytest.approx((1 - part) * length, abs=0.15)


def test_bodies_stand_in_the_way_unless_they_are_targets_or_left_out() -> None:
    """Printers from wall to wall, 23 cm high."""
    row = tuple(Body(f"printer_{i}", "printer", "printer_1", (4.0, 0.2 + 0.4 * i, 0.0)) for i in range(15))
    blocked = replace(EMPTY, bodies=row)
    a, b = (2.05, 3.05), (6.05, 3.05)
    assert Ways(blocked).frames(a, b) == np.inf
    assert Ways(blocked, bodies=()).frames(a, b) == Ways(EMPTY).frames(a, b)
    assert Ways(replace(blocked, target_categories=("printer",))).frames(a, b) == Ways(EMPTY).frames(a, b)


def test_many_walks_at_once_take_the_same_frames_as_alone() -> None:
    points = np.array([(1.05, 1.05), (3.05, 5.05), (6.05, 1.05)])
    ways, edge = Ways(divided(doorway=True)), np.array([0.0, 0.2, 0.1])
    together = ways.frames(points[:, None], points[None], edge=edge)
    alone = [
        [Ways(divided(doorway=True)).frames(points[i], points[j], edge=edge[j]) for j in range(3)] for i in range(3)
    ]
    assert np.array_equal(together, alone)


def test_what_is_not_kept_any_more_is_made_again(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "MOST_FIELDS", 3)
    ways, rng = Ways(EMPTY), np.random.default_rng(0)
    points = rng.uniform(0.5, 5.5, (12, 2))
    first, second = (ways.frames(points[:, None], points[None]) for _ in range(2))
    assert np.array_equal(first, second)
    assert len(ways._fields) == 3


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"cell": 0.0}, "cell and radius must be positive lengths, got 0.0 m"),
        ({"radius": -1.0}, "got 0.1 m and -1.0 m"),
        ({"bodies": ["ghost"]}, "bodies must be names of bodies in the scene, got 'ghost'"),
    ],
)
def test_nonsense_is_refused(options: dict, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        Ways(EMPTY, **options)


def test_points_of_another_shape_are_refused() -> None:
    with pytest.raises(ValueError, match=r"points must have shape \[..., 2\], got \[3\]"):
        Ways(EMPTY).frames((1.0, 2.0, 3.0), (1.0, 2.0))


def explored(spec: SceneSpec, cell: float) -> tuple[np.ndarray, np.ndarray]:
    """Corner and heights of a map on which all of a scene was seen: of 5 x 5 points in each cell, the highest."""
    border = spec.room.beyond if spec.room.open_air else 1.0
    targets = {t.name for t in spec.targets}
    fixtures, bodies = boxes_of(spec)
    boxes = [*fixtures, *(b for b, body in zip(bodies, spec.bodies, strict=True) if body.name not in targets)]
    cells = np.round((np.array(spec.room.size) + 2 * border) / cell).astype(int)
    x, y = ((np.arange(5 * n) + 0.5) * cell / 5 - border for n in cells)
    height = np.zeros((len(y), len(x)))
    if not spec.room.open_air:
        height[(y < 0) | (y > spec.room.size[1])] = spec.room.height
        height[:, (x < 0) | (x > spec.room.size[0])] = spec.room.height
    for box in boxes:
        far = np.hypot(box.half_x, box.half_y)
        u, v = (slice(*np.searchsorted(axis, (c - far, c + far))) for axis, c in ((x, box.x), (y, box.y)))
        inside = box.distance(x[None, u], y[v, None]) <= 0.0
        height[v, u] = np.where(inside, np.maximum(height[v, u], box.high), height[v, u])
    return np.full(2, -border), height.reshape(cells[1], 5, cells[0], 5).max(axis=(1, 3))


def compared(name: str, pairs: int) -> tuple[np.ndarray, np.ndarray]:
    """Lengths of `pairs` of walks in a scene by the sketch and by navigation over a map of everything [m]."""
    spec, rng = scene(name), np.random.default_rng(0)
    ways, (origin, height) = Ways(spec), explored(spec, CELL)
    size, free = ways.free.shape, np.argwhere(ways.free)
    assert size[0] * size[1] < 30_000
    a, b = (ways.origin + (free[rng.choice(len(free), pairs)][:, ::-1] + 0.5) * ways.cell for _ in range(2))
    seen = np.ones(height.shape, bool)
    planned = [plan(height, seen, CELL, origin, tuple(p), tuple(q), 0.29, ARRIVED) for p, q in zip(a, b, strict=True)]
    return ways.route(a, b).metres, np.array([np.inf if path is None else path.length for path in planned])


@pytest.mark.parametrize("name", ["kitchen_b/00", "living_room_a/03", "parking/03"])
def test_ways_are_as_long_as_the_paths_that_agents_plan(name: str) -> None:
    agrees(*compared(name, 12))


@pytest.mark.long
@pytest.mark.parametrize(
    "places", [("kitchen_a", "kitchen_b", "living_room_a", "craft_room_a"), ("street", "crossing", "park", "parking")]
)
def test_ways_are_as_long_as_planned_paths_in_many_scenes(places: tuple[str, ...]) -> None:
    every = [compared(f"{place}/{n:02d}", 13) for place in places for n in (1, 2)]
    agrees(*(np.concatenate(lengths) for lengths in zip(*every, strict=True)))


def agrees(lengths: np.ndarray, planned: np.ndarray) -> None:
    """Within 1.5 % in sum, and within 5 % or two cells for 9 of 10 walks: of two ways as dear, either may be taken."""
    off = np.abs(lengths - planned)
    print(f"{len(off)} ways: sum {lengths.sum() / planned.sum() - 1:+.3%}, worst {off.max():.2f} m")
    assert lengths.sum() == pytest.approx(planned.sum(), rel=0.015)
    assert (off <= np.maximum(0.05 * planned, 2 * OUTDOOR_CELL)).mean() >= 0.9
