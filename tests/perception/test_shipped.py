"""The weights that the package brings."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from hazard_ms.evaluation.options import EnvOptions
from hazard_ms.perception.capture import capture
from hazard_ms.perception.detectors.small import SHIPPED, Small
from hazard_ms.perception.options import CaptureOptions
from hazard_ms.perception.score import average_precision
from hazard_ms.perception.training.pictures import read, truth_of
from hazard_ms.perception.training.validation import results_of
from hazard_ms.tasks import task_of


def test_it_knows_everything_that_is_to_be_rescued_and_the_carts() -> None:
    known = set(Small().classes)
    for env_id in ("HazardFire-v1", "HazardFlood-v1", "HazardWind-v1"):
        task = task_of(env_id, "paper")
        for scene in task.scenes("test"):
            spec = task.build(scene)
            assert {target.category for target in spec.targets} <= known, scene
            assert {t.category for t in spec.things if t.category in task.safe_place.containers} <= known, scene


def test_it_takes_less_than_eight_megabytes() -> None:
    assert sum(SHIPPED.with_suffix(ending).stat().st_size for ending in (".safetensors", ".json")) < 8e6


@pytest.mark.render
def test_it_finds_things_in_a_room_that_it_has_not_seen(tmp_path: Path) -> None:
    """AP50 of masks of things of 256 pixels or more is at least 0.2; with names changed round it is next to nothing."""
    env = EnvOptions(split="test")
    one = {"scenes": ("kitchen_b/11",), "per_scene": 8, "size": 512, "fov": 120.0, "backend": "serial"}
    capture(CaptureOptions(env=env, output=tmp_path, **one))  # type: ignore[arg-type]
    pictures, detector = read([tmp_path / "HazardFire-v1"], "test"), Small()
    truth, found = truth_of(pictures, detector.classes), results_of(detector, pictures)
    large = (256.0, math.inf)
    numbers = sorted({row["category_id"] for row in truth["annotations"]})
    others = dict(zip(numbers, np.roll(numbers, 1).tolist(), strict=True))
    wrong = [{**row, "category_id": others.get(row["category_id"], row["category_id"])} for row in found]
    right = average_precision(truth, found, "segm", area=large)[1]
    assert right >= 0.2 and average_precision(truth, wrong, "segm", area=large)[1] < right / 4
