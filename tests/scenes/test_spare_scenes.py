"""Scenes that belong to no split, for training."""

from __future__ import annotations

import pytest

from hazard_ms.scenes.splits import SCENES, all_scene_names, scene_names, spare_scene


def test_spare_scenes_take_turns_among_the_places_and_are_new() -> None:
    made = [spare_scene(scene_names("train"), number) for number in range(SCENES, SCENES + 3)]
    assert [one.name for one in made] == ["kitchen_a/25", "living_room_a/26", "craft_room_a/27"]
    assert not {one.name for one in made} & set(all_scene_names())
    again = spare_scene(scene_names("train"), SCENES)
    assert again == made[0] and len({one.bodies for one in made}) == 3


def test_scenes_of_splits_are_no_spare_ones() -> None:
    with pytest.raises(ValueError, match=f"a number of at least {SCENES}, got .*/{SCENES - 1}"):
        spare_scene(scene_names("train"), SCENES - 1)
    with pytest.raises(ValueError, match="known place"):
        spare_scene(["moon/00"], SCENES)
