"""Names, splits and families of scenes; random draws, and that making a scene is quick, or refused."""

from __future__ import annotations

import collections
import dataclasses
import time

import numpy as np
import pytest

from hazard_ms.scenes.floor import path, steps_from
from hazard_ms.scenes.generate.draw import Draw
from hazard_ms.scenes.generate.indoor import generate
from hazard_ms.scenes.generate.kitchens import KITCHEN_A
from hazard_ms.scenes.splits import all_scene_names, families, scene, scene_names, split_names
from hazard_ms.tasks import task_of

NAMES = all_scene_names()
SPLITS = {
    "train": ("kitchen_a", "living_room_a", "craft_room_a"),
    "test": ("kitchen_b",),
    "large": ("flat_a",),
    "new_objects": ("kitchen_b_new",),
    "hard": ("kitchen_b_hard",),
}


def test_splits() -> None:
    assert families()[0] == "indoor" and split_names() == tuple(SPLITS)
    for split, places in SPLITS.items():
        assert scene_names(split) == tuple(f"{place}/{n:02d}" for place in places for n in range(25))
        assert all(scene(n).split == split and scene(n).name == n for n in scene_names(split)[:3])
    with pytest.raises(ValueError, match="split of indoor scenes must be one of train, test, .*, got 'validation'"):
        scene_names("validation")
    known = "indoor, outdoor, house, house_flood, gale"
    with pytest.raises(ValueError, match=f"family of scenes must be one of {known}, got 'space'"):
        scene_names("train", "space")
    for bad in ("kitchen_a/25", "kitchen_a/7", "attic/00", "", "kitchen_a/../../etc"):
        with pytest.raises(ValueError, match="scene must be one of kitchen_a/00 to kitchen_a/24"):
            scene(bad)


def test_hard_rooms_hold_more_targets_more_fires_and_two_inflows() -> None:
    """Than those of the test split, docs/benchmark.md 1."""
    hard, usual = ([scene(name) for name in scene_names(split)[::3]] for split in ("hard", "test"))
    assert all(12 <= len(s.targets) <= 20 and len(s.fires) in (3, 4) for s in hard)
    assert all(s.second_flood_side in {"north", "south", "east", "west"} - {s.flood_side} for s in hard)
    assert all(s.second_flood_side is None for s in usual)
    assert np.mean([len(s.targets) for s in hard]) > 1.3 * np.mean([len(s.targets) for s in usual])


def test_building_a_scene_is_quick() -> None:
    scene.cache_clear()
    scene(NAMES[0])
    spent = []
    for name in NAMES[17::25]:
        before = time.process_time()
        scene(name)
        spent.append(time.process_time() - before)
    assert np.median(spent) < 0.3 and max(spent) < 1.2, spent


def test_a_room_too_small_is_refused_not_searched_for_ever() -> None:
    small = dataclasses.replace(KITCHEN_A.parts[0], width=(2.0, 2.1))
    closet = dataclasses.replace(KITCHEN_A, name="closet", parts=(small,), depth=(2.0, 2.1))
    with pytest.raises(ValueError, match="closet/00 must fit into its room, got no arrangement in 60 attempts"):
        generate(closet, "closet/00", "train")


def test_draws_are_uniform_and_counted() -> None:
    draw = Draw("1", "test")
    values = np.array([draw.whole(2, 5) for _ in range(4000)])
    # 4 sigma of the mean: 4 * 1.118 / sqrt(4000)
    assert set(values) == {2, 3, 4, 5} and abs(values.mean() - 3.5) < 0.07
    firsts = collections.Counter(draw.shuffled("abc")[0] for _ in range(3000))
    assert all(abs(n - 1000) < 105 for n in firsts.values())  # 4 sigma of a binomial(3000, 1/3)
    assert Draw("1", "a").uniform() != Draw("2", "a").uniform() != Draw("1", "a", 1).uniform()
    assert collections.Counter(draw.weighted("ab", (3.0, 1.0)) for _ in range(2000))["a"] / 2000 == pytest.approx(
        0.75, abs=0.04
    )


def test_shortest_ways_go_around_walls() -> None:
    free = np.ones((9, 9), bool)
    free[4, :8] = False  # a wall with a gap at the far end
    steps = steps_from(free, (0, 0))
    assert steps[0, 0] == 0 and steps[4, 0] == -1 and steps[8, 0] > steps[8, 8]
    way = path(steps, (8, 0))
    assert way[0] == (8, 0) and way[-1] == (0, 0) and (4, 8) in way
    assert all(max(abs(a - c), abs(b - d)) == 1 for (a, b), (c, d) in zip(way, way[1:], strict=False))


def test_the_task_plays_in_these_scenes() -> None:
    task = task_of("HazardFire-v1", "shipped")
    assert task.splits == tuple(SPLITS) and task.all_scenes == NAMES and task.max_frames == 1500
    assert task.build("kitchen_a/02") == scene("kitchen_a/02")
    assert [h.name for h in task.hazards] == ["fire"] and task.safe_place.name == "bag"
    with pytest.raises(ValueError, match="physics must be one of paper, shipped, realistic, got 'lunar'"):
        task_of("HazardFire-v1", "lunar")
