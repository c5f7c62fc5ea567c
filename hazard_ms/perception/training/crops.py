"""Crops of pictures, and what the small detector is to learn of each of their pixels.

A crop may be seen larger or smaller than in its picture, as by a camera with more or fewer pixels in the same place.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from hazard_ms.perception.training.pictures import Picture

# [ours], all of them
USUAL = 256  # area of a thing whose pixels have the weight 1 [pixels]
LEAST, MOST = 0.5, 4.0  # weight of a pixel of large and of small things
OF_STRUCTURE, OF_OTHERS = 0.4, 0.5  # weight of a pixel of floor and walls, and of things that are not known
STEEP, APART = 0.03, 0.01  # by which a place on a surface is nearer than its pixel: share, or [1/m]


class Crop(NamedTuple):
    """A part of a picture, and what is to be learned of each pixel."""

    rgb: NDArray[np.uint8]  # [H, W, 3]
    depth: NDArray[np.float32]  # [H, W] [m]
    intrinsic: NDArray[np.float32]  # [3, 3] [pixels]
    cam2world: NDArray[np.float32]  # [4, 4] [m]
    label: NDArray[np.int64]  # [H, W]: 0 structure, 1 to C the classes, C + 1 other things
    weight: NDArray[np.float32]  # [H, W]
    offset: NDArray[np.float32]  # [2, H, W], right and down to the middle of the thing [pixels]
    thing: NDArray[np.int64]  # [H, W]: which thing it is, 0 structure


def cut(
    picture: Picture,
    numbers: Mapping[str, int],
    corner: tuple[int, int],
    window: tuple[int, int],
    sides: tuple[int, int],
) -> Crop:
    """The part of a picture from `corner` (left, top) on, `window` (width, height) [pixels], brought to `sides`.

    `numbers` of the classes, from 1 to their number; things of other categories get one more.
    """
    (left, top), other = corner, len(numbers) + 1
    part = slice(top, top + window[1]), slice(left, left + window[0])
    intrinsic = picture.intrinsic()
    intrinsic[:2, 2] -= corner
    intrinsic[:2] *= (np.asarray(sides) / np.asarray(window)).astype(np.float32)[:, None]
    rgb, depth, ids = picture.rgb()[part], picture.depth()[part], picture.ids()[part]
    if window != sides:
        rgb = cv2.resize(rgb, sides, interpolation=cv2.INTER_LINEAR).astype(np.uint8)
        depth = depth_at(depth, sides)
        ids = cv2.resize(ids, sides, interpolation=cv2.INTER_NEAREST_EXACT).astype(np.uint16)
    things = ids.astype(np.int64)
    label, weight, offset = taught(things, picture.categories(), numbers, other)
    return Crop(rgb, depth, intrinsic, picture.cam2world(), label, weight, offset, things)


def depth_at(depth: NDArray[np.float32], sides: tuple[int, int]) -> NDArray[np.float32]:
    """The `depth` [m], [H, W], 0: nothing, at `sides` (width, height) [pixels].

    Nearness is linear along a plane, so that planes stay planes; at edges it is that of the nearest pixel.
    """
    nearness = np.where(depth > 0.0, 1.0 / np.maximum(depth, 1e-6), 0.0).astype(np.float32)
    nearest = cv2.resize(nearness, sides, interpolation=cv2.INTER_NEAREST_EXACT)
    between = cv2.resize(nearness, sides, interpolation=cv2.INTER_LINEAR)
    one_surface = (np.abs(between - nearest) < np.maximum(STEEP * nearest, APART)) & (nearest > 0.0)
    there = np.where(one_surface, between, nearest)
    made: NDArray[np.float32] = np.where(there > 0.0, 1.0 / np.maximum(there, 1e-6), 0.0).astype(np.float32)
    return made


def taught(
    ids: NDArray[np.int64], kinds: Mapping[int, str], numbers: Mapping[str, int], other: int
) -> tuple[NDArray[np.int64], NDArray[np.float32], NDArray[np.float32]]:
    """Label and weight, [H, W], and offset, [2, H, W] [pixels], of pixels that show the things `ids`, [H, W].

    `kinds`: categories of the numbers in `ids`; `numbers`: labels of the known ones; `other`: of all others.
    """
    table = np.zeros(max(kinds, default=0) + 1, np.int64)
    for number, name in kinds.items():
        table[number] = numbers.get(name, other)
    area = np.bincount(ids.ravel(), minlength=len(table)).astype(np.float32)
    weight = np.sqrt(USUAL / np.maximum(area, 1.0)).clip(LEAST, MOST)
    weight[table == other] = OF_OTHERS
    weight[0] = OF_STRUCTURE
    rows, columns = np.indices(ids.shape, np.float32)
    across, down = (
        np.bincount(ids.ravel(), grid.ravel(), minlength=len(table)) / np.maximum(area, 1.0) for grid in (columns, rows)
    )
    offset = np.stack([across[ids] - columns, down[ids] - rows]).astype(np.float32)
    return table[ids], weight[ids].astype(np.float32), offset


def mirrored(crop: Crop) -> Crop:
    """The same crop seen in an upright mirror."""
    rgb, depth, intrinsic, cam2world, label, weight, offset, thing = crop
    intrinsic, cam2world = intrinsic.copy(), cam2world.copy()
    intrinsic[0, 2] = depth.shape[1] - intrinsic[0, 2]
    cam2world[:3, 0] *= -1.0
    flipped = (np.ascontiguousarray(part[:, ::-1]) for part in (rgb, depth, label, weight, thing))
    rgb, depth, label, weight, thing = flipped  # type: ignore[assignment]
    moved = np.ascontiguousarray(offset[..., ::-1]) * np.array([-1.0, 1.0], np.float32)[:, None, None]
    return Crop(rgb, depth, intrinsic, cam2world, label, weight, moved, thing)
