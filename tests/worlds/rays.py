"""A camera that knows its answer: rays cast from a pinhole onto boxes in a room, without a renderer.

Lengths in metres.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

STRUCTURE = -1

Vec3 = tuple[float, float, float]


@dataclass(frozen=True)
class Block:
    """An axis-aligned box with the label that the segmentation shows."""

    low: Vec3
    high: Vec3
    label: int


def intrinsic(side: int, fov: float = 2 * np.pi / 3) -> NDArray[np.float32]:
    """Intrinsic matrix of a square image with a vertical field of view `fov` [rad]."""
    focal = side / 2 / np.tan(fov / 2)
    return np.array([[focal, 0, side / 2], [0, focal, side / 2], [0, 0, 1]], np.float32)


def looking(eye: Vec3, at: Vec3) -> NDArray[np.float32]:
    """Camera-to-world matrix of a camera at `eye` that looks along its -z, y up."""
    forward = np.array(at, float) - np.array(eye)
    forward /= np.linalg.norm(forward)
    right = np.cross(forward, [0.0, 0.0, 1.0])
    right /= np.linalg.norm(right)
    pose = np.eye(4)
    pose[:3, 0], pose[:3, 1], pose[:3, 2], pose[:3, 3] = right, np.cross(right, forward), -forward, eye
    return pose.astype(np.float32)


def cast(
    pose: NDArray[np.float32], side: int, blocks: tuple[Block, ...], room: Vec3
) -> tuple[NDArray[np.float32], NDArray[np.int64]]:
    """Depth along the optical axis and labels, [side, side], in a room with its corner at the origin."""
    k = intrinsic(side).astype(float)
    row, column = np.mgrid[0:side, 0:side] + 0.5
    local = np.stack([(column - k[0, 2]) / k[0, 0], (k[1, 2] - row) / k[1, 1], -np.ones((side, side))], -1)
    ray, eye = local @ pose[:3, :3].T.astype(float), pose[:3, 3].astype(float)
    with np.errstate(divide="ignore", invalid="ignore"):
        depth = np.maximum(-eye / ray, (np.array(room) - eye) / ray).min(-1)
        label = np.full((side, side), STRUCTURE, np.int64)
        for block in blocks:
            a, b = (np.array(block.low) - eye) / ray, (np.array(block.high) - eye) / ray
            near, far = np.minimum(a, b).max(-1), np.maximum(a, b).min(-1)
            hit = (near < far) & (near > 0) & (near < depth)
            depth, label = np.where(hit, near, depth), np.where(hit, block.label, label)
    return depth.astype(np.float32), label
