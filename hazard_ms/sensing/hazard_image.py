"""The blurred hazard images: levels of the hazards at 16 x 16 points of the depth image, enlarged without smoothing.

As in the original, a sample is the first pixel of its block, `[::H // 16]`; images may have any size from 16 pixels a
side, square or not. The original stores the natural logarithm of the temperature, which its agents undo with exp; ours
hold degrees Celsius, or metres of water.
"""

from __future__ import annotations

from collections.abc import Callable

import torch
from torch import Tensor

from hazard_ms.sensing.camera import points_of_depth

SIDE = 16  # samples along each side of the image (docs/benchmark.md 2)


def sample_points(depth: Tensor, intrinsic: Tensor, cam2world: Tensor) -> Tensor:
    """Points [m] at which hazards are sampled, world frame, [E, 16, 16, 3]; arguments as for `points_of_depth`.

    Raises ValueError for images of fewer than 16 pixels a side.
    """
    height, width = depth.shape[1:3]
    if min(height, width) < SIDE:
        raise ValueError(f"an image must be at least {SIDE} pixels high and wide, got {height} x {width}")
    return points_of_depth(depth, intrinsic, cam2world, samples=(SIDE, SIDE))[0]


def hazard_images(levels: Callable[[Tensor], Tensor], points: Tensor) -> Tensor:
    """Levels of K hazards at `points` [m], world frame, [E, 16, 16, 3]: [E, K, 16, 16], each in its hazard's unit.

    `levels` gives them for points in a row, [E, P, 3] -> [E, K, P], as `Episode.levels` does.
    """
    return levels(points.flatten(1, 2)).unflatten(-1, points.shape[1:3])


def enlarge(images: Tensor, height: int, width: int) -> Tensor:
    """`images` [E, K, 16, 16] enlarged to [E, H, W, K] pixels, each with the value of the sample to its top left."""
    rows = torch.arange(height, device=images.device) * SIDE // height
    columns = torch.arange(width, device=images.device) * SIDE // width
    return images[:, :, rows][..., columns].permute(0, 2, 3, 1).contiguous()
