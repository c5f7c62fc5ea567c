"""A dataset that is drawn, not captured: red apples and blue boxes on a grey floor, with true depth and labels."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import cv2
import numpy as np

from hazard_ms.perception import layout
from hazard_ms.perception.coco import box_of, run_lengths

HEIGHT, PITCH, ANGLE = 1.1, math.radians(35.0), 1.2  # of the camera: above the floor [m], down [rad], field of view
COLOURS = {"apple": (210, 40, 40), "box": (40, 60, 220)}
RAISED = 0.1  # height of the things [m]
SCENE = "kitchen_a/00"
USUAL = {"status": "normal", "wet": False, "submerged": 0.0, "floating": False, "speed_mps": 0.0, "damaged": False}


def camera(size: int) -> tuple[np.ndarray, np.ndarray]:
    """Intrinsic matrix [pixels] and pose [m] of the camera, which looks along +x and down."""
    focal = size / 2 / math.tan(ANGLE / 2)
    intrinsic = np.array([[focal, 0.0, size / 2], [0.0, focal, size / 2], [0.0, 0.0, 1.0]])
    pose = np.eye(4)
    c, s = math.cos(PITCH), math.sin(PITCH)
    pose[:3, :3] = np.array([[0.0, s, -c], [-1.0, 0.0, 0.0], [0.0, c, s]])  # columns: right, up, back
    pose[2, 3] = HEIGHT
    return intrinsic, pose


def depth_to(height: float, size: int) -> np.ndarray:
    """Depth [m] along the optical axis, [size, size], to the horizontal plane at `height` [m]; 0 above the horizon."""
    intrinsic, pose = camera(size)
    row, column = np.indices((size, size)) + 0.5
    ray = np.stack([column - size / 2, size / 2 - row, np.full(row.shape, -intrinsic[0, 0])], -1) / intrinsic[0, 0]
    down = -(ray @ pose[2, :3])
    return np.where(down > 0.02, (HEIGHT - height) / np.maximum(down, 0.02), 0.0)


def draw(dataset: Path, split: str, count: int, size: int = 96, seed: int = 0, edge: tuple[int, int] = (8, 20)) -> Path:
    """Draw so many pictures of a split, with up to four things of `edge` pixels each. Returns the dataset's folder."""
    rng = np.random.default_rng(seed)
    place = dataset / split / layout.folder_of(SCENE)
    for kind in (layout.RGB, layout.DEPTH, layout.IDS):
        (place / kind).mkdir(parents=True)
    intrinsic, pose = camera(size)
    images: list[dict[str, Any]] = []
    rows: list[dict[str, Any]] = []
    for number in range(1, count + 1):
        ids = np.zeros((size, size), np.uint16)
        grain = rng.integers(-12, 12, (size, size, 3))
        rgb, depth = (120 + grain).astype(np.uint8), depth_to(0.0, size)
        for index, name in enumerate(NAMES):
            side = int(rng.integers(*edge))
            left, top = (int(rng.integers(0, size - side)), int(rng.integers(size // 2, size - side)))
            window = slice(top, top + side), slice(left, left + side)
            if ids[window].any():
                continue
            ids[window], rgb[window] = index + 1, np.clip(np.array(COLOURS[name]) + grain[window], 0, 255)
            depth[window] = depth_to(RAISED, size)[window]
        names = {
            kind: f"{split}/{place.name}/{kind}/{number:04d}{layout.ENDINGS[kind]}" for kind in ("rgb", "depth", "ids")
        }
        for kind, content in (("rgb", rgb[..., ::-1]), ("depth", (1000 * depth).astype(np.uint16)), ("ids", ids)):
            cv2.imwrite(str(dataset / names[kind]), content)
        told = {"camera": {"intrinsic": intrinsic.tolist(), "cam2world": pose.tolist()}, "scene": SCENE}
        files = {"file_name": names["rgb"], "depth_file": names["depth"], "ids_file": names["ids"]}
        images.append({"id": number, "width": size, "height": size, **files, **told})
        rows += _annotations(ids, number)
    things = [{"name": f"{name}_{k}", "category": name, "asset": name} for k, name in enumerate(NAMES)]
    table = {"scenes": {SCENE: {str(k + 1): row for k, row in enumerate(things)}}}
    (dataset / layout.TABLE).write_text(json.dumps(table))
    told = {"images": images, "annotations": rows, "categories": layout.categories()}
    (dataset / layout.instances(split)).write_text(json.dumps(told))
    return dataset


NAMES = ("apple", "box", "apple", "box")  # of the things, in the order of their indices


def _annotations(ids: np.ndarray, image: int) -> list[dict[str, Any]]:
    """The rows of what an ids picture shows."""
    numbers, made = layout.category_ids(), []
    for index in (np.unique(ids[ids > 0]) - 1).tolist():
        mask = ids == index + 1
        pixels = int(mask.sum())
        row = {"id": 100 * image + index, "image_id": image, "category_id": numbers[NAMES[index]], "instance": index}
        row |= {"segmentation": run_lengths(mask), "area": pixels, "bbox": box_of(mask), "iscrowd": 0}
        made.append({**row, "attributes": {**USUAL, "target": True, "distance_m": 1.5, "pixels": pixels}})
    return made
