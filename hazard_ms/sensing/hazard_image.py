"""The blurred hazard image: the level of a hazard at 16 x 16 points of the depth image, upsampled to nearest neighbours.

As in the original, a sample is the first pixel of its block, `[::H // 16]`. The original stores the natural logarithm of the
temperature (its agents invert it with exp); ours holds degrees Celsius, and metres of water, unless `logarithm` is applied.
"""

from __future__ import annotations

from typing import Any

import torch
from torch import Tensor

from hazard_ms.hazards.base import Hazard
from hazard_ms.sensing.camera import points_of_depth
from hazard_ms.world import World

SIDE = 16  # samples along each side of the image (benchmark rules 2)
COLDEST = 1.0  # below this the logarithm is that of 1 C [C]


def sample_points(depth: Tensor, intrinsic: Tensor, cam2world: Tensor) -> Tensor:
    """Points [m] at which the hazard is sampled, world frame, [E, 16, 16, 3]; arguments as for `points_of_depth`."""
    height, width = depth.shape[1:3]
    if height < SIDE or height != width:
        raise ValueError(f"the image is {height} x {width} pixels; it must be square with at least {SIDE} pixels a side")
    points, _ = points_of_depth(depth, intrinsic, cam2world, stride=height // SIDE)
    return points[:, :SIDE, :SIDE]


def hazard_image(hazard: Hazard, state: Any, world: World, points: Tensor) -> Tensor:
    """Level of `hazard` at `points` [E, 16, 16, 3]: temperature [C] or water level [m], [E, 16, 16]."""
    return hazard.image(state, world, points.flatten(1, 2)).reshape(points.shape[:-1])


def enlarge(image: Tensor, side: int) -> Tensor:
    """`image` [E, 16, 16] at `side` x `side` pixels, each pixel as its nearest sample to the top left: [E, side, side]."""
    index = torch.arange(side, device=image.device) * SIDE // side
    return image[:, index][:, :, index]


def logarithm(temperature: Tensor) -> Tensor:
    """Natural logarithm of a `temperature` [C], as the original's agents observe it."""
    return torch.log(temperature.clamp(min=COLDEST))
