"""Captured datasets: what is in them, what they depend on, and that nothing interrupts them for good."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import cv2
import gymnasium as gym
import numpy as np
import pytest
import torch
from pycocotools import mask as tools
from pycocotools.coco import COCO

from hazard_ms.perception import layout
from hazard_ms.perception.capture import capture
from hazard_ms.perception.check import faults
from hazard_ms.perception.options import CaptureOptions
from hazard_ms.perception.scene import OF_TARGETS, POSES

pytestmark = pytest.mark.render
STATUS = ("normal", "burning", "burnt")


def rows_of(dataset: Path) -> Any:
    return json.loads((dataset / "instances_train.json").read_text())


def test_a_dataset_keeps_its_own_promises(dataset: Path) -> None:
    assert list(faults(dataset)) == []


def test_masks_are_what_the_ids_show_and_boxes_are_tight_to_the_pixel(dataset: Path) -> None:
    """Run lengths are decoded by pycocotools, boxes compared with the outermost pixels."""
    rows = rows_of(dataset)
    ids = {i["id"]: cv2.imread(str(dataset / i["ids_file"]), cv2.IMREAD_UNCHANGED) for i in rows["images"]}
    assert len(rows["annotations"]) > len(rows["images"])
    for row in rows["annotations"]:
        y, x = np.nonzero(ids[row["image_id"]] == row["instance"] + 1)
        mask = tools.decode(row["segmentation"])
        assert row["area"] == mask.sum() == len(x)
        assert mask[y, x].all()
        assert row["bbox"] == [x.min(), y.min(), np.ptp(x) + 1, np.ptp(y) + 1]


def test_pictures_are_spread_over_the_episode_and_show_targets(dataset: Path, options: CaptureOptions) -> None:
    rows = rows_of(dataset)
    frames = sorted({image["frame"] for image in rows["images"]})
    stops = -(-options.per_scene // POSES)
    limit = options.env.max_frames
    assert [frame * stops // limit for frame in frames] == list(range(stops))
    seen = {row["image_id"] for row in rows["annotations"] if row["attributes"]["target"]}
    assert len(seen) >= 0.5 * OF_TARGETS * len(rows["images"])
    assert any(image["hazard_visible"] for image in rows["images"])


def test_a_thing_burns_in_its_annotation_when_it_burns_in_the_fire(dataset: Path) -> None:
    """The same episode is played again by an environment of its own, and its state read directly."""
    rows = rows_of(dataset)
    env: Any = gym.make("HazardFire-v1", obs_mode="none", render_backend="none").unwrapped
    first = rows["images"][0]
    env.reset(seed=first["seed"], options={"scene": first["scene"]})
    still, found = torch.zeros(env.action_space.shape), set()
    for image in sorted(rows["images"], key=lambda image: image["frame"]):
        while int(env.world.frame[0]) < image["frame"]:
            env.advance(still)
        state = env.episode.states["fire"]
        for row in (row for row in rows["annotations"] if row["image_id"] == image["id"]):
            b, told = row["instance"], row["attributes"]
            assert row["name"] == env.world.names[0][b]
            assert told["status"] == STATUS[int(state.status[0, b])]
            assert told["temperature_c"] == pytest.approx(float(state.temperature[0, b]), abs=0.01)
            assert told["damaged"] == bool(env.episode.damage.damaged[0, b])
            found.add(told["status"])
    env.close()
    assert {"normal", "burning"} <= found


def test_the_camera_matrices_put_what_is_seen_where_it_is(dataset: Path) -> None:
    """The points of a thing, by depth and matrices as docs/perception.md says, lie about its distance away."""
    rows = rows_of(dataset)
    for image in rows["images"]:
        depth = np.asarray(cv2.imread(str(dataset / image["depth_file"]), cv2.IMREAD_UNCHANGED)) * 1e-3
        k, pose = (np.array(image["camera"][name]) for name in ("intrinsic", "cam2world"))
        v, u = np.mgrid[: image["height"], : image["width"]] + 0.5
        local = np.stack([(u - k[0, 2]) / k[0, 0] * depth, -(v - k[1, 2]) / k[1, 1] * depth, -depth], -1)
        world = local @ pose[:3, :3].T + pose[:3, 3]
        assert 1.0 <= pose[2, 3] <= 1.2
        assert world[depth > 0][:, 2].min() > -0.05, "nothing is below the floor"
        for row in (row for row in rows["annotations"] if row["image_id"] == image["id"]):
            points = world[tools.decode(row["segmentation"]).astype(bool)]
            far = np.linalg.norm(np.median(points, 0) - pose[:3, 3])
            assert abs(far - row["attributes"]["distance_m"]) < 1.5, row["name"]


def test_pycocotools_reads_it(dataset: Path) -> None:
    data = COCO(dataset / "instances_train.json")
    image = data.loadImgs(data.getImgIds()[0])[0]
    assert (dataset / image["file_name"]).is_file()
    for row in data.loadAnns(data.getAnnIds(image["id"])):
        assert data.annToMask(row).sum() == row["area"]
        assert data.loadCats(row["category_id"])[0]["supercategory"] in ("object", "fixture")


def test_whole_scenes_are_not_taken_again(
    dataset: Path, options: CaptureOptions, capsys: pytest.CaptureFixture[str]
) -> None:
    before = (dataset / layout.SUMS).read_bytes()
    assert capture(options) == 0
    assert "1 of 1 scenes are already captured" in capsys.readouterr().out
    assert (dataset / layout.SUMS).read_bytes() == before


def test_pictures_of_another_recipe_are_not_mixed_in(dataset: Path, options: CaptureOptions) -> None:
    with pytest.raises(ValueError, match="'size': 128.* got .*'size': 96"):
        capture(replace(options, size=128))


def command(options: CaptureOptions, output: Path, *more: str) -> list[str]:
    words = ["--scenes", *options.scenes, "--per-scene", str(options.per_scene), "--size", str(options.size)]
    return [sys.executable, "-m", "hazard_ms.cli", "perception", "capture", *words, "-o", str(output), *more]


def test_pictures_of_the_first_frame_show_what_no_hazard_has_changed(tmp_path: Path) -> None:
    options = CaptureOptions(
        scenes=("kitchen_a/03",), per_scene=9, size=64, last_frame=0, backend="serial", output=tmp_path
    )
    assert capture(options) == 0
    rows = rows_of(tmp_path / "HazardFire-v1")
    assert {image["frame"] for image in rows["images"]} == {0}
    assert {row["attributes"]["status"] for row in rows["annotations"]} == {"normal"}
    with pytest.raises(ValueError, match="'last_frame': None.* got .*'last_frame': 0"):
        capture(replace(options, last_frame=None))


@pytest.mark.parametrize("last_frame", [-1, 10**6])
def test_frames_that_no_episode_has_are_refused(last_frame: int) -> None:
    with pytest.raises(ValueError, match=f"last_frame must be .*got {last_frame}"):
        CaptureOptions(last_frame=last_frame).check()


@pytest.mark.parametrize("scene", ["nowhere", "../../elsewhere", ""])
def test_scenes_that_the_split_does_not_have_are_refused_before_anything_is_written(
    options: CaptureOptions, tmp_path: Path, scene: str
) -> None:
    with pytest.raises(ValueError, match="a scene of the split 'train' must be one of .*got"):
        capture(replace(options, scenes=(*options.scenes, scene), output=tmp_path / "data"))
    assert not (tmp_path / "data").exists()


@pytest.mark.long
def test_pictures_depend_on_neither_workers_nor_order(dataset: Path, options: CaptureOptions, tmp_path: Path) -> None:
    """Two processes take another scene beside: the files of the shared scene have the same checksums."""
    more = replace(options, scenes=("living_room_a/02", *options.scenes))
    subprocess.run(command(more, tmp_path, "--workers", "2"), check=True)
    name = Path("train") / layout.folder_of(options.scenes[0]) / layout.SUMS
    assert (tmp_path / "HazardFire-v1" / name).read_text() == (dataset / name).read_text()


@pytest.mark.long
def test_a_capture_that_was_killed_is_taken_up_again(options: CaptureOptions, tmp_path: Path) -> None:
    """Killed once with a part on the disk; the next run leaves nothing unfinished and takes all pictures."""
    words = command(options, tmp_path)
    first = subprocess.Popen(words, start_new_session=True)
    home = tmp_path / "HazardFire-v1" / "train"
    until = time.monotonic() + 300.0
    while not list(home.glob(".*.part-*/rgb/0003.jpg")) and time.monotonic() < until:
        time.sleep(0.05)
    os.killpg(first.pid, signal.SIGKILL)
    first.wait()
    assert list(home.glob(".*.part-*")), "it was killed at work"
    subprocess.run(words, check=True)
    assert not list(home.glob(".*"))
    assert list(faults(tmp_path / "HazardFire-v1")) == []
    assert len(rows_of(tmp_path / "HazardFire-v1")["images"]) == options.per_scene
