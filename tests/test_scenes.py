"""Generated scenes: what they hold, that nothing touches, that everything can be reached, that they are always the same."""

from __future__ import annotations

import collections
import dataclasses
import hashlib
import math
import subprocess
import sys
import time

import numpy as np
import pytest

from hazard_ms.assets import asset
from hazard_ms.catalogue import CATEGORIES, FIRE_POOL
from hazard_ms.scenes.draw import Draw
from hazard_ms.scenes.floor import CELL, free_floor, path, steps_from
from hazard_ms.scenes.rooms import KITCHEN_A
from hazard_ms.scenes.schema import check, to_json
from hazard_ms.scenes.shell import shell
from hazard_ms.scenes.splits import all_scene_names, generate, scene, scene_names
from hazard_ms.spec import Body, Fixture, Opening, Room, SceneSpec
from hazard_ms.tasks import TASKS

NAMES = all_scene_names()


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


@pytest.mark.parametrize("name", NAMES)
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


@pytest.mark.parametrize("name", NAMES)
def test_what_a_scene_holds(name: str) -> None:
    spec = scene(name)
    check(spec)
    solid = [f for f in spec.fixtures if asset(f.asset).extent[2] > 0.03]
    assert len(solid) >= 8 and 20 <= len(spec.bodies) <= 40
    assert len({b.category for b in spec.bodies}) >= 10
    assert {b.category for b in spec.bodies} <= set(FIRE_POOL)
    assert len(spec.target_categories) == 4 and 5 <= len(spec.targets) <= 20
    assert {b.category for b in spec.targets} == set(spec.target_categories)
    kinds = [CATEGORIES[c] for c in spec.target_categories]
    assert {k.value for k in kinds} == {1, 5} and {k.flammable for k in kinds} == {True, False}
    floor = sum(b.position[2] < 0.1 for b in spec.bodies)
    assert 3 <= floor <= len(spec.bodies) - 3, "some things stand on the floor, some on furniture"
    assert all(t.rotation[1] == t.rotation[2] == 0.0 for t in (*spec.bodies, *spec.fixtures)), "all stand upright"
    names = collections.Counter(t.name for t in (*spec.bodies, *spec.fixtures))
    assert max(names.values()) == 1


@pytest.mark.parametrize("name", NAMES)
def test_every_body_rests_on_something(name: str) -> None:
    spec = scene(name)
    for body in spec.bodies:
        assert standing_on(spec, body), f"{body.name} hangs at {body.position}"


@pytest.mark.parametrize("name", NAMES)
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


@pytest.mark.parametrize("name", NAMES)
def test_free_floor_is_free(name: str) -> None:
    """Against distances to boxes, sampled densely along their outlines."""
    spec = scene(name)
    free = free_floor(spec, 0.3)
    x, y = (np.argwhere(free).T + 0.5) * CELL
    assert x.min() >= 0.3 - 1e-9 and y.max() <= spec.room.size[1] - 0.3 + 1e-9
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


@pytest.mark.parametrize("name", NAMES)
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
    specs = [scene(n) for n in NAMES]
    assert len({to_json(dataclasses.replace(s, name="x", split="x")) for s in specs}) == len(specs) == 25
    assert len({s.target_categories for s in specs}) >= 15
    assert len({len(s.fires) for s in specs}) == 3
    assert {s.room.openings[-1].wall for s in specs} == {"south", "north"}, "rooms are mirrored"
    assert len({b.category for s in specs for b in s.targets}) >= 12
    assert len({len(s.bodies) for s in specs}) == 1, "scenes of one room share a batch"


def test_doors_and_windows_stay_free() -> None:
    for name in NAMES:
        spec = scene(name)
        for o in spec.room.openings:
            for f in spec.fixtures:
                p = corners(f)
                across, along = (1, 0) if o.wall in ("south", "north") else (0, 1)
                depth = p[:, across].min() if o.wall in ("south", "west") else spec.room.size[across] - p[:, across].max()
                beside = p[:, along].max() <= o.centre - o.width / 2 or p[:, along].min() >= o.centre + o.width / 2
                near = depth < (0.85 if o.kind == "door" else 0.25)
                assert not near or beside or p[:, 2].max() <= max(o.sill, 0.03), f"{name}: {f.name} before a {o.kind}"


def test_the_same_name_gives_the_same_bytes_in_another_process() -> None:
    code = "import hashlib; from hazard_ms.scenes.schema import to_json; from hazard_ms.scenes.splits import *\n"
    code += "print(hashlib.sha256(''.join(to_json(scene(n)) for n in reversed(scene_names('test'))).encode()).hexdigest())"
    there = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    scene.cache_clear()
    here = hashlib.sha256("".join(to_json(scene(n)) for n in reversed(scene_names("test"))).encode()).hexdigest()
    assert there == here + "\n"


def test_splits() -> None:
    assert scene_names("train") == tuple(f"kitchen_a/{n:02d}" for n in range(20))
    assert scene_names("test") == tuple(f"kitchen_a/{n:02d}" for n in range(20, 25))
    assert scene("kitchen_a/21").split == "test" and scene("kitchen_a/01").split == "train"
    with pytest.raises(ValueError, match="no split is called 'validation'; there are train, test"):
        scene_names("validation")
    for bad in ("kitchen_a/25", "kitchen_a/7", "attic/00", "", "kitchen_a/../../etc"):
        with pytest.raises(ValueError, match="kitchen_a/00 to kitchen_a/24"):
            scene(bad)


def test_building_a_scene_is_quick() -> None:
    scene.cache_clear()
    scene(NAMES[0])
    spent = []
    for name in NAMES[1:8]:
        before = time.process_time()
        scene(name)
        spent.append(time.process_time() - before)
    assert np.median(spent) < 0.3, spent


def test_a_room_too_small_is_refused_not_searched_for_ever() -> None:
    closet = dataclasses.replace(KITCHEN_A, name="closet", width=(2.0, 2.1), depth=(2.0, 2.1))
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
    assert task.splits == ("train", "test") and task.all_scenes == NAMES and task.max_frames == 1500
    assert task.build("kitchen_a/02") == scene("kitchen_a/02")
    assert [h.name for h in task.hazards] == ["fire"] and task.safe_place == "bag"
    with pytest.raises(ValueError, match="no preset of physics is called 'lunar'"):
        TASKS["HazardFire-v1"]("lunar")
