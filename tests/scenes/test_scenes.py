"""Generated scenes: what they hold, that nothing touches, and that everything can be reached."""

from __future__ import annotations

import collections
import math

import numpy as np
import pytest

from hazard_ms.scenes.assets.index import asset
from hazard_ms.scenes.floor import FLOOR_CELL, free_floor, steps_from
from hazard_ms.scenes.schema import check
from hazard_ms.scenes.splits import all_scene_names, scene
from hazard_ms.spec import Body, Fixture, SceneSpec
from hazard_ms.spec.catalogue import CATEGORIES, FIRE_POOL, NEW_OBJECTS
from tests.worlds.upright_things import corners, gap, radius_2d, standing_on

NAMES = all_scene_names()
SAMPLE = tuple(name for name in NAMES if name[-2:] in ("00", "17"))
EACH = pytest.mark.parametrize("name", [n if n in SAMPLE else pytest.param(n, marks=pytest.mark.long) for n in NAMES])
BODIES = 60


@EACH
def test_nothing_touches(name: str) -> None:
    spec = scene(name)
    things = [*spec.fixtures, *spec.bodies]
    boxes = [corners(t) for t in things]
    flat = [isinstance(t, Fixture) and asset(t.asset).extent[2] < 0.03 for t in things]  # rugs lie below things
    below = [set(standing_on(spec, t)) if isinstance(t, Body) else set() for t in things]
    for i, (a, p) in enumerate(zip(things, boxes, strict=True)):
        for j in range(i):
            b, q = things[j], boxes[j]
            far = math.dist(a.position[:2], b.position[:2]) > radius_2d(a) + radius_2d(b) + 0.01
            if far or flat[i] or flat[j] or b.name in below[i]:  # what stands in a shelf is inside the shelf's box
                continue
            beside = p[:, 2].min() < q[:, 2].max() and q[:, 2].min() < p[:, 2].max()
            assert not beside or gap(p, q) >= 0.0099, f"{a.name} and {b.name} are {gap(p, q):.4f} m apart"
        w, d = spec.room.size
        low, high = p.min(0), p.max(0)
        assert (low >= [0.0, 0.0, -1e-9]).all() and (high <= [w, d, spec.room.height]).all(), a.name
        for wall in spec.room.partitions:
            assert wall.axis == "y"
            assert high[0] <= wall.at - wall.thickness / 2 or low[0] >= wall.at + wall.thickness / 2, (
                f"{a.name} stands in a wall"
            )


@EACH
def test_what_a_scene_holds(name: str) -> None:
    spec = scene(name)
    check(spec)
    solid = [f for f in spec.fixtures if asset(f.asset).extent[2] > 0.03]
    assert len(solid) >= 12 and len(spec.bodies) == BODIES
    assert len({b.category for b in spec.bodies}) >= 15
    assert len(spec.target_categories) == 4 and 5 <= len(spec.targets) <= 20
    assert {b.category for b in spec.targets} == set(spec.target_categories)
    pool = NEW_OBJECTS if spec.split == "new_objects" else FIRE_POOL
    assert set(spec.target_categories) <= set(pool)
    if spec.split != "new_objects":
        assert not {b.category for b in spec.bodies} & set(NEW_OBJECTS), "new objects are new"
    kinds = [CATEGORIES[c] for c in spec.target_categories]
    assert {k.value for k in kinds} == {1, 5} and {k.flammable for k in kinds} == {True, False}
    assert spec.flood_side in ("south", "east", "north", "west") and spec.wind == (0.0, 0.0)
    floor = sum(b.position[2] < 0.1 for b in spec.bodies)
    assert 6 <= floor <= len(spec.bodies) - 6, "some things stand on the floor, some on furniture"
    assert all(t.rotation[1] == t.rotation[2] == 0.0 for t in (*spec.bodies, *spec.fixtures)), "all stand upright"
    names = collections.Counter(t.name for t in (*spec.bodies, *spec.fixtures))
    assert max(names.values()) == 1


@EACH
def test_every_body_rests_on_something(name: str) -> None:
    spec = scene(name)
    for body in spec.bodies:
        assert standing_on(spec, body), f"{body.name} hangs at {body.position}"


@EACH
def test_every_target_can_be_reached(name: str) -> None:
    """From the start, by a disc of 0.3 m over free floor, to within 0.75 m of the target, at most 1.1 m high."""
    spec = scene(name)
    free = free_floor(spec, 0.3)
    i, j = (int(c / FLOOR_CELL) for c in spec.agent_start.position)
    assert free[i, j]
    seen, queue = {(i, j)}, collections.deque([(i, j)])
    while queue:
        a, b = queue.popleft()
        for c in ((a + 1, b), (a - 1, b), (a, b + 1), (a, b - 1)):
            if 0 <= c[0] < free.shape[0] and 0 <= c[1] < free.shape[1] and free[c] and c not in seen:
                seen.add(c)
                queue.append(c)
    assert len(seen) >= 0.95 * free.sum(), "the free floor is one piece"
    places = (np.array(list(seen)) + 0.5) * FLOOR_CELL
    for body in spec.bodies:
        assert np.hypot(*(places - body.position[:2]).T).min() <= 0.75 + FLOOR_CELL, body.name
        assert 0.0 <= body.position[2] <= 1.1 and body.position[2] + asset(body.asset).extent[2] / 2 <= 1.11, body.name


@EACH
def test_free_floor_is_free(name: str) -> None:
    """Against distances to boxes, sampled densely along their outlines."""
    spec = scene(name)
    free = free_floor(spec, 0.3)
    x, y = (np.argwhere(free).T + 0.5) * FLOOR_CELL
    assert x.min() >= 0.3 - 1e-9 and y.max() <= spec.room.size[1] - 0.3 + 1e-9
    for wall, way in ((p, o) for p in spec.room.partitions for o in spec.room.openings if o.wall == p.name):
        from_wall = np.maximum(np.abs(x - wall.at) - wall.thickness / 2, 0)
        # sideways, to the nearest piece of the wall
        from_opening = np.maximum(way.width / 2 - np.abs(y - way.centre), 0)
        assert np.hypot(from_wall, from_opening).min() >= 0.3 - 1e-6 and (from_wall == 0).any(), (
            "only the doorway leads through"
        )
    for thing in (*spec.fixtures, *spec.bodies):
        if isinstance(thing, Fixture) and (asset(thing.asset).extent[2] < 0.03 or thing.position[2] > 1.3):
            continue  # rugs are driven over; cupboards and pictures hang above the robot
        outline = corners(thing)[[0, 4, 6, 2, 0]][:, :2]
        points = np.concatenate([np.linspace(outline[k], outline[k + 1], 40) for k in range(4)])
        near = np.hypot(x - thing.position[0], y - thing.position[1]) < radius_2d(thing) + 0.4
        nearest = np.hypot(x[near, None] - points[:, 0], y[near, None] - points[:, 1]).min(initial=math.inf)
        assert nearest >= 0.3 - 1e-6, f"the free floor comes within {nearest:.3f} m of {thing.name}"


def detour(spec: SceneSpec, fire: tuple[float, float]) -> float:
    """How much longer the path from the agent to some target gets by passing the fire [m], as `steps_from` counts."""
    free = free_floor(spec, 0.3)
    places = np.argwhere(free)

    def nearest(x: float, y: float) -> tuple[int, int]:
        i, j = places[np.hypot(*((places + 0.5) * FLOOR_CELL - (x, y)).T).argmin()]
        return int(i), int(j)

    start, flame = nearest(*spec.agent_start.position), nearest(*fire)
    direct, onward = steps_from(free, start), steps_from(free, flame)
    ends = [nearest(*t.position[:2]) for t in spec.targets]
    return min(direct[flame] + onward[e] - direct[e] for e in ends) * FLOOR_CELL


@EACH
def test_agent_and_fires_have_their_distance(name: str) -> None:
    spec = scene(name)
    roomy, start = free_floor(spec, 0.5), spec.agent_start.position
    assert roomy[int(start[0] / FLOOR_CELL), int(start[1] / FLOOR_CELL)]
    assert len(spec.fires) in ((3, 4) if spec.split == "hard" else (1, 2, 3))
    bare = free_floor(spec, 0.14)  # half the diagonal of a floor fire of 0.2 m
    for fire in spec.fires:
        assert bare[int(fire[0] / FLOOR_CELL), int(fire[1] / FLOOR_CELL)], "nothing stands in the fire"
        assert math.dist(fire, start) >= 0.5
        away = [math.dist(fire, t.position[:2]) for t in spec.targets]
        assert min(away) >= 0.5
        assert min(away) <= 1.5 or detour(spec, fire) <= 0.75, "a fire far from all targets and ways endangers none"
    assert min(math.dist(fire, t.position[:2]) for fire in spec.fires for t in spec.targets) <= 1.5
