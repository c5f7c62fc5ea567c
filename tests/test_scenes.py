"""Generated scenes: what they hold, that nothing touches, that everything can be reached, that they are always the same."""

from __future__ import annotations

import collections
import dataclasses
import math
import time

import numpy as np
import pytest

from hazard_ms.assets import asset
from hazard_ms.catalogue import CATEGORIES, FIRE_POOL, NEW_OBJECTS
from hazard_ms.scenes.draw import Draw
from hazard_ms.scenes.floor import CELL, free_floor, path, steps_from
from hazard_ms.scenes.indoor import generate
from hazard_ms.scenes.rooms import KITCHEN_A
from hazard_ms.scenes.schema import check, to_json
from hazard_ms.scenes.shell import shell
from hazard_ms.scenes.splits import all_scene_names, families, scene, scene_names, split_names
from hazard_ms.spec import Body, Fixture, Opening, Room, SceneSpec
from hazard_ms.tasks import TASKS

NAMES = all_scene_names()
SPLITS = {
    "train": ("kitchen_a", "living_room_a", "craft_room_a"),
    "test": ("kitchen_b",),
    "large": ("flat_a",),
    "new_objects": ("kitchen_b_new",),
}
SAMPLE = tuple(name for name in NAMES if name[-2:] in ("00", "17"))
EACH = pytest.mark.parametrize("name", [n if n in SAMPLE else pytest.param(n, marks=pytest.mark.long) for n in NAMES])
WIDE = tuple(name for name in NAMES if int(name[-2:]) % 5 == 0)  # where many scenes are looked at together
BODIES = 60


def corners(thing: Body | Fixture) -> np.ndarray:
    """The eight corners of what a thing occupies [m], [8, 3], by the full rotation matrix."""
    x, y, z = np.array(asset(thing.asset).extent) * thing.scale
    box = np.array([[i * x / 2, j * y / 2, k * z] for i in (-1, 1) for j in (-1, 1) for k in (0, 1)])
    return box @ rotation(thing).T + thing.position


def rotation(thing: Body | Fixture) -> np.ndarray:
    w, v = thing.rotation[0], np.array(thing.rotation[1:])
    skew = np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])
    return np.eye(3) + 2 * w * skew + 2 * skew @ skew


def gap(a: np.ndarray, b: np.ndarray) -> float:
    """How far two boxes given by corners are apart along the best of the 15 separating axes [m]; negative: they overlap."""
    edges = [[box[4] - box[0], box[2] - box[0], box[1] - box[0]] for box in (a, b)]
    axes = [*edges[0], *edges[1], *(np.cross(e, f) for e in edges[0] for f in edges[1])]
    best = -math.inf
    for axis in axes:
        length = np.linalg.norm(axis)
        if length > 1e-9:
            p, q = a @ axis / length, b @ axis / length
            best = max(best, q.min() - p.max(), p.min() - q.max())
    return best


def radius_2d(thing: Body | Fixture) -> float:
    return math.hypot(*asset(thing.asset).extent[:2]) / 2


def standing_on(spec: SceneSpec, body: Body) -> list[str]:
    """Names of what is just below the body: fixtures with a support there, or the floor."""
    found = ["floor"] if abs(body.position[2]) <= 0.002 else []
    for f in spec.fixtures:
        for s in asset(f.asset).supports:
            local = (corners(body) - f.position) @ rotation(f)  # into the fixture's frame
            inside = (local[:, :2] >= np.array(s.min) - 1e-6).all() and (local[:, :2] <= np.array(s.max) + 1e-6).all()
            if inside and 0.0 <= body.position[2] - (f.position[2] + s.z) <= 0.002:
                found.append(f.name)
    return found


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
            assert high[0] <= wall.at - wall.thickness / 2 or low[0] >= wall.at + wall.thickness / 2, f"{a.name} stands in a wall"


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
    """From the start, by a disc of 0.3 m over free floor, to within 0.75 m of the target, which is at a height of 0 to 1.1 m."""
    spec = scene(name)
    free = free_floor(spec, 0.3)
    i, j = (int(c / CELL) for c in spec.agent_start.position)
    assert free[i, j]
    seen, queue = {(i, j)}, collections.deque([(i, j)])
    while queue:
        a, b = queue.popleft()
        for c in ((a + 1, b), (a - 1, b), (a, b + 1), (a, b - 1)):
            if 0 <= c[0] < free.shape[0] and 0 <= c[1] < free.shape[1] and free[c] and c not in seen:
                seen.add(c)
                queue.append(c)
    assert len(seen) >= 0.95 * free.sum(), "the free floor is one piece"
    places = (np.array(list(seen)) + 0.5) * CELL
    for body in spec.bodies:
        assert np.hypot(*(places - body.position[:2]).T).min() <= 0.75 + CELL, body.name
        assert 0.0 <= body.position[2] <= 1.1 and body.position[2] + asset(body.asset).extent[2] / 2 <= 1.11, body.name


@EACH
def test_free_floor_is_free(name: str) -> None:
    """Against distances to boxes, sampled densely along their outlines."""
    spec = scene(name)
    free = free_floor(spec, 0.3)
    x, y = (np.argwhere(free).T + 0.5) * CELL
    assert x.min() >= 0.3 - 1e-9 and y.max() <= spec.room.size[1] - 0.3 + 1e-9
    for wall, way in ((p, o) for p in spec.room.partitions for o in spec.room.openings if o.wall == p.name):
        from_wall = np.maximum(np.abs(x - wall.at) - wall.thickness / 2, 0)
        from_opening = np.maximum(way.width / 2 - np.abs(y - way.centre), 0)  # sideways, to the nearest piece of the wall
        assert np.hypot(from_wall, from_opening).min() >= 0.3 - 1e-6 and (from_wall == 0).any(), "only the doorway leads through"
    for thing in (*spec.fixtures, *spec.bodies):
        if isinstance(thing, Fixture) and (asset(thing.asset).extent[2] < 0.03 or thing.position[2] > 1.3):
            continue  # rugs are driven over; cupboards and pictures hang above the robot
        outline = corners(thing)[[0, 4, 6, 2, 0]][:, :2]
        points = np.concatenate([np.linspace(outline[k], outline[k + 1], 40) for k in range(4)])
        near = np.hypot(x - thing.position[0], y - thing.position[1]) < radius_2d(thing) + 0.4
        nearest = np.hypot(x[near, None] - points[:, 0], y[near, None] - points[:, 1]).min(initial=math.inf)
        assert nearest >= 0.3 - 1e-6, f"the free floor comes within {nearest:.3f} m of {thing.name}"


def detour(spec: SceneSpec, fire: tuple[float, float]) -> float:
    """How much longer the way from the agent to some target gets by passing the fire [m], in the metric of edges and corners."""
    free = free_floor(spec, 0.3)
    places = np.argwhere(free)

    def nearest(x: float, y: float) -> tuple[int, int]:
        i, j = places[np.hypot(*((places + 0.5) * CELL - (x, y)).T).argmin()]
        return int(i), int(j)

    start, flame = nearest(*spec.agent_start.position), nearest(*fire)
    direct, onward = steps_from(free, start), steps_from(free, flame)
    ends = [nearest(*t.position[:2]) for t in spec.targets]
    return min(direct[flame] + onward[e] - direct[e] for e in ends) * CELL


@EACH
def test_agent_and_fires_have_their_distance(name: str) -> None:
    spec = scene(name)
    roomy, start = free_floor(spec, 0.5), spec.agent_start.position
    assert roomy[int(start[0] / CELL), int(start[1] / CELL)]
    assert 1 <= len(spec.fires) <= 3
    bare = free_floor(spec, 0.14)  # half the diagonal of a floor fire of 0.2 m
    for fire in spec.fires:
        assert bare[int(fire[0] / CELL), int(fire[1] / CELL)], "nothing stands in the fire"
        assert math.dist(fire, start) >= 0.5
        away = [math.dist(fire, t.position[:2]) for t in spec.targets]
        assert min(away) >= 0.5
        assert min(away) <= 1.5 or detour(spec, fire) <= 0.75, "a fire far from all targets and ways endangers none"
    assert min(math.dist(fire, t.position[:2]) for fire in spec.fires for t in spec.targets) <= 1.5


def test_scenes_differ() -> None:
    specs = [scene(n) for n in WIDE]
    assert len({to_json(dataclasses.replace(s, name="x", split="x")) for s in specs}) == len(specs) == 30
    assert len({s.target_categories for s in specs}) >= 27
    assert len({len(s.fires) for s in specs}) == 3
    assert {s.room.openings[2].wall for s in specs if s.name.startswith("kitchen_a")} == {"south", "north"}, "rooms are mirrored"
    assert {b.category for s in specs if s.split != "new_objects" for b in s.targets} >= set(FIRE_POOL[:8])
    assert len({len(s.bodies) for s in specs}) == 1, "all scenes share batches"
    for places in SPLITS.values():
        for place in places:
            mine = [s for s in specs if s.name.split("/")[0] == place]
            assert len({(s.room.floor, s.room.wall) for s in mine}) >= 3 and len({s.room.size for s in mine}) >= 3, place


def test_water_comes_sooner_from_walls_with_openings() -> None:
    """A wall with an opening is 4 times as likely as one without: within 4 sigma of a sum of 30 different coins."""
    specs = [scene(n) for n in WIDE]
    leaky = [{o.wall for o in s.room.openings} & {"north", "south", "east", "west"} for s in specs]
    chance = np.array([4 * len(walls) / (4 * len(walls) + 4 - len(walls)) for walls in leaky])
    found = sum(s.flood_side in walls for s, walls in zip(specs, leaky, strict=True))
    assert abs(found - chance.sum()) <= 4 * math.sqrt((chance * (1 - chance)).sum())
    assert {s.flood_side for s in specs} == {"north", "south", "east", "west"}


def test_large_scenes_are_two_rooms_with_twice_the_floor() -> None:
    area = {n: math.prod(scene(n).room.size) for n in WIDE}
    largest = max(a for n, a in area.items() if not n.startswith("flat_a"))
    for name in scene_names("large"):
        spec = scene(name)
        assert math.prod(spec.room.size) >= 2 * largest
        (wall,), (way,) = spec.room.partitions, [o for o in spec.room.openings if o.kind == "doorway"]
        assert way.wall == wall.name and way.width >= 1.0 and way.height >= 2.0
        for box in (corners(f) for f in spec.fixtures):  # keeps clear of the way on both sides
            off = max(box[:, 0].min() - wall.at, wall.at - box[:, 0].max())
            assert off >= 0.9 or box[:, 1].min() >= way.centre + 0.6 or box[:, 1].max() <= way.centre - 0.6 or box[:, 2].max() < 0.03
        sides = {thing.position[0] < wall.at for thing in spec.bodies}
        assert sides == {True, False}
        assert all(math.dist(fire, (wall.at, way.centre)) >= 0.8 for fire in spec.fires), "no fire shuts the only way"


def test_doors_and_windows_stay_free() -> None:
    for name in WIDE:
        spec = scene(name)
        for o in spec.room.openings:
            for f in spec.fixtures if o.kind != "doorway" else ():
                p = corners(f)
                across, along = (1, 0) if o.wall in ("south", "north") else (0, 1)
                depth = p[:, across].min() if o.wall in ("south", "west") else spec.room.size[across] - p[:, across].max()
                beside = p[:, along].max() <= o.centre - o.width / 2 or p[:, along].min() >= o.centre + o.width / 2
                near = depth < (0.85 if o.kind == "door" else 0.25)
                assert not near or beside or p[:, 2].max() <= max(o.sill, 0.03), f"{name}: {f.name} before a {o.kind}"


def test_splits() -> None:
    assert families()[0] == "indoor" and split_names() == tuple(SPLITS)
    for split, places in SPLITS.items():
        assert scene_names(split) == tuple(f"{place}/{n:02d}" for place in places for n in range(25))
        assert all(scene(n).split == split and scene(n).name == n for n in scene_names(split)[:3])
    with pytest.raises(ValueError, match="no split is called 'validation'; there are train, test"):
        scene_names("validation")
    with pytest.raises(ValueError, match="no family of scenes is called 'space'; there are indoor"):
        scene_names("train", "space")
    for bad in ("kitchen_a/25", "kitchen_a/7", "attic/00", "", "kitchen_a/../../etc"):
        with pytest.raises(ValueError, match="kitchen_a/00 to kitchen_a/24"):
            scene(bad)


def test_building_a_scene_is_quick() -> None:
    scene.cache_clear()
    scene(NAMES[0])
    spent = []
    for name in SAMPLE[1:]:
        before = time.process_time()
        scene(name)
        spent.append(time.process_time() - before)
    assert np.median(spent) < 0.3 and max(spent) < 1.2, spent


def test_a_room_too_small_is_refused_not_searched_for_ever() -> None:
    small = dataclasses.replace(KITCHEN_A.parts[0], width=(2.0, 2.1))
    closet = dataclasses.replace(KITCHEN_A, name="closet", parts=(small,), depth=(2.0, 2.1))
    with pytest.raises(ValueError, match="closet.*could not be laid out in 60 attempts"):
        generate(closet, "closet/00", "train")


def test_draws_are_uniform_and_counted() -> None:
    draw = Draw("1", "test")
    values = np.array([draw.whole(2, 5) for _ in range(4000)])
    assert set(values) == {2, 3, 4, 5} and abs(values.mean() - 3.5) < 0.07  # 4 sigma of the mean: 4 * 1.118 / sqrt(4000)
    firsts = collections.Counter(draw.shuffled("abc")[0] for _ in range(3000))
    assert all(abs(n - 1000) < 105 for n in firsts.values())  # 4 sigma of a binomial(3000, 1/3)
    assert Draw("1", "a").uniform() != Draw("2", "a").uniform() != Draw("1", "a", 1).uniform()
    assert collections.Counter(draw.weighted("ab", (3.0, 1.0)) for _ in range(2000))["a"] / 2000 == pytest.approx(0.75, abs=0.04)


def test_shortest_ways_go_around_walls() -> None:
    free = np.ones((9, 9), bool)
    free[4, :8] = False  # a wall with a gap at the far end
    steps = steps_from(free, (0, 0))
    assert steps[0, 0] == 0 and steps[4, 0] == -1 and steps[8, 0] > steps[8, 8]
    way = path(steps, (8, 0))
    assert way[0] == (8, 0) and way[-1] == (0, 0) and (4, 8) in way
    assert all(max(abs(a - c), abs(b - d)) == 1 for (a, b), (c, d) in zip(way, way[1:], strict=False))


def test_the_shell_closes_the_room() -> None:
    """Rays from inside meet a colliding box in every direction, doors and windows included."""
    room = scene(NAMES[0]).room
    solid = [b for b in shell(room) if b.collides]
    low = np.array([np.subtract(b.centre, np.divide(b.size, 2)) for b in solid])
    high = np.array([np.add(b.centre, np.divide(b.size, 2)) for b in solid])
    rng = np.random.default_rng(0)
    eye = np.array([*np.divide(room.size, 2), 1.2])
    assert not ((low < eye) & (eye < high)).all(-1).any()
    for _ in range(2000):
        ray = rng.normal(size=3)
        t = np.stack([(low - eye) / ray, (high - eye) / ray])
        near, far = t.min(0).max(-1), t.max(0).min(-1)
        assert ((near <= far) & (far > 0)).any(), f"a ray along {ray} leaves the room"


def test_the_shell_keeps_to_its_openings() -> None:
    room = Room((5.0, 4.0), openings=(Opening("window", "east", 2.0, 1.0, 1.2, 0.9),))
    walls = [b for b in shell(room) if b.kind == "wall" and "east" in b.name]
    area = sum(b.size[1] * b.size[2] for b in walls)
    assert area == pytest.approx(4.0 * 2.6 - 1.0 * 1.2)
    for bad, message in (
        (Opening("door", "south", 0.2, 0.9, 2.0), "leaves the south wall"),
        (Opening("door", "south", 2, 1, 3), "leaves"),
    ):
        with pytest.raises(ValueError, match=message):
            shell(dataclasses.replace(room, openings=(bad,)))
    with pytest.raises(ValueError, match="no material is called 'lava'; there are wood"):
        shell(dataclasses.replace(room, floor="lava"))


def test_the_task_plays_in_these_scenes() -> None:
    task = TASKS["HazardFire-v1"]("shipped")
    assert task.splits == tuple(SPLITS) and task.all_scenes == NAMES and task.max_frames == 1500
    assert task.build("kitchen_a/02") == scene("kitchen_a/02")
    assert [h.name for h in task.hazards] == ["fire"] and task.safe_place == "bag"
    with pytest.raises(ValueError, match="no preset of physics is called 'lunar'"):
        TASKS["HazardFire-v1"]("lunar")
