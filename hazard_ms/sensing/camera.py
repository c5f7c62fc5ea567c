"""Points of the world and labels of things from the images of a pinhole camera.

ManiSkill's depth is int16 millimetres along the optical axis. It wraps at 32.767 m; read as unsigned numbers it
reaches 65.535 m, which is beyond every scene. 0 means that the ray hits nothing. The labels of a segmentation (see
`relabel`) are indices of things along B, or STRUCTURE, AGENT or NOTHING.
"""

from __future__ import annotations

import torch
from torch import Tensor

STRUCTURE = -1  # floor, walls, ceiling
AGENT = -2  # the robot that carries the camera
NOTHING = -3  # no surface
FAR = 1000.0  # distance at which a ray that hits nothing is taken to end [m]


def metres(depth: Tensor) -> Tensor:
    """Depth along the optical axis [m], float32 [...], from ManiSkill's int16 millimetres or from float metres.

    Raises ValueError for other types.
    """
    if depth.dtype == torch.int16:
        return (depth.to(torch.int32) & 0xFFFF).float() * 1e-3
    if depth.is_floating_point():
        return depth.float()
    raise ValueError(f"depth must have dtype int16 [mm] or a float [m], got {depth.dtype}")


def points_of_depth(
    depth: Tensor, intrinsic: Tensor, cam2world: Tensor, samples: tuple[int, int] | None = None
) -> tuple[Tensor, Tensor]:
    """Points [m] that a camera sees, world frame, [E, R, C, 3], and whether each lies on a surface, bool [E, R, C].

    `depth` [E, H, W] or [E, H, W, 1] (see `metres`); `intrinsic` [E, 3, 3] in pixels; `cam2world` [E, 4, 4] of a camera
    that looks along its -z axis with y up (ManiSkill's `cam2world_gl`). With `samples` (R, C) the image is cut into
    R x C blocks, of which only the first pixels are used; without, R x C is H x W. Raises ValueError for other shapes
    of `depth`.
    """
    if depth.ndim == 4:
        depth = depth[..., 0]
    if depth.ndim != 3:
        raise ValueError(f"depth must have shape [E, H, W] or [E, H, W, 1], got {tuple(depth.shape)}")
    height, width = depth.shape[1:]
    counts = samples or (height, width)
    rows, columns = _firsts(height, counts[0], depth), _firsts(width, counts[1], depth)
    far = metres(depth[:, rows][:, :, columns])
    row, column = rows + 0.5, columns + 0.5  # the middle of a pixel
    there = far > 0.0
    far = torch.where(there, far, FAR)
    right = (column[None, None, :] - intrinsic[:, 0, 2, None, None]) / intrinsic[:, 0, 0, None, None] * far
    down = (row[None, :, None] - intrinsic[:, 1, 2, None, None]) / intrinsic[:, 1, 1, None, None] * far
    local = torch.stack([right, -down, -far], dim=-1)
    return local @ cam2world[:, None, :3, :3].transpose(-1, -2) + cam2world[:, None, None, :3, 3], there


def _firsts(size: int, count: int, like: Tensor) -> Tensor:
    """Index of the first pixel of each of `count` blocks of `size` pixels, [count]."""
    return (torch.arange(count, device=like.device) * size + count - 1) // count


def relabel(segmentation: Tensor, label_of: Tensor) -> Tensor:
    """Labels, int64 [E, H, W], of a renderer's `segmentation`, [E, H, W] or [E, H, W, 1].

    `label_of` [E, S] holds the label of each of the renderer's ids; the labels are where it is, whatever device has
    drawn. Raises ValueError for ids outside of 0 to S - 1.
    """
    if segmentation.ndim == 4:
        segmentation = segmentation[..., 0]
    index = segmentation.to(label_of.device).long()
    highest = label_of.shape[1] - 1
    if int(index.max()) > highest or int(index.min()) < 0:
        raise ValueError(
            f"ids in the segmentation must be from 0 to {highest}, got {int(index.min())} to {int(index.max())}"
        )
    return torch.gather(label_of, 1, index.flatten(1)).reshape(index.shape)
