"""The water's surface: L-1 to L-4 of docs/physics.md, that it never falls, and that it goes through doorways only."""

from __future__ import annotations

import dataclasses
import heapq
import math

import numpy as np
import pytest
import torch

from hazard_ms.hazards.flood.flood import Flood, FloodState
from hazard_ms.hazards.presets import flood
from hazard_ms.simulation.world import World
from hazard_ms.spec import Opening, Partition
from tests.worlds.flood_worlds import Thing, begin, frames, on_a_plane, room

SLOPE = 0.0524077793  # tan 3 degrees
BY_FRAMES = ["paper", "shipped"]
EVERY = ["paper", "shipped", "realistic"]
NOTHING = [Thing((0.1, 0.1, 0.1))]
SIDES = {"east": (1.0, 0.0), "west": (-1.0, 0.0), "north": (0.0, 1.0), "south": (0.0, -1.0)}


def levels(preset: Flood, state: FloodState, world: World, points: list[tuple[float, float]]) -> list[float]:
    places = torch.tensor([[(*p, 0.0) for p in points]]).expand(world.num_envs, -1, -1)
    return preset.image(state, world, places)[0].tolist()


def at(preset: Flood, world: World, frame: int) -> FloodState:
    """The state of a frame, without those before it."""
    state = begin(preset, world)
    world.chance.frame[:] = frame - 1
    frames(preset, state, world, 1)
    return state


def test_slope_front_and_current_of_the_water() -> None:
    """L-1 of docs/physics.md."""
    shipped = flood("shipped")
    assert math.tan(math.radians(shipped.slope)) == pytest.approx(0.0524078, abs=1e-6)
    assert shipped.rise / shipped.every / math.tan(math.radians(shipped.slope)) == pytest.approx(0.0190811, abs=1e-6)
    assert shipped.speed == pytest.approx(0.9540568, abs=1e-6)
    assert flood("paper").speed * 1 / 30 == pytest.approx(shipped.speed * 0.01, rel=1e-6)  # as far per frame


@pytest.mark.parametrize("preset", BY_FRAMES)
@pytest.mark.parametrize("side", SIDES)
def test_depth_of_water_from_every_side(preset: str, side: str) -> None:
    """L-2: 2 m from the source; at 1,500 frames the slope has lessened for the first time, to 2.98017 degrees."""
    size = (7.0, 5.0)
    dx, dy = SIDES[side]
    point = (3.5 + dx * 1.5 if dx else 3.3, 2.5 + dy * 0.5 if dy else 2.2)
    world = room(NOTHING, side, size)
    lower = math.tan(math.radians(2.98017))
    for frame, want in (
        (0, 0),
        (9, 0),
        (100, 0),
        (500, 0.39518),
        (1000, 0.89518),
        (1499, 1.49 - 2 * SLOPE),
        (1500, 1.5 - 2 * lower),
    ):
        assert levels(flood(preset), at(flood(preset), world, frame), world, [point])[0] == pytest.approx(
            max(want, 0.0), abs=1e-5
        )


@pytest.mark.parametrize("preset", BY_FRAMES)
@pytest.mark.parametrize(("x", "frame"), [(0.5, 30), (1.0, 60), (2.0, 110), (3.0, 160), (4.0, 210), (4.74, 250)])
def test_things_get_wet_in_the_frame_of_the_front(preset: str, x: float, frame: int) -> None:
    """L-3 of docs/physics.md."""
    made, world = on_a_plane(flood(preset)), room(NOTHING, "east", (6.0, 4.0))
    state = begin(made, world)
    for n in range(1, frame + 1):
        frames(made, state, world, 1)
        assert (levels(made, state, world, [(6.0 - x, 2.0)])[0] > 0) == (n >= frame)


@pytest.mark.parametrize("preset", BY_FRAMES)
def test_the_slope_lessens_after_the_cap(preset: str) -> None:
    """L-4 of docs/physics.md."""
    world = room(NOTHING)
    assert float(at(flood(preset), world, 1499).surface_slope[0]) == pytest.approx(SLOPE, rel=1e-6)
    for k in (1, 2, 3, 40, 150):
        fall = float(at(flood(preset), world, 1490 + 10 * k).surface_slope[0])
        assert fall == pytest.approx(1.5 / (28.6217 + 0.1908114 * k), abs=1e-6)


@pytest.mark.parametrize("preset", BY_FRAMES)
def test_the_course_of_the_level_is_rounded_as_published_episodes_have_it(preset: str) -> None:
    """Each operation in single precision, in this order: hashes of episodes rest on these bits."""
    single, steep = np.float32, math.tan(math.radians(3.0))
    for frame in (0, 9, 10, 70, 290, 1490, 1499, 1500, 1510, 4000):
        state = at(flood(preset), room(NOTHING, copies=2), frame)
        level = min(single(0.01) * single(frame // 10), single(1.5))
        beyond = frame // 10 - 149
        length = single(1.5 / steep) + single(0.01 / steep) * single(beyond)
        slope = single(1.5) * (single(1.0) / length) if beyond > 0 else single(steep)
        assert state.level.tolist() == [float(level)] * 2 and state.surface_slope.tolist() == [float(slope)] * 2


DIVIDED = {
    "across": ((Partition("a", "y", 5.0),), (Opening("doorway", "a", 1.5, 0.9, 2.0),)),
    "along": ((Partition("a", "x", 3.0),), (Opening("doorway", "a", 4.0, 0.9, 2.0),)),
    "closed": ((Partition("a", "y", 5.0),), ()),
    "three": (
        (Partition("a", "y", 6.5), Partition("b", "y", 3.0)),
        (Opening("doorway", "a", 5.0, 0.9, 2.0), Opening("doorway", "b", 1.0, 1.2, 2.0)),
    ),
    "cross": (
        (Partition("a", "y", 5.0), Partition("b", "x", 3.0)),
        (Opening("doorway", "a", 1.5, 0.9, 2.0), Opening("doorway", "b", 2.0, 0.9, 2.0)),
    ),
}
SIZE = (10.0, 6.0)


@pytest.mark.parametrize("preset", EVERY)
@pytest.mark.parametrize("side", SIDES)
@pytest.mark.parametrize("kind", DIVIDED)
def test_no_level_ever_falls(preset: str, side: str, kind: str) -> None:
    made, world = on_a_plane(flood(preset)), room(NOTHING, side, SIZE, 1, (1.0, 1.0), *DIVIDED[kind])
    state, before = begin(made, world), torch.zeros(1, 60)
    points = torch.rand(1, 60, 3, generator=torch.Generator().manual_seed(1)) * torch.tensor([*SIZE, 0.0])
    for frame in (1, 10, 25, 40, 300, 800, 1490, 1499, 1500, 1510, 1511, 2000, 2600):
        world.chance.frame[:], state.time[:] = frame - 1, (frame - 1) / 30
        frames(made, state, world, 1, 1 / 30)
        now = made.image(state, world, points)
        assert (now >= before - 1e-6).all() and (now <= 1.5).all()
        before = now
    assert kind in ("closed", "cross") or (before > 0.8).all()


def ways_on_a_grid(side: str, kind: str, cell: float = 0.05, door: tuple[float, float] | None = None) -> np.ndarray:
    """Shortest ways from the source wall by Dijkstra on cells and 16 directions: walls block, doorways do not.

    They begin between both ends of a `door` in that wall [m], if it has one.
    """
    nx, ny = round(SIZE[0] / cell), round(SIZE[1] / cell)
    x, y = np.meshgrid((np.arange(nx) + 0.5) * cell, (np.arange(ny) + 0.5) * cell, indexing="ij")
    blocked = np.zeros((nx, ny), bool)
    for p in DIVIDED[kind][0]:
        across, along = (x, y) if p.axis == "y" else (y, x)
        doors = [np.abs(along - o.centre) < o.width / 2 for o in DIVIDED[kind][1] if o.wall == p.name]
        blocked |= (np.abs(across - p.at) <= p.thickness / 2) & ~np.any([np.zeros_like(blocked), *doors], axis=0)
    far = {"east": SIZE[0] - x, "west": x, "north": SIZE[1] - y, "south": y}[side]
    low, high = door or (-np.inf, np.inf)
    beside = y if side in ("east", "west") else x
    best = np.where((far < cell) & (beside > low) & (beside < high) & ~blocked, far, np.inf)
    heap = [(best[i, j], i, j) for i, j in zip(*np.nonzero(np.isfinite(best)), strict=True)]
    heapq.heapify(heap)
    steps = [(a, b) for a in range(-2, 3) for b in range(-2, 3) if math.gcd(a, b) == 1]
    while heap:
        d, i, j = heapq.heappop(heap)
        if d > best[i, j]:
            continue
        for a, b in steps:
            u, v = i + a, j + b
            if 0 <= u < nx and 0 <= v < ny and not blocked[u, v] and not blocked[i + int(a / 2), j + int(b / 2)]:
                new = d + cell * math.hypot(a, b)
                if new < best[u, v] - 1e-12:
                    best[u, v] = new
                    heapq.heappush(heap, (new, u, v))
    return best


@pytest.mark.parametrize("side", SIDES)
@pytest.mark.parametrize("kind", DIVIDED)
def test_water_takes_the_shortest_way_through_doorways(side: str, kind: str) -> None:
    """Against a grid, whose 16 directions make ways up to 2.8 % longer; ours takes a doorway as one place, which saves
    its width.
    """
    made, world = flood("paper"), room(NOTHING, side, SIZE, 1, (1.0, 1.0), *DIVIDED[kind])
    state = at(made, world, 1400)
    want = ways_on_a_grid(side, kind, 0.1)
    cells = [(i, j) for i in range(3, 100, 9) for j in range(3, 60, 7)]
    found = levels(made, state, world, [((i + 0.5) * 0.1, (j + 0.5) * 0.1) for i, j in cells])
    for (i, j), level in zip(cells, found, strict=True):
        if math.isinf(want[i, j]):
            near = any(abs(((i if p.axis == "y" else j) + 0.5) * 0.1 - p.at) < 0.15 for p in DIVIDED[kind][0])
            assert near or level == 0.0  # in a wall, or behind a closed one
        else:
            way = (1.4 - level) / SLOPE
            assert way == pytest.approx(want[i, j], abs=0.03 * want[i, j] + 1.3 * len(DIVIDED[kind][0]))
            assert way <= want[i, j] + 0.1


@pytest.mark.parametrize(("side", "second"), [("east", "west"), ("south", "east"), ("west", "north")])
@pytest.mark.parametrize("kind", DIVIDED)
def test_water_from_two_walls_comes_from_the_nearer_one(side: str, second: str, kind: str) -> None:
    """Wherever the ways from the two walls differ, the water is as high as that of the nearer wall alone."""
    made, world = flood("paper"), room(NOTHING, side, SIZE, 1, (1.0, 1.0), *DIVIDED[kind])
    both = dataclasses.replace(world, specs=(dataclasses.replace(world.specs[0], second_flood_side=second),))
    other = room(NOTHING, second, SIZE, 1, (1.0, 1.0), *DIVIDED[kind])
    points = [(0.3 + 0.9 * i, 0.3 + 0.7 * j) for i in range(11) for j in range(8)]
    found, *alone = (levels(made, at(made, w, 1400), w, points) for w in (both, world, other))
    assert found == pytest.approx(np.maximum(*alone), abs=1e-5)
    assert any(a > b for a, b in zip(*alone, strict=True)) and any(a < b for a, b in zip(*alone, strict=True))


@pytest.mark.parametrize("side", ["east", "west"])
def test_the_level_is_the_same_on_both_sides_of_a_doorway(side: str) -> None:
    made, world = flood("paper"), room(NOTHING, side, SIZE, 1, (1.0, 1.0), *DIVIDED["three"])
    state = at(made, world, 900)
    for x, y in ((6.5, 5.0), (3.0, 1.0)):
        one, other = levels(made, state, world, [(x - 0.07, y), (x + 0.07, y)])
        assert abs(one - other) < 0.01


def test_water_flows_out_of_the_doorway_to_all_sides() -> None:
    made, world = (
        flood("paper"),
        room([Thing((0.1,) * 3, at=(4.0, 4.0, 0.1))], "east", SIZE, 1, (1.0, 1.0), *DIVIDED["across"]),
    )
    state = at(made, world, 1400)
    push = made.force(state, world, 0.01)
    assert push is not None
    drive = push.force[0, 0, :2] / push.force[0, 0, :2].norm()
    toward = torch.tensor([4.0 - 4.94, 4.0 - 1.95])  # from the nearest corner of the doorway's inside
    assert torch.allclose(drive[0].sign(), toward[0].sign()) and float(drive @ (toward / toward.norm())) > 0.95


def test_an_unknown_side_and_impossible_parameters_are_refused() -> None:
    with pytest.raises(ValueError, match="flood_side of test/flood must be one of south, east, north, west, got 'up'"):
        begin(flood("paper"), room(NOTHING, "up"))
    world = room(NOTHING, "east")
    strange = (dataclasses.replace(world.specs[0], second_flood_side="down"),)
    with pytest.raises(ValueError, match="flood_side of test/flood must be one of .*, got 'down'"):
        begin(flood("paper"), dataclasses.replace(world, specs=strange))
    for name, value in (
        ("rise", 0.0),
        ("every", 0),
        ("cap", -1.0),
        ("slope", 50.0),
        ("gain", -1.0),
        ("damage_fraction", 1.5),
    ):
        with pytest.raises(ValueError, match=f"{name} must be .*, got {value}"):
            dataclasses.replace(flood("paper"), **{name: value})
    with pytest.raises(ValueError, match="physics must be one of paper, shipped, realistic, got 'wet'"):
        flood("wet")
