"""Captured pictures with a thermal image, and through smoke; their rows say so."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest

from hazard_ms.evaluation.options import EnvOptions
from hazard_ms.evaluation.workers import SILENCE
from hazard_ms.perception.capture import CaptureJob, assemble, attempt
from hazard_ms.perception.check import faults
from hazard_ms.perception.options import CaptureOptions

pytestmark = pytest.mark.render
SCENE = "kitchen_a/03"


def taken(options: CaptureOptions) -> Path:
    (options.dataset / "train").mkdir(parents=True)
    outcome = attempt(CaptureJob(options.episode(SCENE, 0), SILENCE, capture=options), lambda word: None)
    assert not outcome.error, outcome.error
    assert assemble(options.dataset, "train") == options.per_scene
    return options.dataset


@pytest.fixture(scope="module")
def both(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """The same four moments of a realistic fire, as they are and as sensors give them."""
    folder = tmp_path_factory.mktemp("sensed")
    env = EnvOptions(physics="realistic")
    plain = CaptureOptions(env=env, scenes=(SCENE,), per_scene=4, size=96, looks="fast", output=folder / "plain")
    return taken(plain), taken(replace(plain, thermal=True, degraded=True, output=folder / "sensed"))


def rows(dataset: Path) -> list[dict[str, object]]:
    found: list[dict[str, object]] = json.loads((dataset / "instances_train.json").read_text())["images"]
    return found


def test_rows_tell_what_was_done_to_a_picture_and_others_have_no_such_field(both: tuple[Path, Path]) -> None:
    plain, sensed = map(rows, both)
    assert all("degraded" not in row and "thermal_file" not in row and "transmission" not in row for row in plain)
    assert all(row["degraded"] is True and 0.0 <= float(str(row["transmission"])) < 1.0 for row in sensed)
    for mine, other in zip(sensed, plain, strict=True):
        assert {k: v for k, v in mine.items() if k in other} == other
    assert list(faults(both[0])) == list(faults(both[1])) == []


def test_labels_stay_and_colour_and_depth_lose_what_smoke_takes(both: tuple[Path, Path]) -> None:
    lost = 0
    for row in rows(both[0]):
        ids = [cv2.imread(str(folder / str(row["ids_file"])), cv2.IMREAD_UNCHANGED) for folder in both]
        assert np.array_equal(*ids)
        clear, dim = (cv2.imread(str(folder / str(row["depth_file"])), cv2.IMREAD_UNCHANGED) for folder in both)
        assert (dim[clear == 0] == 0).all()
        kept = dim > 0
        assert not kept.any() or np.median(np.abs(dim[kept].astype(float) - clear[kept])) < 30.0
        lost += int((clear > 0).sum() - kept.sum())
    assert lost > 0


def test_thermal_images_are_celsius_pixel_by_pixel(both: tuple[Path, Path]) -> None:
    hottest = []
    for row in rows(both[1]):
        image = np.load(both[1] / str(row["thermal_file"]))["thermal"]
        assert image.dtype == np.float32 and image.shape == (96, 96)
        assert image.min() >= -20.0 and image.max() <= 650.0
        hottest.append(float(image.max()))
    assert max(hottest) > 60.0


def test_the_recipe_names_what_is_not_usual() -> None:
    usual = CaptureOptions().recipe
    assert "thermal" not in usual and "degraded" not in usual
    assert {**usual, "thermal": True} == replace(CaptureOptions(), thermal=True).recipe
