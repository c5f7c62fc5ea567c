"""From the images of a pinhole camera to points of the world.

ManiSkill's depth is int16 millimetres along the optical axis. It wraps at 32.767 m; read as unsigned it holds 65.535 m, which
is beyond every scene. 0 means that the ray hits nothing.

Labels of a segmentation, `relabel`: the index of the thing along B, or one of STRUCTURE, AGENT, NOTHING.
"""

from __future__ import annotations

import torch
from torch import Tensor

STRUCTURE = -1  # floor, walls, ceiling
AGENT = -2  # the robot that carries the camera
NOTHING = -3  # no surface
FAR = 1000.0  # where a ray that hits nothing is taken to end [m]


def metres(depth: Tensor) -> Tensor:
    """Depth along the optical axis [m], float32, of ManiSkill's int16 millimetres or of float metres; same shape."""
    if depth.dtype == torch.int16:
        return (depth.to(torch.int32) & 0xFFFF).float() * 1e-3
    if depth.is_floating_point():
        return depth.float()
    raise ValueError(f"depth has dtype {depth.dtype}; int16 [mm] or a float [m] is allowed")


def points_of_depth(depth: Tensor, intrinsic: Tensor, cam2world: Tensor, stride: int = 1) -> tuple[Tensor, Tensor]:
    """Points [m], world frame, [E, H', W', 3], and where there is a surface, bool [E, H', W'].

    `depth` [E, H, W] or [E, H, W, 1] (see `metres`); `intrinsic` [E, 3, 3] in pixels; `cam2world` [E, 4, 4], of a camera that
    looks along its -z, y up (ManiSkill's `cam2world_gl`). Only every `stride`-th row and column is used, from the first.
    """
    if depth.ndim == 4:
        depth = depth[..., 0]
    if depth.ndim != 3:
        raise ValueError(f"depth has shape {tuple(depth.shape)}; [E, H, W] or [E, H, W, 1] is allowed")
    far = metres(depth[:, ::stride, ::stride])
    column = torch.arange(0, depth.shape[2], stride, device=depth.device) + 0.5  # the middle of a pixel
    row = torch.arange(0, depth.shape[1], stride, device=depth.device) + 0.5
    there = far > 0.0
    far = torch.where(there, far, FAR)
    right = (column[None, None, :] - intrinsic[:, 0, 2, None, None]) / intrinsic[:, 0, 0, None, None] * far
    down = (row[None, :, None] - intrinsic[:, 1, 2, None, None]) / intrinsic[:, 1, 1, None, None] * far
    local = torch.stack([right, -down, -far], dim=-1)
    return local @ cam2world[:, None, :3, :3].transpose(-1, -2) + cam2world[:, None, None, :3, 3], there


def relabel(segmentation: Tensor, label_of: Tensor) -> Tensor:
    """Labels, int64 [E, H, W], of a renderer's `segmentation`, [E, H, W] or [E, H, W, 1].

    `label_of` [E, S]: the label of each of the renderer's ids.
    """
    if segmentation.ndim == 4:
        segmentation = segmentation[..., 0]
    index = segmentation.long()
    highest = label_of.shape[1] - 1
    if int(index.max()) > highest or int(index.min()) < 0:
        raise ValueError(f"segmentation holds ids {int(index.min())} to {int(index.max())}; labels are given for 0 to {highest}")
    return torch.gather(label_of, 1, index.flatten(1)).reshape(index.shape)
