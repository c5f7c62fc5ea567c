"""Scenes differ from one another, and each kind of room keeps to its rules."""

from __future__ import annotations

import dataclasses
import math

import numpy as np

from hazard_ms.scenes.schema import to_json
from hazard_ms.scenes.splits import all_scene_names, scene, scene_names, split_names
from hazard_ms.spec.catalogue import FIRE_POOL
from tests.worlds.upright_things import corners

WIDE = tuple(name for name in all_scene_names() if int(name[-2:]) % 5 == 0)  # where many scenes are looked at together


def test_scenes_differ() -> None:
    specs = [scene(n) for n in WIDE]
    assert len({to_json(dataclasses.replace(s, name="x", split="x")) for s in specs}) == len(specs) == 35
    assert len({s.target_categories for s in specs}) >= 27
    assert {len(s.fires) for s in specs if s.split != "hard"} == {1, 2, 3}
    assert {s.room.openings[2].wall for s in specs if s.name.startswith("kitchen_a")} == {"south", "north"}, (
        "rooms are mirrored"
    )
    assert {b.category for s in specs if s.split != "new_objects" for b in s.targets} >= set(FIRE_POOL[:8])
    assert len({len(s.bodies) for s in specs}) == 1, "all scenes share batches"
    for split in split_names():
        for place in {name.split("/")[0] for name in scene_names(split)}:
            mine = [s for s in specs if s.name.split("/")[0] == place]
            assert len({(s.room.floor, s.room.wall) for s in mine}) >= 3 and len({s.room.size for s in mine}) >= 3, (
                place
            )


def test_water_comes_sooner_from_walls_with_openings() -> None:
    """A wall with an opening is 4 times as likely as one without: within 4 sigma of a sum of 35 different coins."""
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
            assert (
                off >= 0.9
                or box[:, 1].min() >= way.centre + 0.6
                or box[:, 1].max() <= way.centre - 0.6
                or box[:, 2].max() < 0.03
            )
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
                depth = (
                    p[:, across].min() if o.wall in ("south", "west") else spec.room.size[across] - p[:, across].max()
                )
                beside = p[:, along].max() <= o.centre - o.width / 2 or p[:, along].min() >= o.centre + o.width / 2
                near = depth < (0.85 if o.kind == "door" else 0.25)
                assert not near or beside or p[:, 2].max() <= max(o.sill, 0.03), f"{name}: {f.name} before a {o.kind}"
