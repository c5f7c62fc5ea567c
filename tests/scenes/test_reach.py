"""Which targets robots can get at, in rooms whose gaps and distances can be worked out by hand."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from hazard_ms.scenes.floor import cell_of
from hazard_ms.scenes.reach import floor_of, reachable, share
from hazard_ms.scenes.splits import scene
from hazard_ms.spec import AgentStart, Body, Build, Fixture, Opening, Partition, Room, SceneSpec, Vec2, Vec3
from hazard_ms.spec.registry import ROBOTS, load


def build(robot: str) -> Build:
    """The build of a registered robot."""
    found: Build = load(ROBOTS[robot].robot).build
    return found


def box(name: str, at: Vec2, size: Vec3) -> Fixture:
    """A table, say, of `size` [m] with its middle at `at` [m]."""
    return Fixture(name, "table", "plain_box", (*at, 0.0), scale=size)


def apple(name: str, at: Vec3) -> Body:
    """A target of 0.08 m with the middle of its base at `at` [m]."""
    return Body(name, "apple", "plain_box", at, scale=(0.08, 0.08, 0.08))


def room(*things: Body | Fixture, start: Vec2 = (2.0, 1.0)) -> SceneSpec:
    """A room of 4 m x 6 m."""
    bodies = tuple(t for t in things if isinstance(t, Body))
    fixtures = tuple(t for t in things if isinstance(t, Fixture))
    return SceneSpec("made", Room((4.0, 6.0)), fixtures, bodies, ("apple", "bag"), (), AgentStart(start, 0.0))


def gap(width: float) -> SceneSpec:
    """An apple before and one behind a row of tables with a gap of `width` [m]."""
    half = (4.0 - width) / 2
    row = [box(f"table_{k}", (x, 3.0), (half, 0.6, 0.8)) for k, x in enumerate((half / 2, 4.0 - half / 2))]
    return room(*row, apple("near", (1.0, 1.0, 0.0)), apple("far", (1.0, 5.5, 0.0)))


@pytest.mark.parametrize(
    ("robot", "width", "fits"),
    [("fetch", 0.75, True), ("fetch", 0.55, False), ("g1", 0.65, True), ("g1", 0.45, False)],
)
def test_robots_get_through_gaps_wider_than_they_are(robot: str, width: float, fits: bool) -> None:
    assert reachable(gap(width), build(robot)) == (("near", "far") if fits else ("near",))


def test_the_g1_is_narrower_than_fetch() -> None:
    """There are gaps that only it passes: Fetch's collision shapes are 0.576 m wide, its own 0.512 m."""
    assert 0.256 <= build("g1").radius < 0.288 <= build("fetch").radius < 0.3


@pytest.mark.parametrize("height", [0.4, 0.8])
def test_targets_deep_on_a_table_are_out_of_reach(height: float) -> None:
    """Fetch stands 0.29 m before the edge; its arm of 0.95 m begins 0.15 m ahead, 0.84 m high; its hand adds 0.15 m."""
    arm = math.sqrt(0.95**2 - (height + 0.04 - 0.84) ** 2) + 0.15 + 0.15 - 0.29  # from the edge [m]
    table = box("table", (2.0, 4.0), (4.0, 4.0, height))
    near, far = (2.0, 2.0 + arm - 0.06, height), (2.0, 2.0 + arm + 0.1, height)
    assert reachable(room(table, apple("a", near), apple("b", far)), build("fetch")) == ("a",)


def test_small_things_are_pushed_aside_and_large_ones_are_not() -> None:
    for height, found in ((0.1, ("far",)), (0.6, ())):
        row = [
            Body(f"bag_{k}", "bag", "plain_box", (x, 3.0, 0.0), scale=(1.0, 0.3, height))
            for k, x in enumerate((0.6, 1.7, 2.8, 3.5))
        ]
        spec = room(*row, apple("far", (2.0, 5.5, 0.0)))
        assert tuple(n for n in reachable(spec, build("fetch")) if n == "far") == found


def test_a_robot_that_starts_against_furniture_leaves_it_and_one_inside_of_it_does_not() -> None:
    table = box("table", (2.0, 3.0), (2.0, 2.0, 0.8))
    beside, inside = (room(table, apple("a", (1.0, 5.0, 0.0)), start=s) for s in ((2.0, 1.9), (2.0, 3.0)))
    assert reachable(beside, build("fetch")) == ("a",) and reachable(inside, build("fetch")) == ()
    assert floor_of(beside, 0.29)[cell_of((2.0, 5.0))] and not floor_of(inside, 0.29).any()


@pytest.mark.parametrize(("share", "found"), [(0.0, ("a",)), (1.0, ())])
def test_an_open_leaf_bars_the_way(share: float, found: tuple[str, ...]) -> None:
    """From a wall at y = 3 m a leaf of 0.9 m stands to within 0.4 m of a table; shut, it leaves 1.3 m."""
    table, door = box("table", (1.0, 0.85), (0.3, 1.7, 0.8)), Opening("door", "middle", 1.45, 0.9, 2.0, open=share)
    walls = Room((4.0, 6.0), openings=(door,), partitions=(Partition("middle", "x", 3.0),))
    spec = replace(room(table, apple("a", (3.0, 1.0, 0.0)), start=(0.4, 1.0)), room=walls)
    assert reachable(spec, build("fetch")) == found


def test_generated_scenes_leave_robots_room_everywhere() -> None:
    for name in ("kitchen_a/00", "craft_room_a/05"):
        spec = scene(name)
        assert set(reachable(spec, build("fetch"))) == {t.name for t in spec.targets}


def test_the_share_counts_values() -> None:
    """The catalogue: an apple is worth 1, a bag 5."""
    spec = room(apple("a", (1.0, 1.0, 0.0)), Body("b", "bag", "plain_box", (1.0, 2.0, 0.0), scale=(0.1, 0.1, 0.1)))
    assert share(spec, ("a", "b")) == 1.0 and share(spec, ()) == 0.0
    assert share(spec, ("b",)) == pytest.approx(5 / 6)
