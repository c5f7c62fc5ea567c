"""Scenes beyond the splits, of which pictures are taken for training."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from hazard_ms.evaluation.options import EnvOptions
from hazard_ms.perception.capture import capture
from hazard_ms.perception.check import faults
from hazard_ms.perception.options import CaptureOptions
from hazard_ms.scenes.files import read_scene
from hazard_ms.scenes.splits import SCENES, scene_names, spare_scene
from hazard_ms.tasks.spare import file_of, number_of, spare_names

NAMES = scene_names("train")
PLACES = ("kitchen_a", "living_room_a", "craft_room_a")


def test_every_place_has_spare_scenes_with_numbers_after_those_of_the_split() -> None:
    assert spare_names(NAMES, 2) == tuple(f"{place}/{number}" for place in PLACES for number in (25, 26))
    assert spare_names(NAMES, 0) == ()


def test_no_two_scenes_have_one_number_and_more_spare_ones_change_none() -> None:
    few, many = spare_names(NAMES, 3), spare_names(NAMES, 120)
    numbers = [number_of(scene, NAMES) for scene in (*NAMES, *many)]
    assert sorted(numbers) == list(range(len(NAMES) + 3 * 120))
    assert {number_of(scene, NAMES) for scene in few} == {75, 76, 77, 78, 79, 80, 81, 82, 83}


def test_a_spare_scene_is_played_from_a_file_that_holds_it_and_goes() -> None:
    with file_of("living_room_a/31", NAMES) as played:
        assert read_scene(Path(played)) == spare_scene(("living_room_a",), 31)
    assert not Path(played).exists()
    with file_of(NAMES[0], NAMES) as played:
        assert played == NAMES[0]


@pytest.mark.parametrize("scene", ["moon/31", "kitchen_b/31", "kitchen_a/025", "kitchen_a/-1", "kitchen_a", "../../31"])
def test_names_that_are_neither_of_the_split_nor_spare_are_refused(scene: str) -> None:
    with pytest.raises(ValueError, match=f"scenes must be in the split, or .* numbers of at least {SCENES}, got "):
        number_of(scene, NAMES)


@pytest.mark.parametrize(
    ("split", "spare", "told"),
    [
        ("test", 1, "spare must be 0 in the split test, got 1: spare scenes are for train"),
        ("train", -1, "spare must be .*got -1"),
        ("train", 10**6, "spare must be .*got 1000000"),
    ],
)
def test_spare_scenes_that_cannot_be_are_refused(split: str, spare: int, told: str, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=told):
        capture(CaptureOptions(env=EnvOptions(split=split), spare=spare, output=tmp_path / "data"))
    assert not (tmp_path / "data").exists()


def test_a_spare_scene_that_was_not_asked_for_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="a scene of the split 'train' must be one of .*got 'kitchen_a/27'"):
        capture(CaptureOptions(scenes=("kitchen_a/27",), spare=2, output=tmp_path / "data"))


@pytest.mark.render
def test_pictures_of_spare_scenes_stand_beside_those_of_the_split(tmp_path: Path) -> None:
    """Ids of pictures by hand: 100,000 for each scene, the second spare one of the second place is number 75 + 4."""
    wanted = ("kitchen_a/01", "living_room_a/26")
    asked = CaptureOptions(scenes=wanted, spare=2, per_scene=1, size=64, last_frame=0, output=tmp_path)
    assert capture(replace(asked, backend="serial")) == 0
    dataset = tmp_path / "HazardFire-v1"
    rows: Any = json.loads((dataset / "instances_train.json").read_text())
    told = {image["scene"]: (image["id"], image["room"], image["split"]) for image in rows["images"]}
    assert told == {wanted[0]: (100_001, "kitchen_a", "train"), wanted[1]: (7_900_001, "living_room_a", "train")}
    assert list(faults(dataset)) == []
